// SPDX-License-Identifier: Apache-2.0
// See method.hpp.
#include "pipeline/method.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "clray/error.hpp"
#include "exact/beam_faces.hpp"
#include "pipeline/course.hpp"
#include "pipeline/detector/room.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

// Seconds on one core, of a face of a view and of a ray, as a grid of 614 Sun directions on topex.obj took
// (docs/exact.md). Their ratio decides.
constexpr double kSecondsPerFace = 7e-6, kSecondsPerRay = 1.4e-6;
constexpr double kMuchDearer = 10.0;

/// Whether a detector's sums can be made from visible faces. What no sum of its own has reads those of others.
bool solvable(const TableRow& row) {
  const DetectorRoom& room = room_of(row.id);
  return row.sums.empty() || room.solved != nullptr || room.binning != nullptr;
}

/// The first material of the scene and its variants of which `fits` is false, or null.
template <class Fits>
const Material* misfit(const Scene& scene, Fits fits) {
  const auto wrong = [&](const std::vector<Material>& all) {
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Material& m) { return !fits(table_row("brdf", m.model)); });
    return found == all.end() ? nullptr : &*found;
  };
  if (const Material* m = wrong(scene.materials)) return m;
  for (const Variant& variant : scene.variants) {
    if (const Material* m = wrong(variant.materials)) return m;
  }
  return nullptr;
}

/// What of surfaces and observers stands in the way of a detector's exact numbers; empty: nothing.
std::string obstacle_to(const Scene& scene, const TableRow& row) {
  if (row.connects) {
    if (misfit(scene, [](const TableRow& model) { return model.delta; }) == nullptr)
      return "every material is a mirror";
  }
  if (row.scatters) {
    // The momentum of the light that such surfaces send on is a closed form.
    if (const Material* m = misfit(scene, [](const TableRow& model) { return model.even || model.delta; }))
      return fmt::format("material {} reflects neither evenly nor as a mirror", m->name);
  }
  return {};
}

/// Why a detector's numbers cannot be exact, whatever the shapes; empty where they can.
std::string obstacle(const Scene& scene, const DetectorSpec& detector) {
  const TableRow& row = table_row("detector", detector.kind);
  if (!solvable(row)) return detector.kind + " follows light that cannot be solved";
  return obstacle_to(scene, row);
}

/// From how many directions a detector's views are solved: the source, and each observer elsewhere.
std::size_t sights_of(const Scene& scene, const DetectorSpec& detector) {
  if (!table_row("detector", detector.kind).connects) return 1;
  const auto elsewhere = std::count_if(scene.observers.begin(), scene.observers.end(), [&](const Observer& o) {
    return scene.trace.force_bistatic || !at_source(o, scene.source);
  });
  return 1 + static_cast<std::size_t>(elsewhere);
}

/// What of a detector's light the first bounce does not bring, so that rays must find it; empty: nothing. `body` may be
/// null where it is not known yet.
std::string rest(const Scene& scene, const DetectorSpec& detector, const Geometry* body) {
  if (scene.trace.max_bounces > 1 && (body == nullptr || !body->convex())) return "further bounces";
  // Mirrors reach cones alone: rays find which.
  const bool connects = table_row("detector", detector.kind).connects;
  if (connects && misfit(scene, [](const TableRow& model) { return !model.delta; })) return "mirrors";
  return {};
}

/// What solving a body so many times takes, s on one core.
double seconds_to_solve(const Geometry& geometry, std::size_t times) {
  return kSecondsPerFace * static_cast<double>(geometry.primitives.size()) * static_cast<double>(times);
}

/// What as many rays take as are traced by default.
double seconds_of_rays(std::size_t views, int replicates) {
  const double least = static_cast<double>(kFirstPoints) * replicates * static_cast<double>(views);
  return kSecondsPerRay * std::max(static_cast<double>(kDefaultRays), least);
}

}  // namespace

bool may_need_no_rays(const Scene& scene) {
  if (scene.trace.method == Method::points || scene.trace.rays != 0) return false;
  return std::all_of(scene.components.begin(), scene.components.end(),
                     [](const Component& c) { return table_row("shape", c.shape).flat; }) &&
         std::all_of(scene.detectors.begin(), scene.detectors.end(), [&](const DetectorSpec& d) {
           return obstacle(scene, d).empty() && rest(scene, d, nullptr).empty();
         });
}

MethodChoice choose_method(const Scene& scene, const Geometry& geometry, const DetectorSpec& detector,
                           std::size_t views) {
  const TraceOptions& t = scene.trace;
  if (t.method == Method::points) return {false, "points are asked for"};
  std::string why = obstacle(scene, detector);
  if (why.empty() && !made_of_polygons(geometry)) why = "a curved shape is in the scene";
  const std::string sampled = why.empty() ? rest(scene, detector, &geometry) : "";
  const auto solved = [&](const std::string& because) {
    return MethodChoice{sampled.empty(), because + (sampled.empty() ? "" : "; rays find " + sampled), !sampled.empty()};
  };
  if (t.method == Method::exact) {
    if (!why.empty()) throw Error(ErrorCode::input, "method = \"exact\" is not possible: " + why, "trace.method");
    if (t.rays != 0 && sampled.empty())
      throw Error(ErrorCode::input, "method = \"exact\" traces no rays here: leave rays out", "trace.rays");
    return solved("asked for");
  }
  if (t.rays != 0) return {false, fmt::format("rays = {} are asked for", t.rays)};
  if (!why.empty()) return {false, why};
  const double seconds = seconds_to_solve(geometry, views * sights_of(scene, detector));
  // An exact pass that time cuts off has no result.
  if (t.time_limit_s > 0.0 && seconds > 0.5 * t.time_limit_s)
    return {false, fmt::format("solving it may take longer than the time limit of {:g} s", t.time_limit_s)};
  if (seconds > kMuchDearer * seconds_of_rays(views, t.replicates)) {
    return {false, fmt::format("{} faces in {} views would take much longer than rays; --method exact solves them",
                               geometry.primitives.size(), views)};
  }
  return solved("one reflection from flat faces");
}

}  // namespace clray
