// SPDX-License-Identifier: Apache-2.0
// pressure.nc: the numbers of pressure.csv.
#include <functional>

#include "io/netcdf/records.hpp"

namespace clray::io {
namespace {

using Group = std::vector<const PressureResult*>;

/// The records of a grid by elevation and azimuth. A pole, which is traced once, stands at every azimuth.
Group filled(const Group& group, std::size_t azimuths, std::size_t elevations) {
  Group all;
  auto next = group.begin();
  for (std::size_t e = 0; e < elevations; ++e) {
    const bool pole = e == 0 || e + 1 == elevations;
    for (std::size_t a = 0; a < azimuths; ++a) all.push_back(pole ? *next : *next++);
    if (pole) ++next;
  }
  return all;
}

}  // namespace

void pressure_netcdf(Writer& writer, const Group& group, const std::string& stem,
                     const std::vector<double>& azimuths_deg, const std::vector<double>& elevations_deg) {
  const ResultKey& key = group.front()->key;
  NetcdfFile file = netcdf_file(writer, stem, "radiation force and torque of " + writer.title("pressure", key));
  file.attribute("comment", "force in N = force_coefficient * irradiance / 299792458 m/s; torque likewise");
  Group records = group;
  std::vector<std::string> along;
  if (!azimuths_deg.empty()) {
    records = filled(group, azimuths_deg.size(), elevations_deg.size());
    file.dimension("elevation", elevations_deg.size());
    file.dimension("azimuth", azimuths_deg.size());
    file.variable(
        {"elevation", {"elevation"}, "degree", "elevation of the source over the body's xy plane", elevations_deg});
    file.variable({"azimuth", {"azimuth"}, "degree", "azimuth of the source from the body's x over y", azimuths_deg});
    along = {"elevation", "azimuth"};
  } else if (group.size() > 1) {
    std::vector<std::size_t> orientations;
    for (const PressureResult* record : group) orientations.push_back(record->key.orientation);
    netcdf_time(file, writer, orientations);
    along = {"time"};
  }
  netcdf_vectors(file);
  std::vector<std::string> along_vectors = along;
  along_vectors.push_back("xyz");
  const auto vectors = [&](const std::function<Vec3(const PressureResult&)>& of) {
    std::vector<double> values;
    for (const PressureResult* record : records) {
      const Vec3 v = of(*record);
      values.insert(values.end(), {v.x, v.y, v.z});
    }
    return values;
  };
  const auto numbers = [&](const std::function<double(const PressureResult&)>& of) {
    std::vector<double> values;
    for (const PressureResult* record : records) values.push_back(of(*record));
    return values;
  };
  file.variable({"source_direction", along_vectors, "1", "direction of the source, body frame",
                 vectors([](const auto& r) { return r.sun; })});
  file.with_error({"force_coefficient", along_vectors, "m2", "force times speed of light over irradiance, body frame",
                   vectors([](const auto& r) { return r.coefficient_m2.value; })},
                  vectors([](const auto& r) { return r.coefficient_m2.standard_error; }));
  file.with_error({"torque_coefficient", along_vectors, "m3",
                   "torque about the reference point times speed of light over irradiance, body frame",
                   vectors([](const auto& r) { return r.torque_coefficient_m3.value; })},
                  vectors([](const auto& r) { return r.torque_coefficient_m3.standard_error; }));
  file.with_error({"absorbed", along, "m2", "absorbed power over irradiance",
                   numbers([](const auto& r) { return r.absorbed_m2.value; })},
                  numbers([](const auto& r) { return r.absorbed_m2.standard_error; }));
  file.variable({"source", along, "W m-2", "irradiance of the source in the light that pushes",
                 numbers([](const auto& r) { return r.source_W_m2; })});
  file.close();
}

}  // namespace clray::io
