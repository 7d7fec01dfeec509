// SPDX-License-Identifier: Apache-2.0
// What a run found: every number with its standard error, per detector, observer, variant, band and
// orientation. SI units (m, s, sr, N). Records of each kind have a header of their own; write.hpp makes files of them.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "clray/device.hpp"
#include "clray/export.hpp"
#include "clray/result/delay.hpp"
#include "clray/result/estimate.hpp"
#include "clray/result/image.hpp"
#include "clray/result/instant.hpp"
#include "clray/result/pressure.hpp"
#include "clray/result/run.hpp"
#include "clray/result/spectrometer.hpp"
#include "clray/result/table.hpp"
#include "clray/scene.hpp"

CLRAY_API_BEGIN
namespace clray {

/// Everything a run found.
struct Result {
  DeviceInfo device;             ///< what traced
  std::uint64_t seed = 0;        ///< of all random numbers
  std::uint64_t rays = 0;        ///< per orientation, of the result (the confirmation's); 0: all numbers are exact
  std::uint64_t rays_total = 0;  ///< traced in all
  int replicates = 0;            ///< independent replicates
  std::uint64_t digest = 0;      ///< of all integer sums: equal digests mean equal results
  bool partial = false;          ///< ended early by a signal or the time limit
  bool target_asked = false;     ///< an error was asked for
  bool target_reached = false;   ///< and met by all totals
  double target_percent = 0.0;   ///< 95 % half-width over the value that was asked for; 0: none
  /// That of the result, the largest over all totals; NaN where all are zero.
  double reached_percent = std::numeric_limits<double>::quiet_NaN();
  /// What ended the tracing: "exact" (nothing was sampled), "target", "zero" (all totals are zero, so no target can be
  /// met), "rays" (as given), "max_rays", "samples" (of a picture's search), "time limit" or "interrupt". If there were
  /// several passes, that of the first that missed the target.
  std::string stopped_by;
  double extent_m = 0.0;                         ///< longest side of the box around the body, axes of the body frame
  MeshReport mesh;                               ///< all meshes together
  Seconds seconds;                               ///< where time went
  Diagnostics diagnostics;                       ///< failures, counted
  PathCounts paths;                              ///< how light paths ended
  std::vector<EnergyBooks> energy;               ///< in the order of variants and bands; empty where no path scatters
  std::vector<std::string> kept;                 ///< what the program had, each with its reason (specialisation)
  std::vector<std::string> left_out;             ///< what it did without, each with its reason
  std::vector<std::string> warnings;             ///< what a person should know
  std::vector<ErrorPoint> errors;                ///< error against time, a point per step
  std::vector<Orientation> orientations;         ///< the views, in their order
  std::vector<DelayResult> delay;                ///< a record per detector, observer, variant, band and orientation
  std::vector<SpectrometerResult> spectrometer;  ///< the same
  std::vector<PressureResult> pressure;          ///< the same, without observers
  std::vector<ImageResult> image;                ///< of rgb and hyperspectral detectors
  std::vector<TableResult> table;                ///< of detectors that have sums and no results of their own
  std::vector<PassInstant> instants;             ///< of a pass, all of them
};

}  // namespace clray
CLRAY_API_END
