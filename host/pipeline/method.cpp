// SPDX-License-Identifier: Apache-2.0
// See method.hpp.
#include "pipeline/method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/detector.hpp"
#include "clray/error.hpp"
#include "exact/beam_faces.hpp"
#include "exact/unsolved.hpp"
#include "pipeline/course.hpp"
#include "pipeline/detector/room.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

// Seconds on one core, as bodies of 36 to 10^6 faces took (clray-bench method). Their ratios decide.
constexpr double kSecondsPerFace = 8e-6;                                   // of a view that is solved
constexpr double kSecondsPerCutFace = 4e-6, kSecondsPerTile = 10e-6;       // of a view in tiles
constexpr double kSecondsPerTileFace = 1e-9;                               // of each tile, whose lists are longer
constexpr double kSecondsPerSeenFace = 8e-6, kSecondsPerSeenTile = 50e-6;  // and of each that is not from the source
constexpr double kSecondsPerTreeFace = 2e-6;                               // of the tree that rays need
constexpr double kSecondsPerRay = 0.05e-6, kSecondsPerLevel = 0.03e-6;     // and of each level of that tree
constexpr double kTilesOfPercent = 1000.0, kRaysOfPercent = 8000.0;        // that reach 1 %
constexpr double kTilesPower = 1.5, kRaysPower = 0.75;                     // with which errors fall (docs/error.md)
constexpr double kRandomPower = 0.5;                                       // the same while faces are smaller
constexpr double kSeenShare = 0.5;                                         // of the faces that look at the observer
constexpr double kSearchAndConfirm = 3.0;                                  // times as many rays as the answer's
constexpr double kMuchDearer = 20.0;

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

/// The same of a body's shapes.
std::string obstacle(const Geometry& geometry, const DetectorSpec& detector) {
  if (geometry.primitives.size() >> kFaceRankBits != 0) return "the body has too many faces";
  if (!any_polygons(geometry)) return "every shape is curved";
  // What curved shapes shade would be missing in the momentum of all light.
  if (!table_row("detector", detector.kind).connects && !all_polygons(geometry))
    return "a curved shape is in the scene";
  return {};
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
  std::string found;
  const auto add = [&](const char* what) { found += (found.empty() ? "" : ", ") + std::string(what); };
  if (scene.trace.max_bounces > 1 && (body == nullptr || !body->convex())) add("further bounces");
  // Mirrors reach cones alone: rays find which.
  const bool connects = table_row("detector", detector.kind).connects;
  if (connects && misfit(scene, [](const TableRow& model) { return !model.delta; })) add("mirrors");
  if (body != nullptr && !all_polygons(*body)) add("curved shapes and what they may shade");
  return found;
}

/// What solving a body so many times takes, s on one core.
double seconds_to_solve(const Geometry& geometry, std::size_t times) {
  return kSecondsPerFace * static_cast<double>(geometry.primitives.size()) * static_cast<double>(times);
}

/// How many faces of one size would share their area as unevenly as those of a body: a spacecraft of 20,000 faces
/// counts as 170, since few of them are most of it.
double even_faces(const Geometry& geometry) {
  double sum = 0.0, squares = 0.0;
  for (const ClrayPrimitive& p : geometry.primitives) {
    const double area = primitive_area(geometry, p);
    sum += area;
    squares += area * area;
  }
  return squares > 0.0 ? sum * sum / squares : 0.0;
}

/// How many tiles reach an error, %. Where they are larger than the faces that matter, their points are as good as
/// random ones; then errors fall faster.
double tiles_to(double percent, const Geometry& geometry) {
  const double turn = std::max(kTilesOfPercent, kSeenShare * even_faces(geometry));
  const double reached = std::pow(kTilesOfPercent / turn, kRandomPower);  // at that number, %
  const double tiles = percent > reached ? kTilesOfPercent * std::pow(percent, -1.0 / kRandomPower)
                                         : turn * std::pow(reached / percent, 1.0 / kTilesPower);
  return std::max(static_cast<double>(kFirstPoints), tiles);
}

/// What tiles take to reach the target, s on one core. `elsewhere`: observers that are not at the source.
double seconds_of_tiles(const Scene& scene, const Geometry& geometry, std::size_t views, std::size_t elsewhere) {
  const double tiles = tiles_to(scene.trace.target_error_percent, geometry);
  const auto faces = static_cast<double>(geometry.primitives.size());
  const double seen = kSecondsPerSeenFace * faces + kSecondsPerSeenTile * tiles;
  const bool at_source = scene.observers.size() > elsewhere;
  return (seen * static_cast<double>(elsewhere) +
          (at_source ? kSecondsPerCutFace * faces + (kSecondsPerTile + kSecondsPerTileFace * faces) * tiles : 0.0)) *
         static_cast<double>(views);
}

/// What so many rays take, and the tree that they need.
double seconds_of_rays(const Geometry& geometry, double rays) {
  const auto faces = static_cast<double>(geometry.primitives.size());
  return kSecondsPerTreeFace * faces + (kSecondsPerRay + kSecondsPerLevel * std::log2(faces + 1.0)) * rays;
}

/// What rays take to the target, or as many as are traced by default. Each asks what hides its hit from every observer
/// elsewhere.
double seconds_of_points(const Scene& scene, const Geometry& geometry, std::size_t views, std::size_t elsewhere) {
  const double least = static_cast<double>(kFirstPoints) * scene.trace.replicates;
  const double asked = 1.0 + static_cast<double>(elsewhere);
  if (scene.trace.target_error_percent == 0.0)
    return seconds_of_rays(geometry,
                           asked * std::max(static_cast<double>(kDefaultRays), least * static_cast<double>(views)));
  const double answer = std::max(least, kRaysOfPercent * std::pow(scene.trace.target_error_percent, -1.0 / kRaysPower));
  return seconds_of_rays(geometry, asked * kSearchAndConfirm * answer * static_cast<double>(views));
}

/// Why tiles cannot find a detector's numbers; empty: they can.
std::string obstacle_to_tiles(const Scene& scene, const Geometry& geometry, const DetectorSpec& detector) {
  if (!table_row("detector", detector.kind).connects) return detector.kind + " is not of light toward observers";
  const std::string sampled = rest(scene, detector, &geometry);
  return sampled.empty() ? "" : "rays must find " + sampled;
}

}  // namespace

std::string method_name(PassMethod how) {
  switch (how) {
    case PassMethod::points:
      return "points";
    case PassMethod::first_exact:
      return "first bounce exact";
    case PassMethod::tiles:
      return "tiles";
    case PassMethod::exact:
      break;
  }
  return "exact";
}

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
  const auto points = [](const std::string& because) { return MethodChoice{PassMethod::points, because}; };
  if (t.method == Method::points) return points("asked for");
  std::string why = obstacle(scene, detector);
  if (why.empty()) why = obstacle(geometry, detector);
  const std::string sampled = why.empty() ? rest(scene, detector, &geometry) : "";
  const auto solved = [&](const std::string& because) {
    return sampled.empty() ? MethodChoice{PassMethod::exact, because}
                           : MethodChoice{PassMethod::first_exact, because + "; rays find " + sampled};
  };
  if (t.method == Method::exact) {
    if (!why.empty())
      throw Error(ErrorCode::input,
                  "method = \"exact\" is not possible for the detector " + shown_name(detector) + ": " + why,
                  "trace.method");
    if (t.rays != 0 && sampled.empty())
      throw Error(ErrorCode::input, "method = \"exact\" traces no rays here: leave rays out", "trace.rays");
    return solved("asked for");
  }
  const std::string no_tiles = why.empty() ? obstacle_to_tiles(scene, geometry, detector) : why;
  const bool connects = table_row("detector", detector.kind).connects;
  if (t.method == Method::tiles && connects) {
    if (!no_tiles.empty())
      throw Error(ErrorCode::input,
                  "method = \"tiles\" is not possible for the detector " + shown_name(detector) + ": " + no_tiles,
                  "trace.method");
    return {PassMethod::tiles, "asked for"};
  }
  if (t.rays != 0) return points(fmt::format("rays = {} are asked for", t.rays));
  if (!why.empty()) return points(why);
  const std::size_t sights = sights_of(scene, detector);
  const double seconds = seconds_to_solve(geometry, views * sights);
  const double with_rays = seconds_of_points(scene, geometry, views, sights - 1);
  if (t.target_error_percent > 0.0) {
    const double with_tiles = no_tiles.empty() ? seconds_of_tiles(scene, geometry, views, sights - 1) : HUGE_VAL;
    const std::string sooner = fmt::format("they reach {:g} % sooner than all is solved", t.target_error_percent);
    if (with_rays < std::min(seconds, with_tiles)) return points(sooner);
    if (with_tiles < seconds) return {PassMethod::tiles, sooner};
  }
  // An exact pass that time cuts off has no result.
  if (t.time_limit_s > 0.0 && seconds > 0.5 * t.time_limit_s) {
    const std::string late = fmt::format("solving it may take longer than the time limit of {:g} s", t.time_limit_s);
    return no_tiles.empty() ? MethodChoice{PassMethod::tiles, late} : points(late);
  }
  if (seconds > kMuchDearer * with_rays) {
    return points(fmt::format("{} faces in {} views would take much longer than rays; --method exact solves them",
                              geometry.primitives.size(), views));
  }
  return solved("one reflection from flat faces");
}

}  // namespace clray
