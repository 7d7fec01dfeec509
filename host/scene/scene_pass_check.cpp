// SPDX-License-Identifier: Apache-2.0
// Rules between a [pass] and the rest of its scene, for scene files and for scenes filled by hand. What its files hold
// is checked where its instants are computed (host/pass).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "scene/file/keys.hpp"
#include "scene/scene_parts.hpp"
#include "scene/spectrum.hpp"

namespace clray {
namespace {

constexpr double kMostShots = 1e12;

[[noreturn]] void fail(const std::string& where, const std::string& message) {
  throw Error(ErrorCode::input, message, where);
}

bool has_place(const Station& station) {
  return station.position_m != Vec3(0.0);
}

/// Without a pass there are fixed directions only.
void check_without(const Scene& scene) {
  if (scene.source.toward != Toward::fixed) {
    fail("source.direction", "moves with a pass; expected a [pass], or a vector");
  }
  for (std::size_t i = 0; i < scene.observers.size(); ++i) {
    if (scene.observers[i].toward != Toward::fixed)
      fail(fmt::format("observers[{}].direction", i), "moves with a pass; expected a [pass], \"source\" or a vector");
  }
}

void check_station(const Scene& scene) {
  const bool shines = scene.source.toward == Toward::station;
  bool looks = false;
  for (const Observer& o : scene.observers) looks = looks || o.toward == Toward::station;
  if ((shines || looks) && (!scene.station || !has_place(*scene.station))) {
    fail("station.position_m", fmt::format("missing; {} at the station", shines ? "the source is" : "an observer is"));
  }
  if (!scene.station) return;
  if (scene.source.kind == Source::Kind::laser && !has_place(*scene.station))
    fail("station.position_m", "missing; a pass needs the station's place, or [station] left out");
  const Station& s = *scene.station;
  const double radius =
      std::sqrt(s.position_m.x * s.position_m.x + s.position_m.y * s.position_m.y + s.position_m.z * s.position_m.z);
  if (has_place(s) && !(radius > 6.3e6 && radius < 1.7e7)) {
    fail("station.position_m",
         fmt::format("lies {:.6g} m from the Earth's centre; expected Earth-fixed metres of a place on its surface",
                     radius));
  }
  if (s.range_m != Station{}.range_m) fail("station.range_m", "given beside [pass], whose orbit gives the range");
  if (scene.source.kind == Source::Kind::laser && !(scene.pass->stop_s * s.rate_Hz < kMostShots)) {
    fail("station.rate_Hz", fmt::format("makes {:.3g} shots over the pass; expected fewer than {:.0e}",
                                        scene.pass->stop_s * s.rate_Hz, kMostShots));
  }
  if (!s.ranges.empty()) fail("station.ranges", "given beside [pass], whose orbit gives the range");
  if (!s.cpf_file.empty()) fail("station.cpf", "given beside [pass]; expected it as pass.ephemeris");
  if (s.start_mjd != 0.0) fail("station.start_mjd", "given beside [pass], which has a start of its own");
}

/// The steps whose number is known without the orbit.
void check_steps(const Pass& pass) {
  if (!pass.times_s.empty()) return;
  if (pass.step_s > 0.0 && !(pass.stop_s / pass.step_s < kMostInstants)) fail_many_instants(pass, "step_s");
  const PassAttitude& a = pass.attitude;
  const bool spins = a.law == PassAttitude::Law::spin && a.file.empty() && a.attitudes.empty();
  if (spins && pass.step_rad > 0.0 &&
      !(pass.stop_s / a.spin_period_s * 2.0 * constants::kPi / pass.step_rad < kMostInstants))
    fail_many_instants(pass, "step_deg");
}

}  // namespace

std::string extinction_fault(const Scene& scene, const Observer& o) {
  if (o.extinction_mag.empty()) return "";
  const bool at_laser = o.monostatic && scene.source.kind == Source::Kind::laser;
  if (!scene.pass || !(o.toward == Toward::site || o.toward == Toward::station || at_laser))
    return "needs the elevation of the body; expected a [pass], and a site of this observer";
  if (o.extinction_mag.count("") > 0) return "";
  std::vector<std::string> names;
  for (const Band& band : bands_of(scene)) names.push_back(band.name);
  for (const auto& entry : o.extinction_mag) {
    if (std::find(names.begin(), names.end(), entry.first) == names.end())
      return fmt::format("there is no band \"{}\"; expected {}", entry.first, fmt::join(names, ", "));
  }
  for (const std::string& name : names) {
    if (o.extinction_mag.count(name) == 0) return fmt::format("a number for the band \"{}\" is missing", name);
  }
  return "";
}

void fail_pass(const Pass& pass, const std::string& key, const std::string& what) {
  const auto place = pass.places.find(key);
  if (place == pass.places.end()) fail("pass." + key, what);
  fail(place->second, "pass." + key + ": " + what);
}

void fail_many_instants(const Pass& pass, const std::string& key) {
  fail_pass(pass, key, fmt::format("makes more than {:g} instants", kMostInstants));
}

void check_pass(const Scene& scene) {
  for (std::size_t i = 0; i < scene.observers.size(); ++i) {
    if (const std::string fault = extinction_fault(scene, scene.observers[i]); !fault.empty())
      fail(fmt::format("observers[{}].extinction_mag", i), fault);
  }
  if (!scene.pass) return check_without(scene);
  const Pass& p = *scene.pass;
  if (scene.motion) fail("motion", "given beside a pass; expected only one of them");
  check_keys("pass", p);
  check_keys("pass.attitude", p.attitude);
  if (p.times_s.empty() && p.step_s == 0.0 && p.step_rad == 0.0) fail("pass.step_s", "missing; expected a step");
  check_steps(p);
  if (p.ephemeris.empty()) fail("pass.ephemeris", "missing; expected the name of a file");
  if (scene.source.kind == Source::Kind::laser && scene.source.toward == Toward::sun)
    fail("source.direction", "is the Sun's, of a laser; expected kind = \"sun\"");
  check_station(scene);
}

}  // namespace clray
