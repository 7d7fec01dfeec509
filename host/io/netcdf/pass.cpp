// SPDX-License-Identifier: Apache-2.0
// pass.nc: the numbers of pass.csv. What is not known of an instant is missing.
#include <functional>
#include <limits>

#include "clray/constants.hpp"
#include "io/netcdf/records.hpp"

namespace clray::io {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Numbers of all instants; those that are not placed have none.
class Instants {
 public:
  Instants(NetcdfFile& file, const std::vector<PassInstant>& all) : file_(file), all_(all) {}

  void numbers(const std::string& name, const std::vector<std::string>& along, const std::string& units,
               const std::string& what, std::size_t count,
               const std::function<double(const PassInstant&, std::size_t)>& number) {
    std::vector<double> values;
    for (const PassInstant& instant : all_) {
      for (std::size_t i = 0; i < count; ++i) values.push_back(instant.placed ? number(instant, i) : kNan);
    }
    file_.variable({name, along, units, what, std::move(values)});
  }
  void vectors(const std::string& name, const std::string& units, const std::string& what,
               const std::function<Vec3(const PassInstant&)>& vector) {
    numbers(name, {"time", "xyz"}, units, what, 3,
            [&](const PassInstant& p, std::size_t axis) { return vector(p)[static_cast<int>(axis)]; });
  }

 private:
  NetcdfFile& file_;
  const std::vector<PassInstant>& all_;
};

void of_observers(NetcdfFile& file, Instants& instants, const Scene& scene) {
  std::vector<std::string> names;
  for (const Observer& observer : scene.observers) names.push_back(observer.name);
  const std::size_t count = names.size();
  file.dimension("observer", count);
  file.texts("observer", "observer", "name of the observer", names);
  instants.numbers(
      "observer_direction", {"time", "observer", "xyz"}, "1", "direction of the observer, body frame", 3 * count,
      [](const PassInstant& p, std::size_t i) { return p.view.observers[i / 3][static_cast<int>(i % 3)]; });
  instants.numbers("phase_angle", {"time", "observer"}, "degree", "angle source - body - observer", count,
                   [](const PassInstant& p, std::size_t i) { return phase_rad(p.view, i) * constants::kDegrees; });
}

void of_sites(NetcdfFile& file, Instants& instants, const Scene& scene, const std::vector<int>& sites) {
  std::vector<std::string> names;
  for (const int site : sites)
    names.push_back(site < 0 ? "station" : scene.observers[static_cast<std::size_t>(site)].name);
  file.dimension("site", names.size());
  file.texts("site", "site", "place on the Earth", names);
  const auto of = [&](const std::string& name, const std::string& units, const std::string& what,
                      const std::function<double(const SiteSight&)>& number) {
    instants.numbers(name, {"time", "site"}, units, what, names.size(), [&](const PassInstant& p, std::size_t i) {
      return i < p.sites.size() ? number(p.sites[i]) : kNan;
    });
  };
  of("range", "m", "range of the body", [](const SiteSight& s) { return s.range_m; });
  of("elevation", "degree", "elevation of the body",
     [](const SiteSight& s) { return s.elevation_rad * constants::kDegrees; });
  of("azimuth", "degree", "azimuth of the body from north over east",
     [](const SiteSight& s) { return s.azimuth_rad * constants::kDegrees; });
  of("seen", "1", "1 at or above the least elevation", [](const SiteSight& s) { return s.seen ? 1.0 : 0.0; });
  of("sun_elevation", "degree", "elevation of the Sun",
     [](const SiteSight& s) { return s.sun_elevation_rad * constants::kDegrees; });
  of("daylight", "1", "1 from sunrise to sunset", [](const SiteSight& s) { return s.daylight ? 1.0 : 0.0; });
}

}  // namespace

void pass_netcdf(Writer& writer) {
  const std::vector<PassInstant>& all = writer.result.instants;
  NetcdfFile file = netcdf_file(writer, "pass", "instants of a pass, traced or not, of " + writer.scene_name());
  std::vector<const PassInstant*> dated;
  std::vector<double> orientations;
  std::vector<std::string> reasons;
  for (const PassInstant& instant : all) {
    dated.push_back(&instant);
    orientations.push_back(instant.traced() ? static_cast<double>(instant.orientation) : kNan);
    reasons.push_back(instant.reason);
  }
  netcdf_dates(file, writer, dated);
  file.variable(
      {"orientation", {"time"}, "1", "number in other files; missing where nothing was traced", orientations});
  file.texts("reason", "time", "why the instant is not traced", reasons);
  netcdf_vectors(file);
  file.dimension("wxyz", 4);
  Instants instants(file, all);
  instants.numbers("sun_share", {"time"}, "1", "share of the Sun's disk past the Earth", 1,
                   [](const PassInstant& p, std::size_t) { return p.sun_share; });
  instants.vectors("position", "m", "place of the body, gcrf", [](const PassInstant& p) { return p.position_m; });
  instants.numbers("attitude", {"time", "wxyz"}, "1", "Hamilton quaternion w, x, y, z from the body frame to gcrf", 4,
                   [](const PassInstant& p, std::size_t i) {
                     const Quaternion& q = p.view.body_to_space;
                     const double parts[] = {q.w, q.x, q.y, q.z};
                     return parts[i];
                   });
  instants.vectors("light", "1", "direction of the light, body frame",
                   [](const PassInstant& p) { return p.view.source; });
  instants.vectors("sun", "1", "direction of the Sun, body frame", [](const PassInstant& p) { return p.sun; });
  of_observers(file, instants, writer.scene);
  if (const std::vector<int> sites = sites_of(writer.result); !sites.empty())
    of_sites(file, instants, writer.scene, sites);
  file.close();
}

}  // namespace clray::io
