// SPDX-License-Identifier: Apache-2.0
// See method.hpp.
#include "pipeline/method.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "clray/error.hpp"
#include "exact/beam_faces.hpp"
#include "pipeline/detector/room.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

// Seconds on one core, of a face of a view and of a ray, measured on meshes of 36 to 10^6 triangles (docs/exact.md).
constexpr double kSecondsPerFace = 8e-6, kSecondsPerRay = 4e-7;
constexpr double kDefaultRays = 1u << 22, kLeastRaysPerView = 1u << 14;
constexpr double kMuchDearer = 10.0;

/// Whether a detector's sums can be made from visible faces. What no sum of its own has reads those of others.
bool solvable(const TableRow& row) {
  const DetectorRoom& room = room_of(row.id);
  return row.sums.empty() || room.solved != nullptr || room.binning != nullptr;
}

/// Why a detector's numbers cannot be exact; empty where they can.
std::string obstacle(const Scene& scene, const Geometry& geometry, const DetectorSpec& detector) {
  if (!solvable(table_row("detector", detector.kind))) return detector.kind + " follows scattered light";
  if (scene.trace.max_bounces > 1) return "light is followed over several bounces";
  for (const Material& m : scene.materials) {
    if (table_row("brdf", m.model).delta) return fmt::format("material {} is a mirror", m.name);
  }
  for (const Variant& v : scene.variants) {
    for (const Material& m : v.materials) {
      if (table_row("brdf", m.model).delta) return fmt::format("variant {} has a mirror", v.name);
    }
  }
  for (const Observer& o : scene.observers) {
    if (scene.trace.force_bistatic || !at_source(o, scene.source))
      return fmt::format("observer {} is not at the source", o.name);
  }
  if (!made_of_polygons(geometry)) return "a curved shape is in the scene";
  return {};
}

bool much_dearer(const Geometry& geometry, std::size_t views) {
  const auto count = static_cast<double>(views);
  const double exact = kSecondsPerFace * static_cast<double>(geometry.primitives.size()) * count;
  return exact > kMuchDearer * kSecondsPerRay * std::max(kDefaultRays, kLeastRaysPerView * count);
}

}  // namespace

MethodChoice choose_method(const Scene& scene, const Geometry& geometry, const DetectorSpec& detector,
                           std::size_t views) {
  const TraceOptions& t = scene.trace;
  if (t.method == Method::points) return {false, "points are asked for"};
  const std::string why = obstacle(scene, geometry, detector);
  if (t.method == Method::exact) {
    if (t.rays != 0) throw Error(ErrorCode::input, "method = \"exact\" traces no rays: leave rays out", "trace.rays");
    if (!why.empty()) throw Error(ErrorCode::input, "method = \"exact\" is not possible: " + why, "trace.method");
    return {true, "asked for"};
  }
  if (t.rays != 0) return {false, fmt::format("rays = {} are asked for", t.rays)};
  if (!why.empty()) return {false, why};
  if (much_dearer(geometry, views)) {
    return {false, fmt::format("{} faces in {} views would take much longer than rays; --method exact solves them",
                               geometry.primitives.size(), views)};
  }
  return {true, "one reflection from flat faces, seen from where the light comes"};
}

}  // namespace clray
