// SPDX-License-Identifier: Apache-2.0
// NetCDF files of results made by hand, read back through libnetcdf: dimensions, units, errors as ancillary variables
// and values. tests/readers/netcdf lets xarray read those of whole runs.
#include <doctest/doctest.h>
#include <netcdf.h>

#include <algorithm>

#include "clray/write.hpp"
#include "unit/io_support.hpp"

using namespace clray;
using io_test::Scratch;

namespace {

/// A NetCDF file being read; every call of libnetcdf must succeed.
class Reader {
 public:
  explicit Reader(const std::string& path) { REQUIRE(nc_open(path.c_str(), NC_NOWRITE, &file_) == NC_NOERR); }
  ~Reader() { nc_close(file_); }

  std::vector<std::pair<std::string, std::size_t>> dimensions(const std::string& variable) const {
    int count = 0, ids[NC_MAX_VAR_DIMS];
    REQUIRE(nc_inq_varndims(file_, id(variable), &count) == NC_NOERR);
    REQUIRE(nc_inq_vardimid(file_, id(variable), ids) == NC_NOERR);
    std::vector<std::pair<std::string, std::size_t>> all;
    for (int i = 0; i < count; ++i) {
      char name[NC_MAX_NAME + 1];
      std::size_t length = 0;
      REQUIRE(nc_inq_dim(file_, ids[i], name, &length) == NC_NOERR);
      all.emplace_back(name, length);
    }
    return all;
  }
  std::vector<double> values(const std::string& variable) const {
    std::size_t count = 1;
    for (const auto& dimension : dimensions(variable)) count *= dimension.second;
    std::vector<double> all(count);
    REQUIRE(nc_get_var_double(file_, id(variable), all.data()) == NC_NOERR);
    return all;
  }
  /// Of a variable, or of the file for "". Empty where there is none.
  std::string attribute(const std::string& variable, const std::string& name) const {
    const int of = variable.empty() ? NC_GLOBAL : id(variable);
    std::size_t length = 0;
    if (nc_inq_attlen(file_, of, name.c_str(), &length) != NC_NOERR) return "";
    std::string text(length, ' ');
    REQUIRE(nc_get_att_text(file_, of, name.c_str(), text.data()) == NC_NOERR);
    return text;
  }
  /// Rows of an array of characters.
  std::vector<std::string> texts(const std::string& variable) const {
    const auto shape = dimensions(variable);
    std::string block(shape[0].second * shape[1].second, ' ');
    REQUIRE(nc_get_var_text(file_, id(variable), block.data()) == NC_NOERR);
    std::vector<std::string> rows;
    for (std::size_t i = 0; i < shape[0].second; ++i)
      rows.push_back(block.substr(i * shape[1].second, shape[1].second).c_str());
    return rows;
  }

 private:
  int id(const std::string& variable) const {
    int found = -1;
    CAPTURE(variable);
    REQUIRE(nc_inq_varid(file_, variable.c_str(), &found) == NC_NOERR);
    return found;
  }
  int file_ = -1;
};

WriteOptions netcdf() {
  WriteOptions options;
  options.plots = false;
  options.netcdf = true;
  return options;
}

using Shape = std::vector<std::pair<std::string, std::size_t>>;

}  // namespace

TEST_CASE("delay.nc: bins along delay and time, errors as ancillary variables") {
  Scratch scratch;
  Result result = io_test::result();
  result.orientations.assign(2, {});
  result.orientations[1].time_s = 2.5;
  for (std::size_t o = 0; o < 2; ++o) result.delay.push_back(io_test::delay(8, o));
  const auto files = write_result(result, io_test::scene(), scratch / "out", netcdf());
  CHECK(std::count(files.begin(), files.end(), "delay.nc") == 1);
  const Reader file(scratch / "out/delay.nc");
  CHECK(file.attribute("", "Conventions") == "CF-1.11");
  CHECK(file.attribute("", "digest") == "00000000deadbeef");
  CHECK(file.dimensions("A_t") == Shape{{"time", 2}, {"delay", 8}});
  CHECK(file.attribute("A_t", "units") == "m2 sr-1 ns-1");
  CHECK(file.attribute("A_t", "ancillary_variables") == "A_t_error hits resolved A_t_upper_bound");
  CHECK(file.attribute("A_t", "coordinates") == "orientation");
  CHECK(file.attribute("A_t_error", "units") == "m2 sr-1 ns-1");
  CHECK(file.attribute("delay", "units") == "ns");
  CHECK(file.attribute("delay", "bounds") == "delay_edges");
  CHECK(file.attribute("delay_edges", "coordinates").empty());
  CHECK(file.attribute("time", "units") == "s");
  CHECK(file.values("time") == std::vector<double>{0.0, 2.5});
  const std::vector<double> A_t = file.values("A_t"), errors = file.values("A_t_error"),
                            bound = file.values("A_t_upper_bound");
  for (std::size_t o = 0; o < 2; ++o) {
    const DelayResult& d = result.delay[o];
    for (std::size_t i = 0; i < 8; ++i) {
      CHECK(A_t[8 * o + i] == d.bin_m2_per_sr[i] / (d.bin_width_s * 1e9));
      CHECK(errors[8 * o + i] == d.bin_standard_error[i] / (d.bin_width_s * 1e9));
      CHECK(std::isnan(bound[8 * o + i]) == (d.resolved[i] != 0));
    }
  }
  CHECK(file.values("A")[1] == 1.0 / 3.0);
  CHECK(file.values("A_error")[1] == 1e-3 / 7.0);
}

TEST_CASE("lightcurve.nc and spectrum.nc of a pass: dates, bands that differ in case alone, a record that is missing") {
  Scratch scratch;
  Result result = io_test::result();
  result.orientations.assign(2, {});
  for (std::size_t o = 0; o < 2; ++o) {
    PassInstant instant;
    instant.epoch = {61369, 43200000000000000 + static_cast<std::int64_t>(o) * 60000000000000};
    instant.orientation = o;
    instant.placed = true;
    instant.view.observers = {{0, 0, 1}};
    result.instants.push_back(instant);
    result.orientations[o].observers = {{0, 0, 1}};
    result.orientations[o].ranges_m = {1e6};
    for (const char* band : {"G", "g"}) {
      if (o == 1 && *band == 'g') continue;
      SpectrometerResult s;
      s.key = {"spectrometer", "", "", band, o};
      s.band = {band, 400, 500};
      s.magnitude_AB = *band + static_cast<double>(o);
      s.magnitude_Vega = s.magnitude_AB - 0.5;
      s.magnitude_standard_error = 0.125;
      result.spectrometer.push_back(s);
    }
  }
  write_result(result, io_test::scene("spectrometer"), scratch / "out", netcdf());
  for (const char* name : {"out/lightcurve.nc", "out/spectrum.nc"}) {
    CAPTURE(name);
    const Reader file(scratch / name);
    CHECK(file.dimensions("magnitude_AB") == Shape{{"time", 2}, {"band", 2}});
    CHECK(file.texts("band") == std::vector<std::string>{"G", "g"});
    CHECK(file.attribute("time", "units") == "seconds since 2026-11-25 12:00:00.000");
    CHECK(file.attribute("time", "calendar") == "standard");
    CHECK(file.values("time") == std::vector<double>{0.0, 60.0});
    CHECK(file.attribute("magnitude_Vega", "ancillary_variables") == "magnitude_error");
    CHECK(file.attribute("wavelength", "units") == "nm");
    const std::vector<double> magnitude = file.values("magnitude_AB");
    CHECK(magnitude[0] == 'G');
    CHECK(magnitude[1] == 'g');
    CHECK(magnitude[2] == 'G' + 1.0);
    CHECK(std::isnan(magnitude[3]));
    CHECK(file.values("magnitude_error")[2] == 0.125);
  }
}

TEST_CASE("pressure.nc: a grid by elevation and azimuth, its poles at every azimuth") {
  Scratch scratch;
  Result result = io_test::result();
  Scene scene = io_test::scene("pressure");
  scene.detectors[0].parameters = {{"azimuth_steps", 3.0}, {"elevation_steps", 3.0}};
  result.orientations.assign(5, {});
  for (std::size_t i = 0; i < 5; ++i) {
    PressureResult p;
    p.key = {"pressure", "", "", "", i};
    p.coefficient_m2.value = {1.0 + static_cast<double>(i), 0.0, 0.5};
    p.coefficient_m2.standard_error = {0.25, 0.0, 0.0};
    result.pressure.push_back(p);
  }
  write_result(result, scene, scratch / "out", netcdf());
  const Reader file(scratch / "out/pressure.nc");
  CHECK(file.dimensions("force_coefficient") == Shape{{"elevation", 3}, {"azimuth", 3}, {"xyz", 3}});
  CHECK(file.attribute("force_coefficient", "units") == "m2");
  CHECK(file.attribute("torque_coefficient", "units") == "m3");
  CHECK(file.attribute("force_coefficient", "ancillary_variables") == "force_coefficient_error");
  CHECK(file.values("elevation") == std::vector<double>{-90.0, 0.0, 90.0});
  CHECK(file.values("azimuth") == std::vector<double>{0.0, 120.0, 240.0});
  const std::vector<double> force = file.values("force_coefficient");
  for (std::size_t a = 0; a < 3; ++a) {
    CHECK(force[3 * a] == 1.0);
    CHECK(force[9 + 3 * a] == 2.0 + static_cast<double>(a));
    CHECK(force[18 + 3 * a] == 5.0);
  }
}
