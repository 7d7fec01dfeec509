// SPDX-License-Identifier: Apache-2.0
// Steps of a pass by time or by angle; see instants.hpp.
#include "pass/instants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "pass/geometry.hpp"
#include "scene/scene_parts.hpp"
#include "text/columns.hpp"

namespace clray::pass {

namespace {

/// The largest angle by which light or an observer moves in the body frame.
double moved_rad(const PassInstant& a, const PassInstant& b) {
  const auto angle = [](const Vec3& u, const Vec3& v) {
    return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
  };
  double most = angle(a.view.source, b.view.source);
  for (std::size_t i = 0; i < a.view.observers.size(); ++i)
    most = std::max(most, angle(a.view.observers[i], b.view.observers[i]));
  return most;
}

/// Goes along the pass in steps so small that no turn is missed, and takes an instant wherever the aspect has moved by
/// the angle since the last one.
class AngleSteps {
 public:
  AngleSteps(const Geometry& geometry, const Pass& pass) : geometry_(geometry), pass_(pass) {
    longest_s_ = std::max(1e-6, std::min(30.0, pass.stop_s / 16.0));
    if (const double turn_s = geometry.attitude().short_time_s(); turn_s > 0.0)
      longest_s_ = std::min(longest_s_, turn_s);
  }

  std::vector<PassInstant> all() {
    std::vector<PassInstant> found{geometry_.at(0.0)};
    PassInstant here = found.front();
    double step = longest_s_;
    while (here.time_s < pass_.stop_s) {
      const double to = std::min(here.time_s + step, pass_.stop_s);
      PassInstant next = geometry_.at(to);
      if (++looks_ > kMostLooks) {
        fail_pass(pass_, "step_deg",
                  fmt::format(
                      "the aspect moves too fast for a pass of {:g} s: {} instants within its first {:g} s; expected a "
                      "larger angle, a shorter pass, or step_s",
                      pass_.stop_s, found.size(), here.time_s));
      }
      if (!here.placed || !next.placed) {
        // Where the orbit's file begins or ends, to the shortest step; nothing turns while nothing is known.
        if (here.placed != next.placed && to - here.time_s > 0.01) {
          step = 0.5 * (to - here.time_s);
          continue;
        }
        if (here.placed != next.placed) add(next, &found);
        here = std::move(next);
        step = longest_s_;
        continue;
      }
      const double moved = moved_rad(here, next);
      if (moved > 0.25 * pass_.step_rad && to - here.time_s > 1e-6) {
        step = 0.5 * (to - here.time_s);
        continue;
      }
      if (moved_rad(found.back(), next) > pass_.step_rad) {
        add(edge(here.time_s, to, found.back()), &found);
        next = found.back();
      }
      here = std::move(next);
      if (moved < 0.1 * pass_.step_rad) step = std::min(1.5 * step, longest_s_);
    }
    return found;
  }

 private:
  void add(const PassInstant& instant, std::vector<PassInstant>* found) const {
    found->push_back(instant);
    if (static_cast<double>(found->size()) > kMostInstants) fail_many_instants(pass_, "step_deg");
  }

  /// The last time between two at which the aspect is still within the angle of `from`.
  PassInstant edge(double low, double high, const PassInstant& from) const {
    for (int i = 0; i < 30 && high - low > 1e-9; ++i) {
      const double middle = 0.5 * (low + high);
      (moved_rad(from, geometry_.at(middle)) <= pass_.step_rad ? low : high) = middle;
    }
    return geometry_.at(low > from.time_s ? low : high);
  }

  const Geometry& geometry_;
  const Pass& pass_;
  static constexpr int kMostLooks = 1000000;  // about a minute
  double longest_s_ = 0.0;
  int looks_ = 0;
};

std::vector<double> times_of(const Pass& pass) {
  if (!pass.times_s.empty()) return pass.times_s;
  // The end counts where rounding puts it a little behind the last step.
  const double steps = std::floor(pass.stop_s / pass.step_s * (1.0 + 1e-12) + 1e-9);
  if (!(steps < kMostInstants)) fail_many_instants(pass, "step_s");
  std::vector<double> times;
  for (double i = 0.0; i <= steps; i += 1.0) times.push_back(std::min(i * pass.step_s, pass.stop_s));
  return times;
}

/// "3 below min_elevation_deg, 2 in the Earth's shadow".
std::string reasons_text(const std::vector<PassInstant>& instants) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (const PassInstant& instant : instants) {
    if (instant.traced()) continue;
    auto count = std::find_if(counts.begin(), counts.end(), [&](const auto& c) { return c.first == instant.reason; });
    if (count == counts.end()) count = counts.insert(counts.end(), {instant.reason, 0});
    ++count->second;
  }
  std::string text;
  for (const auto& [reason, count] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, reason);
  return text;
}

std::vector<PassInstant> instants_of(const Geometry& geometry, const Scene& scene) {
  const Pass& pass = *scene.pass;
  std::vector<PassInstant> all;
  if (pass.times_s.empty() && pass.step_rad > 0.0) {
    all = AngleSteps(geometry, pass).all();
  } else {
    for (const double time : times_of(pass)) all.push_back(geometry.at(time));
  }
  std::size_t traced = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].until_s = i + 1 < all.size() ? all[i + 1].time_s : std::max(pass.stop_s, all[i].time_s);
    if (all[i].placed) all[i].until_s = std::min(all[i].until_s, geometry.orbit().covered_until(all[i].time_s));
    if (all[i].traced()) all[i].orientation = traced++;
  }
  if (traced > 0) return all;
  const bool reached = std::any_of(all.begin(), all.end(), [](const PassInstant& i) { return i.placed; });
  if (!reached && all.front().reason == "no ephemeris") {
    fail_pass(pass, "ephemeris",
              fmt::format("the orbit covers {}; the pass needs {} to {}", geometry.orbit().trajectory().span_text(),
                          ephemeris::date_text(all.front().epoch), ephemeris::date_text(all.back().epoch)));
  }
  fail_pass(pass, "start", fmt::format("nothing to trace: of {} instants, {}", all.size(), reasons_text(all)));
}

double degrees(double rad) {
  return rad * 180.0 / constants::kPi;
}

/// Least and greatest of what a function gives of the traced instants.
template <class Of>
std::pair<double, double> range_of(const std::vector<PassInstant>& instants, const Of& of) {
  std::pair<double, double> range{1e300, -1e300};
  for (const PassInstant& instant : instants) {
    if (!instant.traced()) continue;
    range.first = std::min(range.first, of(instant));
    range.second = std::max(range.second, of(instant));
  }
  return range;
}

std::string observer_name(const Scene& scene, int observer) {
  if (observer < 0) return "station " + scene.station->name;
  const std::string& name = scene.observers[static_cast<std::size_t>(observer)].name;
  return name.empty() ? "observer" : "observer " + name;
}

}  // namespace

std::vector<Orientation> views(const Scene& scene) {
  std::vector<Orientation> all;
  for (PassInstant& instant : pass_instants(scene)) {
    if (instant.traced()) all.push_back(std::move(instant.view));
  }
  return all;
}

ephemeris::RangeModel range_model(const Scene& scene) {
  if (!scene.pass) return ephemeris::RangeModel(*scene.station);
  if (scene.station->position_m == Vec3(0.0))
    throw Error(ErrorCode::input, "missing; expected the station's place beside [pass]", "station.position_m");
  const auto orbit = std::make_shared<const Orbit>(*scene.pass);
  const ephemeris::Trajectory& t = orbit->trajectory();
  ephemeris::Target target{scene.pass->start,
                           orbit->last_s(),
                           [orbit](double s) { return orbit->earth_fixed(s); },
                           t.path,
                           t.segments.front().positions.times().size(),
                           t.prediction};
  return {std::move(target), scene.station->position_m, scene.pass->start};
}

}  // namespace clray::pass

namespace clray {

std::vector<PassInstant> pass_instants(const Scene& scene) {
  if (!scene.pass) return {};
  return pass::instants_of(pass::Geometry(scene), scene);
}

std::vector<std::string> pass_warnings(const Scene& scene) {
  std::vector<std::string> warnings;
  if (!scene.pass) return warnings;
  const pass::Geometry geometry(scene);
  const std::vector<PassInstant> instants = pass::instants_of(geometry, scene);
  if (scene.pass->eop.empty()) {
    const bool fixed = geometry.orbit().trajectory().frame == Frame::itrf;
    warnings.push_back(
        std::string("pass.eop is not given: UT1 is taken as UTC and the pole as at rest. The Earth may then "
                    "stand up to 14 arcsec off against the stars: ") +
        (fixed ? "so do the Sun and attitudes in space; ranges and elevations keep, as the orbit is "
                 "Earth-fixed"
               : "a site is up to 440 m off its place"));
  }
  const auto blind = std::count_if(instants.begin(), instants.end(),
                                   [](const PassInstant& i) { return i.reason.compare(0, 3, "no ") == 0; });
  if (blind > 0) {
    warnings.push_back(fmt::format("of {} instants of the pass {} are not traced, as files do not reach them: {}",
                                   instants.size(), blind, pass::reasons_text(instants)));
  }
  const PassInstant& first = *std::find_if(instants.begin(), instants.end(), [](const auto& i) { return i.traced(); });
  for (std::size_t s = 0; s < first.sites.size(); ++s) {
    const auto hidden = std::count_if(instants.begin(), instants.end(),
                                      [&](const PassInstant& i) { return i.traced() && !i.sites[s].seen; });
    if (hidden > 0) {
      warnings.push_back(
          fmt::format("the {} has the body below min_elevation_deg at {} of the traced instants; its "
                      "records there are not what it sees (pass.csv says when)",
                      pass::observer_name(scene, first.sites[s].observer), hidden));
    }
  }
  return warnings;
}

std::string describe_pass(const Scene& scene) {
  if (!scene.pass) return "";
  const pass::Geometry geometry(scene);
  const std::vector<PassInstant> all = pass::instants_of(geometry, scene);
  const ephemeris::Trajectory& orbit = geometry.orbit().trajectory();
  static const char* const kFrames[] = {"gcrf", "eme2000", "tod", "teme", "itrf"};
  const auto traced = std::count_if(all.begin(), all.end(), [](const PassInstant& i) { return i.traced(); });
  const std::string skipped = pass::reasons_text(all);
  text::Columns lines;
  lines.add({"orbit", fmt::format("{}{} in {}, {}, from {}", orbit.object,
                                  orbit.prediction ? " by " + orbit.prediction->source : "",
                                  kFrames[static_cast<int>(orbit.frame)], orbit.method, orbit.span_text())});
  lines.add(
      {"instants", fmt::format("{} from {} to {}: {} traced{}", all.size(), ephemeris::iso_text(all.front().epoch),
                               ephemeris::iso_text(all.back().epoch), traced, skipped.empty() ? "" : ", " + skipped)});
  const auto add = [&](const std::string& what, const std::string& unit, double scale, const auto& of) {
    const auto [low, high] = pass::range_of(all, of);
    lines.add({what, fmt::format("{:.6g} to {:.6g} {}", scale * low, scale * high, unit)});
  };
  const PassInstant& first = *std::find_if(all.begin(), all.end(), [](const auto& i) { return i.traced(); });
  for (std::size_t s = 0; s < first.sites.size(); ++s) {
    const std::string name = pass::observer_name(scene, first.sites[s].observer);
    add(name + ": elevation", "deg", pass::degrees(1.0),
        [&](const PassInstant& i) { return i.sites[s].elevation_rad; });
    add(name + ": range", "km", 1e-3, [&](const PassInstant& i) { return i.sites[s].range_m; });
  }
  for (std::size_t o = 0; o < scene.observers.size(); ++o) {
    add(pass::observer_name(scene, static_cast<int>(o)) + ": phase angle", "deg", pass::degrees(1.0),
        [&](const PassInstant& i) {
          const Vec3 &s = i.view.source, &v = i.view.observers[o];
          return std::atan2(glm::length(glm::cross(s, v)), glm::dot(s, v));
        });
  }
  if (scene.source.toward == Toward::sun)
    add("share of the Sun", "", 1.0, [](const PassInstant& i) { return i.sun_share; });
  lines.add({"aberration", scene.pass->aberration
                               ? "of the moving body, taken in"
                               : "left out: up to 26 arcsec toward the Sun, 5 arcsec toward a site"});
  std::string text = "pass\n" + lines.text("  ");
  for (const std::string& warning : pass_warnings(scene)) text += "warning: " + warning + "\n";
  return text;
}

}  // namespace clray
