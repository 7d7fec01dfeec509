// SPDX-License-Identifier: Apache-2.0
// Samples the tiles of a view on a device: a point of each replicate in each tile (kernels/exact/sample.cl).
#pragma once

#include <cstdint>
#include <vector>

#include "device/device_impl.hpp"
#include "device/program.hpp"
#include "exact/portable_faces.hpp"
#include "pipeline/exact_device.hpp"
#include "pipeline/pause.hpp"

namespace clray {

/// Tiles whose points are asked, each with its part of the list of faces and, for an observer elsewhere, of that of
/// faces that may shade them.
struct SampledTiles {
  std::vector<ClrayTile> tiles;
  std::vector<std::uint32_t> listed;
  std::vector<std::uint32_t> shaded;  ///< of each tile, where its blockers begin and how many there are
  std::vector<std::uint32_t> blockers;
};

/// The beam of the light, for a view that is not from there.
struct LightBeam {
  std::vector<ClrayFace> faces;
  std::vector<ClrayCarried> carried;  ///< where each face of the view is in it
};

/// What points bring.
struct SampleSums {
  std::vector<double> values;       ///< of each tile and replicate: area times the sum of the lanes' weights
  std::vector<i64> moments;         ///< [lane][replicate][3]
  std::vector<i64> bins;            ///< [window][lane][replicate][bins + 2]
  std::vector<std::uint32_t> hits;  ///< the same
};

class SampleDevice {
 public:
  /// Builds the program, or takes what was built before, and tests it once per device. Throws Error(device).
  SampleDevice(OpenedDevice& device, const ProgramOptions& options, const ExactNumbers& numbers);

  /// The same with a kernel that was built before, which is not tested.
  SampleDevice(OpenedDevice& device, const cl::Kernel& kernel, const ExactNumbers& numbers);

  /// The faces of the view that is sampled next. `light` is empty where the view is from the source.
  void begin_view(const FaceGroup& group, const LightBeam& light);
  /// Samples every tile in launches of bounded time; the sums are empty where points add to none.
  SampleSums sample(const SampledTiles& tiles, const ClraySampling& sampling, Pause* pause);

 private:
  OpenedDevice& opened_;
  ExactNumbers numbers_;
  cl::Kernel kernel_;
  std::uint64_t bin_numbers_ = 0;   // of a replicate
  std::size_t slice_items_ = 1024;  // of the next launch
  cl::Buffer faces_, weights_, binnings_, lit_faces_, carried_;
};

}  // namespace clray
