// SPDX-License-Identifier: Apache-2.0
// Which passes a scene takes: detectors that can share rays share a pass, and so do lanes (variants and bands).
#include <algorithm>
#include <cmath>

#include "pipeline/plan.hpp"
#include "pipeline/views.hpp"
#include "scene/motion.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

PassPlan beam_plan(const Scene& scene) {
  PassPlan plan;
  plan.phase = "trace";
  plan.orientations = orientations(scene);
  plan.connections = static_cast<std::uint32_t>(scene.observers.size());
  plan.replicates = static_cast<std::uint32_t>(scene.trace.replicates);
  return plan;
}

/// Wavelengths of a picture traced at once: what a hit costs is paid once for all of them. Their sums stay within a
/// quarter of a GiB, whatever the device, so that the digest is the same on all; the rest goes in further chunks.
std::size_t lanes_together(const DetectorSpec& spec, std::size_t views) {
  const double pixels = detector_value(spec, "width") * detector_value(spec, "height") * static_cast<double>(views);
  const double lanes = 0x1p28 / (pixels * 2.0 * sizeof(std::int64_t));
  return static_cast<std::size_t>(std::min(64.0, std::max(1.0, lanes)));
}

/// Directions of the Sun on a grid, body frame: elevations (from the xy plane) from -90 to 90 degrees inclusive,
/// azimuths (from +x toward +y) from 0 to 360 exclusive, one at the poles. Observers stay where the motion starts; one
/// at the source goes along with it.
std::vector<Orientation> sun_grid(const Scene& scene, int azimuths, int elevations) {
  const Orientation start = orientations(scene).front();
  std::vector<Orientation> grid;
  for (int e = 0; e < elevations; ++e) {
    const double elevation = -90.0 + 180.0 * e / (elevations - 1);
    const bool pole = e == 0 || e == elevations - 1;
    for (int a = 0; a < (pole ? 1 : azimuths); ++a) {
      Orientation orientation = start;
      orientation.source = direction_from_degrees(360.0 * a / azimuths, elevation);
      for (std::size_t o = 0; o < scene.observers.size(); ++o) {
        if (at_source(scene.observers[o], scene.source)) orientation.observers[o] = orientation.source;
      }
      grid.push_back(orientation);
    }
  }
  return grid;
}

/// The passes of a scene, detector by detector.
class PassPlanner {
 public:
  PassPlanner(const Scene& scene, const Geometry& geometry)
      : scene_(scene), geometry_(geometry), lanes_(lanes_of(scene)) {}

  std::vector<PassPlan> plan() {
    for (std::size_t d = 0; d < scene_.detectors.size(); ++d) {
      if (!is_grid(d)) next_orientation_ = orientations(scene_).size();
    }
    beam();
    for (const std::size_t d : pressures_) pressure(d);
    for (std::size_t d = 0; d < scene_.detectors.size(); ++d) {
      if (side(d) == "pixel") picture(d);
    }
    return std::move(passes_);
  }

 private:
  const std::string& side(std::size_t d) const {
    return table("detector")[table_index("detector", scene_.detectors[d].kind)].side;
  }
  bool is_grid(std::size_t d) const {
    return scene_.detectors[d].kind == "pressure" && detector_value(scene_.detectors[d], "azimuth_steps") > 0.0;
  }

  void set_pressure(std::size_t d, PassPlan* plan) const {
    plan->pressure = true;
    plan->pressure_detector = static_cast<int>(d);
    plan->thermal = detector_value(scene_.detectors[d], "thermal") != 0.0;
  }

  // What observers see, and the first pressure detector under the same light; others are left in pressures_.
  void beam() {
    PassPlan plan = beam_plan(scene_);
    for (std::size_t d = 0; d < scene_.detectors.size(); ++d) {
      const std::string& kind = scene_.detectors[d].kind;
      if (kind == "delay" || kind == "spectrometer") plan.connect = true;
      if (kind != "pressure") continue;
      if (plan.pressure || is_grid(d)) {
        pressures_.push_back(d);
      } else {
        set_pressure(d, &plan);
      }
    }
    if (plan.connect || plan.pressure) add(plan, lanes_.size());
  }

  void pressure(std::size_t d) {
    PassPlan plan = beam_plan(scene_);
    set_pressure(d, &plan);
    if (is_grid(d)) {
      plan.phase = "sun directions";
      plan.grid = true;
      plan.connections = 1;
      plan.orientations = sun_grid(scene_, static_cast<int>(detector_value(scene_.detectors[d], "azimuth_steps")),
                                   static_cast<int>(detector_value(scene_.detectors[d], "elevation_steps")));
      plan.first_orientation = next_orientation_;
      next_orientation_ += plan.orientations.size();
    }
    add(plan, lanes_.size());
  }

  void picture(std::size_t d) {
    const DetectorSpec& spec = scene_.detectors[d];
    for (std::size_t o = 0; o < scene_.observers.size(); ++o) {
      PassPlan plan = beam_plan(scene_);
      plan.phase = "pictures";
      plan.pixels = plan.connect = true;
      plan.pixel_detector = static_cast<int>(d);
      plan.pixel_observer = static_cast<int>(o);
      plan.connections = 1;
      plan.replicates = 2;
      plan.width = static_cast<std::uint32_t>(detector_value(spec, "width"));
      plan.height = static_cast<std::uint32_t>(detector_value(spec, "height"));
      plan.picture_samples = static_cast<std::uint32_t>(detector_value(spec, "samples"));
      add(plan, lanes_together(spec, plan.orientations.size()));
    }
  }

  // Plans the pass for each group of lanes that can go together.
  void add(const PassPlan& plan, std::size_t most_lanes) {
    const bool scatter = scene_.trace.max_bounces > 1 || plan.pressure;
    for (std::vector<Lane>& lanes : lane_groups(scene_, lanes_, scatter, most_lanes)) {
      PassPlan one = plan;
      one.lanes = std::move(lanes);
      passes_.push_back(plan_pass(scene_, geometry_, std::move(one)));
    }
  }

  const Scene& scene_;
  const Geometry& geometry_;
  const std::vector<Lane> lanes_;
  std::vector<std::size_t> pressures_;
  std::size_t next_orientation_ = 0;
  std::vector<PassPlan> passes_;
};

}  // namespace

std::vector<PassPlan> plan_passes(const Scene& scene, const Geometry& geometry) {
  return PassPlanner(scene, geometry).plan();
}

}  // namespace clray
