// SPDX-License-Identifier: Apache-2.0
// Rules between a [station] and the rest of its scene: there is a range at every time of the motion, and one place has
// one range. Also what a person should know before a session is traced. It reads the prediction, so that --check finds
// its faults.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "ephemeris/range.hpp"
#include "scene/motion.hpp"
#include "scene/scene_parts.hpp"
#include "scene/tables.hpp"
#include "shared/portable.h"

namespace clray {
namespace {

using ephemeris::RangeModel;

constexpr double kMostShots = 1e12;

[[noreturn]] void fail(const std::string& where, const std::string& message) {
  throw Error(ErrorCode::input, message, where);
}

std::pair<double, double> span_of(const Scene& scene) {
  return scene.motion ? motion_span(*scene.motion) : std::pair{0.0, 0.0};
}

/// An observer at the laser's station must have the station's range.
void check_places(const Scene& scene, const RangeModel& ranges) {
  if (scene.source.kind != Source::Kind::laser) return;
  for (std::size_t i = 0; i < scene.observers.size(); ++i) {
    const Observer& o = scene.observers[i];
    if (!at_source(o, scene.source) || o.range_m == 0.0) continue;
    if (ranges.fixed() && o.range_m == scene.station->range_m) continue;
    fail(fmt::format("observers[{}].range_m", i),
         fmt::format(
             "is {} m, but this observer is at the source, whose range [station] gives{}; expected it there alone",
             o.range_m, ranges.fixed() ? fmt::format(" as {} m", scene.station->range_m) : ""));
  }
}

/// Why a scene with a station and a motion makes no session; empty where it does.
std::string session_gap(const Scene& scene) {
  if (scene.source.kind != Source::Kind::laser) return "the source is a sun, not a laser";
  const bool timed = std::any_of(scene.detectors.begin(), scene.detectors.end(),
                                 [](const DetectorSpec& d) { return d.kind == "delay"; });
  if (!timed) return "no detector is of the kind \"delay\"";
  std::string near;
  for (const Observer& o : scene.observers) {
    if (at_source(o, scene.source)) return "";
    if (o.toward != Toward::fixed || scene.source.toward != Toward::fixed) continue;
    const Vec3 d = o.direction - scene.source.direction;
    const double apart = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    if (apart < 1e-6) {
      near = fmt::format(" (observer{} is {:.2g} rad beside it: direction = \"source\" puts it there)",
                         o.name.empty() ? "" : " " + o.name, apart);
    }
  }
  return "no observer is at the source" + near;
}

/// The lowest elevation of the target during the motion, if it is below the horizon.
std::string below_horizon(const Scene& scene, const RangeModel& ranges) {
  constexpr int kSteps = 256;
  const auto [start, stop] = span_of(scene);
  double lowest = 10.0, when = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double since = (stop - start) * i / kSteps;
    const double elevation = ranges.elevation_rad(ephemeris::instant_of(start + since));
    if (elevation < lowest) {
      lowest = elevation;
      when = since;
    }
  }
  if (lowest >= 0.0) return "";
  return fmt::format(
      "the station would range through the Earth: the target stands at an elevation of {:.1f} degrees, "
      "{:.6g} s after the motion's start",
      lowest * 180.0 / CLRAY_PI, when);
}

}  // namespace

void check_ranging(const Scene& scene) {
  if (!scene.station || scene.pass) return;  // a pass has the range of its orbit (host/pass)
  const RangeModel ranges(*scene.station);
  const auto [start, stop] = span_of(scene);
  ranges.check_covers(start, stop);
  check_places(scene, ranges);
  const double shots = (stop - start) * scene.station->rate_Hz;
  if (scene.motion && session_gap(scene).empty() && !(shots < kMostShots)) {
    fail("station.rate_Hz",
         fmt::format("makes {:.3g} shots over the motion; expected fewer than {:.0e}", shots, kMostShots));
  }
}

std::vector<std::string> ranging_warnings(const Scene& scene) {
  std::vector<std::string> warnings;
  if (!scene.station) return warnings;
  if (scene.pass) {
    const std::string gap = session_gap(scene);
    if (!gap.empty()) warnings.push_back("a station and a pass, but no laser-ranging session: " + gap);
    return warnings;
  }
  const RangeModel ranges(*scene.station);
  if (scene.motion) {
    const std::string gap = session_gap(scene);
    if (!gap.empty()) warnings.push_back("a station and a motion, but no laser-ranging session: " + gap);
    const bool guessed = scene.station->start_mjd == 0.0 && !ranges.prediction();
    if (gap.empty() && guessed && std::fabs(span_of(scene).first) >= 1e8) {
      warnings.push_back(fmt::format(
          "station.start_mjd is not given: the motion's time 0 is taken as 2000-01-01 0h UTC, and the session dated {} "
          "(40587 is time 0 of Unix seconds, 44244 of GPS seconds, -2400000.5 of Julian seconds)",
          ephemeris::date_text(ranges.epoch(ephemeris::instant_of(span_of(scene).first)))));
    }
  }
  if (ranges.prediction()) {
    const std::string below = below_horizon(scene, ranges);
    if (!below.empty()) warnings.push_back(below);
  }
  return warnings;
}

std::string ranging_text(const Scene& scene) {
  if (scene.pass) return "";
  const RangeModel ranges(*scene.station);
  if (ranges.fixed()) return "";
  const auto [start, stop] = span_of(scene);
  std::string text = fmt::format("{:.6g} m", ranges.range_m(start));
  if (scene.motion) text += fmt::format(" at the motion's start, {:.6g} m at its end", ranges.range_m(stop));
  const ephemeris::Prediction* p = ranges.prediction();
  if (!p) return text;
  const double degrees = 180.0 / CLRAY_PI;
  return text + fmt::format("; elevation {:.1f} and {:.1f} degrees; target {} by {}, {} positions from {} over {} s",
                            ranges.elevation_rad(ephemeris::instant_of(start)) * degrees,
                            ranges.elevation_rad(ephemeris::instant_of(stop)) * degrees, p->target, p->source,
                            ranges.target()->rows, ephemeris::date_text(ranges.target()->zero),
                            ranges.target()->last_s);
}

}  // namespace clray
