// SPDX-License-Identifier: Apache-2.0
// Which passes a scene takes: detectors that can share rays share a pass, and so do lanes (variants and bands).
#include <algorithm>
#include <cmath>
#include <map>

#include "beam/illumination.hpp"
#include "pipeline/method.hpp"
#include "pipeline/plan.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

constexpr std::size_t kMostLanes = 64;  // of a pass: more take more registers than they save hits

/// How many lanes of a picture are traced together, so that each hit is found once for all of them. Their sums stay
/// within a quarter of a GiB on every device, because the digest depends on the number. The rest follow in later
/// passes.
std::size_t lanes_together(const DetectorSpec& spec, std::size_t views) {
  const double pixels = detector_value(spec, "width") * detector_value(spec, "height") * static_cast<double>(views);
  const double lanes = 0x1p28 / (pixels * 2.0 * sizeof(std::int64_t));
  return static_cast<std::size_t>(std::min(static_cast<double>(kMostLanes), std::max(1.0, lanes)));
}

/// The requests of a scene, detector by detector.
class Requests {
 public:
  Requests(const Scene& scene, const Geometry& geometry)
      : scene_(scene), geometry_(geometry), instants_(views_of_motion(scene)) {}

  std::vector<PassRequest> all() {
    for (std::size_t d = 0; d < scene_.detectors.size(); ++d) {
      if (!is_grid(d)) next_orientation_ = instants_.size();
    }
    beam();
    for (std::size_t d = 0; d < scene_.detectors.size(); ++d) {
      if (is_grid(d)) grid(d);
    }
    for (std::size_t d = 0; d < scene_.detectors.size(); ++d) {
      if (row(d).pixel) picture(d);
    }
    return std::move(requests_);
  }

 private:
  const TableRow& row(std::size_t d) const { return table_row("detector", scene_.detectors[d].kind); }
  bool is_grid(std::size_t d) const {
    return find_key(row(d), "azimuth_steps") != nullptr && detector_value(scene_.detectors[d], "azimuth_steps") > 0.0;
  }

  PassRequest request(const char* phase) const {
    PassRequest r;
    r.phase = phase;
    r.orientations = instants_;
    r.replicates = static_cast<std::uint32_t>(scene_.trace.replicates);
    return r;
  }

  // Every detector whose rays start at the beam from the scene's own direction: one request for all that want the
  // same lanes, and one for those that take a wide band in parts. What can be solved needs no rays and goes apart.
  // Rays whose first hits are not connected serve detectors that have these solved, and those that connect nothing.
  void beam() {
    PassRequest all = request("trace");
    for (std::size_t o = 0; o < scene_.observers.size(); ++o) all.observers.push_back(static_cast<int>(o));
    std::vector<MethodChoice> choices(scene_.detectors.size());
    bool first_connected = false;
    for (std::size_t d = 0; d < scene_.detectors.size(); ++d) {
      if (!row(d).beam || is_grid(d)) continue;
      choices[d] = choose_method(scene_, geometry_, scene_.detectors[d], instants_.size());
      first_connected = first_connected || (choices[d].how == PassMethod::first_exact && row(d).connects);
    }
    // Those that are solved first; of each method those in parts last.
    std::map<std::pair<int, bool>, PassRequest> requests;
    for (std::size_t d = 0; d < scene_.detectors.size(); ++d) {
      if (!row(d).beam || is_grid(d)) continue;
      const bool in_parts = lanes_of(scene_, row(d)).front().share < 1.0;
      if (in_parts && choices[d].how == PassMethod::tiles) choices[d].how = PassMethod::points;
      const PassMethod how = choices[d].how;
      const bool joins = row(d).connects ? how == PassMethod::first_exact : first_connected;
      const int rank = how == PassMethod::exact ? 0 : how == PassMethod::tiles ? 1 : joins && !in_parts ? 2 : 3;
      PassRequest& request = requests.try_emplace({rank, in_parts}, by(how, all)).first->second;
      add_detector(d, choices[d], request);
    }
    const bool apart = std::any_of(requests.begin(), requests.end(), [](const auto& r) { return !r.first.second; });
    for (auto& [key, request] : requests) {
      request.apart = key.second && apart;
      add(request, kMostLanes);
    }
  }

  static PassRequest by(PassMethod how, PassRequest request) {
    if (how == PassMethod::first_exact) return request;
    request.how = how;
    request.one_bounce = how == PassMethod::tiles;
    if (how == PassMethod::exact) request.replicates = 1;
    if (how == PassMethod::exact) request.phase = "exact";
    return request;
  }

  void add_detector(std::size_t d, const MethodChoice& choice, PassRequest& request) const {
    const DetectorSpec& spec = scene_.detectors[d];
    request.detectors.push_back(static_cast<int>(d));
    if (choice.how == PassMethod::first_exact) request.first_exact.push_back(static_cast<int>(d));
    request.method.push_back(shown_name(spec) + ", " + method_name(choice.how) + ": " + choice.why);
  }

  void grid(std::size_t d) {
    const DetectorSpec& spec = scene_.detectors[d];
    PassRequest r = request("sun directions");
    r.observers = {0};
    r.grid = r.apart = true;
    r.orientations = views_of_grid(scene_, static_cast<int>(detector_value(spec, "azimuth_steps")),
                                   static_cast<int>(detector_value(spec, "elevation_steps")));
    r.first_orientation = next_orientation_;
    next_orientation_ += r.orientations.size();
    const MethodChoice choice = choose_method(scene_, geometry_, spec, r.orientations.size());
    r = by(choice.how, r);
    add_detector(d, choice, r);
    add(r, kMostLanes);
  }

  void picture(std::size_t d) {
    const DetectorSpec& spec = scene_.detectors[d];
    for (std::size_t o = 0; o < scene_.observers.size(); ++o) {
      PassRequest r = request("pictures");
      r.detectors = {static_cast<int>(d)};
      r.observers = {static_cast<int>(o)};
      r.pixels = true;
      r.replicates = 2;
      r.picture.width = static_cast<std::uint32_t>(detector_value(spec, "width"));
      r.picture.height = static_cast<std::uint32_t>(detector_value(spec, "height"));
      r.picture.samples = static_cast<std::uint32_t>(detector_value(spec, "samples"));
      const std::size_t first = requests_.size();
      add(r, lanes_together(spec, r.orientations.size()));
      mirrors(first, requests_.size());
    }
  }

  // Beside each pixel pass under mirrors (which go alone) one of the light that they send on.
  void mirrors(std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k) {
      PassRequest r = requests_[k];
      const Observer& observer = scene_.observers[static_cast<std::size_t>(r.observers.front())];
      if (scene_.trace.max_bounces == 1 && !(observer.acceptance_rad > 0.0)) continue;
      if (!material_table(scene_, r.lanes).delta) continue;
      r.pixels = false;
      r.mirrors = true;
      requests_.push_back(std::move(r));
    }
  }

  // A request for each group of lanes that can go together.
  void add(const PassRequest& all, std::size_t most_lanes) {
    const bool scatter =
        scene_.trace.max_bounces > 1 || std::any_of(all.detectors.begin(), all.detectors.end(),
                                                    [&](int d) { return row(static_cast<std::size_t>(d)).scatters; });
    const std::vector<Lane> lanes = lanes_of(scene_, row(static_cast<std::size_t>(all.detectors.front())));
    for (std::vector<Lane>& group : lane_groups(scene_, lanes, scatter, most_lanes)) {
      requests_.push_back(all);
      requests_.back().lanes = std::move(group);
    }
  }

  const Scene& scene_;
  const Geometry& geometry_;
  const std::vector<Orientation> instants_;
  std::size_t next_orientation_ = 0;
  std::vector<PassRequest> requests_;
};

}  // namespace

std::vector<PassRequest> pass_requests(const Scene& scene, const Geometry& geometry) {
  return Requests(scene, geometry).all();
}

}  // namespace clray
