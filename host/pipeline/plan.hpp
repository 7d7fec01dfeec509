// SPDX-License-Identifier: Apache-2.0
// From a scene to the passes that trace it: which rays start where, what is recorded, what the program must contain
// and what it can leave out. A pass is one program, one set of buffers and one stopping rule.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clray/result.hpp"
#include "device/program.hpp"
#include "pipeline/geometry.hpp"
#include "pipeline/surfaces.hpp"
#include "shared/abi.h"

namespace clray {

/// Where a delay detector's histograms lie and what window they cover (per connection).
struct DelayPlan {
  int detector = 0;  ///< index into Scene::detectors
  std::uint32_t bins = 0;
  std::vector<double> first_m, bin_m;  ///< path length, relative to the reference point
  std::uint64_t sums = 0, hits = 0;
};

/// What a pass traces.
struct PassPlan {
  bool pixels = false;                    ///< rays start at pixels, else at the beam
  std::string phase;                      ///< for progress
  std::vector<Orientation> orientations;  ///< one per view; of a grid of Sun directions its own
  std::size_t first_orientation = 0;      ///< where they stand in Result::orientations
  std::vector<Lane> lanes;
  Surfaces surfaces;
  std::uint32_t connections = 1;  ///< observers of a beam; 1 (the source) for pixels
  std::uint32_t replicates = 16;
  std::uint32_t components = 1;
  int max_bounces = 1;
  bool connect = false, scatter = false, pressure = false, thermal = false;
  int pressure_detector = -1, pixel_detector = -1;
  int pixel_observer = 0;
  bool grid = false;  ///< of Sun directions, for pressure
  std::uint32_t width = 0, height = 0;
  std::uint32_t picture_samples = 0;  ///< per pixel; 0: from the error target
  double pixel_m = 0.0;
  std::vector<Vec3> right, up;  ///< of pictures, per view
  std::vector<DelayPlan> delays;
  int scale_bits = 0;  ///< S of weights
  double path_low_m = 0.0, path_high_m = 0.0;
  double lever_m = 1.0;              ///< power of two that levers are divided by
  std::vector<double> area_m2;       ///< that a ray of share 1 stands for, times the rays: of a beam, or of a pixel
  std::vector<ClrayStratum> strata;  ///< of all views' beams, see beam_strata.hpp

  ClrayPass constants{};
  std::vector<ClrayView> views;
  std::vector<ClrayConnection> connection_rows;
  std::vector<ClrayInstance> instances;
  std::vector<ClrayNode> nodes;  ///< the geometry's, then the top levels
  std::vector<ClrayDelay> delay_rows;
  std::uint64_t sums_size = 0, hits_size = 0;
  std::uint64_t totals_size = 0, pressure_size = 0, books_size = 0, pixels_size = 0;
  ProgramOptions options;
  std::vector<std::string> kept, left_out;
};

/// All passes of a scene. Throws Error(input) for what cannot be traced.
std::vector<PassPlan> plan_passes(const Scene& scene, const Geometry& geometry);

/// Fills in what follows from the scene and the plan's detectors, lanes and orientations.
PassPlan plan_pass(const Scene& scene, const Geometry& geometry, PassPlan plan);

/// A key of a detector, or its default.
double detector_value(const DetectorSpec& spec, const std::string& key);

}  // namespace clray
