// SPDX-License-Identifier: Apache-2.0
// From a scene to the passes that trace it. A request says what a pass is for; the plan adds, as values that functions
// return, where rays start, what is recorded and at what scale, and what the program must contain. A pass is one
// program, one set of buffers and one stopping rule. Below the plan nothing asks the scene's tables, motion or spectra.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clray/result.hpp"
#include "device/program.hpp"
#include "pipeline/geometry.hpp"
#include "pipeline/sums.hpp"
#include "pipeline/surfaces.hpp"
#include "shared/abi.h"

namespace clray {

/// A picture's size, of pixel passes.
struct PictureSize {
  std::uint32_t width = 0, height = 0;
  std::uint32_t samples = 0;  ///< per pixel; 0: from the error target
};

/// What a pass is for.
struct PassRequest {
  std::string phase;                      ///< for progress
  std::vector<int> detectors;             ///< indices into Scene::detectors
  std::vector<Orientation> orientations;  ///< one per view
  std::size_t first_orientation = 0;      ///< where they stand in Result::orientations
  std::vector<Lane> lanes;
  std::vector<int>
      observers;         ///< indices into Scene::observers: of a beam all it connects to, of pixels the one that looks
  bool pixels = false;   ///< rays start at pixels, else at the beam
  bool mirrors = false;  ///< they start at the beam, and are followed from mirrors on: the rest of a picture
  bool grid = false;     ///< the views are a grid of light directions of a detector's own
  bool apart = false;    ///< it is traced under light of its own, beside others under the scene's
  PictureSize picture;
  std::uint32_t replicates = 16;

  /// Whether its sums are those of a picture: two halves and no totals.
  bool paints() const { return pixels || mirrors; }
};

/// How the pictures of a pass lie: axes per view, one pixel size, and the centre of each, from the body's origin
/// (middle) and from the reference point.
struct PictureFrame {
  std::vector<Vec3> right, up;
  std::vector<double> middle_right_m, middle_up_m;
  std::vector<double> centre_right_m, centre_up_m;
  double pixel_m = 0.0;
};

/// Where the rays of a pass start, and what hits are connected to.
struct Beams {
  std::vector<ClrayView> views;
  std::vector<ClrayConnection> connections;  ///< [view][connection]
  std::vector<ClrayInstance> instances;
  std::vector<ClrayNode> nodes;      ///< the geometry's, then the top levels
  std::vector<double> area_m2;       ///< that a ray of share 1 stands for, times the rays: of a beam, or of a pixel
  std::vector<ClrayStratum> strata;  ///< of all views' beams, see beam_strata.hpp
  PictureFrame frame;
};

/// Path lengths (m, relative to the reference point) that one bounce can have, per connection over all views.
struct PathRange {
  std::vector<double> low_m, high_m;

  double low() const;
  double high() const;
};

/// The fixed-point scale of weights, and what lengths and levers are divided by.
struct Scales {
  int weight_bits = 0;  ///< weights are summed as integers at 2^weight_bits
  double path_middle_m = 0.0, path_half_m = 1.0;
  double lever_m = 1.0;  ///< a power of two
};

/// Edges of bins of path length that strata of the beam may follow.
struct PathBins {
  double first_m = 0.0, bin_m = 1.0;  ///< of the first connection
};

/// A detector of a pass: a row of detector.def, with its sums.
struct PassDetector {
  int row = 0;
  int index = -1;                                 ///< into Scene::detectors; -1: an inner detector
  bool asked = true;                              ///< false: only the generic program has it
  std::vector<double> settings;                   ///< what the device works with
  std::uint32_t first_block = 0, last_block = 0;  ///< in the layout
};

/// What paths do.
struct PathTraits {
  int max_bounces = 1;
  bool connect = false, scatter = false;
  std::uint32_t connections = 1, components = 1;
};

/// What a program is built of, and the reasons.
struct Specialised {
  ProgramOptions options;
  std::vector<std::string> kept, left_out;
};

struct PassPlan {
  PassRequest request;
  PathTraits traits;
  Surfaces surfaces;
  Beams beams;
  PathRange paths;
  Scales scales;
  std::vector<PassDetector> detectors;
  SumLayout layout;
  ClrayPass constants{};
  Specialised program;
};

/// All passes of a scene. Throws Error(input) for what cannot be traced.
std::vector<PassPlan> plan_passes(const Scene& scene, const Geometry& geometry);

/// What each pass of a scene is for: detectors that can share rays share a pass, and so do lanes.
std::vector<PassRequest> pass_requests(const Scene& scene);

/// The plan of one pass. Without `reflectances`, materials lack their tables of directional reflectance.
PassPlan plan_pass(const Scene& scene, const Geometry& geometry, PassRequest request, bool reflectances = true);

/// The program of a pass, from everything else that its plan says.
Specialised specialise(const Scene& scene, const Geometry& geometry, const PassPlan& plan);

/// The detector of this id in a pass, or null.
const PassDetector* find_detector(const PassPlan& plan, const std::string& id);

/// A key of a detector, or its default.
double detector_value(const DetectorSpec& spec, const std::string& key);

}  // namespace clray
