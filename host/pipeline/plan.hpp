// SPDX-License-Identifier: Apache-2.0
// From a scene to the passes that trace it. A request says what a pass is for; the plan adds, as values that functions
// return, where rays start, what is recorded and at what scale, and what the program must contain. A pass is one
// program, one set of buffers and one stopping rule. Below the plan nothing asks the scene's tables, motion or spectra.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "beam/beams.hpp"
#include "body/lanes.hpp"
#include "body/materials.hpp"
#include "device/program.hpp"
#include "exact/unsolved.hpp"
#include "pipeline/method.hpp"
#include "pipeline/sums.hpp"
#include "shared/abi.h"

namespace clray {

/// What a pass is for: which rays it traces, and what looks at them.
struct PassRequest : BeamRequest {
  std::string phase;                  ///< for progress
  std::vector<int> detectors;         ///< indices into Scene::detectors
  std::vector<int> first_exact;       ///< those of them whose first bounce is solved; rays find the rest
  std::size_t first_orientation = 0;  ///< where the orientations stand in Result::orientations
  std::vector<Lane> lanes;
  bool grid = false;        ///< the views are a grid of light directions of a detector's own
  bool apart = false;       ///< it is traced under light of its own, beside others under the scene's
  bool one_bounce = false;  ///< whatever the scene says: it is the first bounce of another pass, or there is no other
  PassMethod how = PassMethod::points;
  std::vector<std::string> method;  ///< why its detectors are solved or sampled
  std::uint32_t replicates = 16;

  bool exact() const { return how == PassMethod::exact; }
  bool tiles() const { return how == PassMethod::tiles; }
  /// Whether faces alone are looked at, and rays are not needed.
  bool without_rays() const { return exact() || tiles(); }
};

/// The fixed-point scale of a view's weights, and its middle and half of path lengths.
struct ViewScales {
  int weight_bits = 0;  ///< weights are summed as integers at 2^weight_bits
  double path_middle_m = 0.0, path_half_m = 1.0;
};

struct Scales {
  std::vector<ViewScales> views;
  double lever_m = 1.0;  ///< levers are divided by it; a power of two
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
  std::string entry = "trace.cl";  ///< the kernel file that it is built from
  ProgramOptions options;
  bool walk_is_free = false;  ///< the scene leaves it to the devices
  bool open_ended = false;    ///< an error ends the pass: few rays may do
  std::vector<std::string> kept, left_out;
};

struct FirstBounce;

struct PassPlan {
  PassRequest request;
  PathTraits traits;
  MaterialTable materials;
  Beams beams;
  std::vector<std::vector<RigidMotion>> motions;  ///< of an exact pass: where the parts stand in each view
  PathRanges paths;
  Scales scales;
  std::vector<PassDetector> detectors;
  SumLayout layout;
  UnsolvedPrimitives unsolved;  ///< where curved shapes stand among faces that are solved; else empty
  ClrayPass constants{};
  Specialised program;
  std::optional<Specialised> lasting;  ///< the program to go on with where rays take long; none: with the same
  std::size_t slab_views = 0;          ///< whose sums a device holds at once; 0: all
  std::shared_ptr<FirstBounce> first;  ///< of a pass whose first bounce is solved; else none
};

/// The first bounce of a pass, solved: an exact pass of the same views, lanes and connections, and what it found. Rays
/// leave out what its detectors would see of first hits; readers of sums add it (sum_reader.hpp).
struct FirstBounce {
  PassPlan plan;
  Sums sums;                ///< empty until it is solved
  std::vector<int> blocks;  ///< of each block of the pass: the block that adds to it, or -1
};

/// All passes of a scene. Throws Error(input) for what cannot be traced.
std::vector<PassPlan> plan_passes(const Scene& scene, const Geometry& geometry);
/// Those of known requests.
std::vector<PassPlan> plan_passes(const Scene& scene, const Geometry& geometry, std::vector<PassRequest> requests);

/// What each pass of a scene is for: detectors that can share rays share a pass, and so do lanes.
std::vector<PassRequest> pass_requests(const Scene& scene, const Geometry& geometry);

/// The plan of one pass. Without `reflectances`, materials lack their tables of directional reflectance.
PassPlan plan_pass(const Scene& scene, const Geometry& geometry, PassRequest request, bool reflectances = true);

/// The program of a pass, from everything else that its plan says.
Specialised specialise(const Scene& scene, const Geometry& geometry, const PassPlan& plan);

/// Whether a detector of the request that connects light (or none does, that only follows it) has its first bounce
/// solved.
bool first_is_exact(const Scene& scene, const PassRequest& request, bool connects);

/// Whether rays of the beam go in packets (kernels/stage/packet.cl): a work-item then has points of all replicates.
bool in_packets(const PassPlan& plan);

/// Points that a work-item takes, at most. Work-items that run side by side wait for one another on a GPU, so each has
/// one there.
std::uint32_t chunk_of(const PassPlan& plan);

/// Lets the rays of a pass go as a row of the walks says. Work-items of another walk may have other points.
void set_walk(const std::string& walk, PassPlan* plan);

/// Fits programs to the devices: packets need much private memory, so they are for CPUs, and neighbours side by side
/// are for all others; the compiler's optimiser is left out for few rays on CPUs alone, and not where it is known that
/// the program is used again. Where an error ends a pass, the pass begins without it
/// and without packets, and has its lasting program beside.
void fit_to(Device& device, bool used_again, std::vector<PassPlan>* plans);

/// Goes on with the lasting program, if there is one.
void take_lasting_program(PassPlan* plan);

/// The detector of this id in a pass, or null.
const PassDetector* find_detector(const PassPlan& plan, const std::string& id);

/// A key of a detector, or its default.
double detector_value(const DetectorSpec& spec, const std::string& key);
/// What errors call one of the scene's own detectors: the member of the scene that it is.
std::string member_of(const Scene& scene, const DetectorSpec& spec);

}  // namespace clray
