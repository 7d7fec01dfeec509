// SPDX-License-Identifier: Apache-2.0
// What NetCDF files share: the run, time, vectors and bands; see records.hpp.
#include "ephemeris/epoch.hpp"
#include "io/netcdf/records.hpp"
#include "text/text.hpp"

namespace clray::io {
namespace {

/// UTC between two epochs as calendars count it, without leap seconds.
double calendar_s(const Epoch& from, const Epoch& to) {
  return static_cast<double>(to.mjd - from.mjd) * 86400.0 + static_cast<double>(to.ps - from.ps) * 1e-12;
}

/// "2026-11-25 17:20:00.000": an epoch in the words of UDUNITS.
std::string udunits_date(const Epoch& epoch) {
  std::string date = ephemeris::iso_text(epoch);
  if (!date.empty() && date.back() == 'Z') date.pop_back();
  if (const std::size_t at = date.find('T'); at != std::string::npos) date[at] = ' ';
  return date;
}

}  // namespace

NetcdfFile netcdf_file(Writer& writer, const std::string& stem, const std::string& title) {
  NetcdfFile file(writer.folder.path(writer.add(stem, "nc")), title);
  file.attribute("scene", writer.scene.path.empty() ? writer.scene.name : writer.scene.path);
  file.attribute("seed", std::to_string(writer.result.seed));
  file.attribute("digest", hex16(writer.result.digest));
  return file;
}

void netcdf_time(NetcdfFile& file, const Writer& writer, const std::vector<std::size_t>& orientations) {
  const std::vector<const PassInstant*> instants = traced_instants(writer.result);
  std::vector<double> times, numbers;
  std::vector<const PassInstant*> dated;
  for (const std::size_t o : orientations) {
    if (o < instants.size() && instants[o] != nullptr) dated.push_back(instants[o]);
    times.push_back(o < writer.result.orientations.size() ? writer.result.orientations[o].time_s : 0.0);
    numbers.push_back(static_cast<double>(o));
  }
  if (!orientations.empty() && dated.size() == orientations.size()) {
    netcdf_dates(file, writer, dated);
  } else {
    file.dimension("time", orientations.size());
    file.variable({"time", {"time"}, "s", "time of the motion", std::move(times), {{"axis", "T"}}});
  }
  file.variable(
      {"orientation", {"time"}, "1", "number of the orientation in other files", std::move(numbers), {}, true});
}

void netcdf_dates(NetcdfFile& file, const Writer& writer, const std::vector<const PassInstant*>& instants) {
  const Epoch zero = writer.result.instants.front().epoch;
  std::vector<double> times;
  for (const PassInstant* instant : instants) times.push_back(calendar_s(zero, instant->epoch));
  file.dimension("time", instants.size());
  file.variable({"time",
                 {"time"},
                 "seconds since " + udunits_date(zero),
                 "time, UTC",
                 std::move(times),
                 {{"axis", "T"}, {"standard_name", "time"}, {"calendar", "standard"}}});
}

void netcdf_vectors(NetcdfFile& file) {
  file.dimension("xyz", 3);
  file.texts("xyz", "xyz", "axis of the body frame", {"x", "y", "z"});
}

void netcdf_bands(NetcdfFile& file, const std::vector<std::string>& names, const std::vector<Band>& bands) {
  file.dimension("band", bands.size());
  file.dimension("ends", 2);
  file.texts("band", "band", "name of the band", names);
  std::vector<double> centres, ends;
  for (const Band& band : bands) {
    centres.push_back(0.5 * (band.low_nm + band.high_nm));
    ends.push_back(band.low_nm);
    ends.push_back(band.high_nm);
  }
  file.variable({"wavelength",
                 {"band"},
                 "nm",
                 "centre of the band",
                 std::move(centres),
                 {{"standard_name", "radiation_wavelength"}, {"bounds", "wavelength_ends"}},
                 true});
  file.variable({"wavelength_ends", {"band", "ends"}, "nm", "ends of the band", std::move(ends)});
}

}  // namespace clray::io
