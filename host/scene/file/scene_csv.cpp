// SPDX-License-Identifier: Apache-2.0
// Reads the CSV tables of a scene: which columns each has, what their values may be, axes increasing. Part of reading a
// scene; csv_table.cpp finds the columns.
#include "scene/file/scene_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "ephemeris/epoch.hpp"
#include "scene/file/toml_reader.hpp"
#include "shared/portable.h"

namespace clray {
namespace {

[[noreturn]] void fail(const std::string& file, int line, const std::string& message) {
  throw Error(ErrorCode::input, message, line > 0 ? fmt::format("{}:{}", file, line) : file);
}

void check_range(const CsvTable& t, std::size_t row, const std::string& column, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    fail(t.file, t.lines[row], fmt::format("{}: expected a number in [{},{}], found {}", column, low, high, value));
  }
}

void check_increasing(const CsvTable& t, const std::string& column) {
  for (std::size_t i = 1; i < t.rows.size(); ++i) {
    if (!(t.rows[i][0] > t.rows[i - 1][0])) {
      fail(t.file, t.lines[i],
           fmt::format("{}: must increase from row to row, but {} follows {}", column, t.rows[i][0], t.rows[i - 1][0]));
    }
  }
}

/// The distinct values of a column, increasing.
std::vector<double> axis_of(const CsvTable& t, std::size_t column) {
  std::vector<double> axis;
  for (const auto& row : t.rows) axis.push_back(row[column]);
  std::sort(axis.begin(), axis.end());
  axis.erase(std::unique(axis.begin(), axis.end()), axis.end());
  return axis;
}

}  // namespace

Spectrum read_spectrum(const std::string& file, const CsvColumn& value, double low, double high) {
  const CsvTable t = read_csv(file, {{{"wavelength", "lambda"}, "nm"}, value});
  check_increasing(t, "wavelength_nm");
  Spectrum s;
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    check_range(t, i, "wavelength_nm", t.rows[i][0], 1e-3, 1e9);
    check_range(t, i, "value", t.rows[i][1], low, high);
    s.wavelength_nm.push_back(t.rows[i][0]);
    s.value.push_back(t.rows[i][1]);
  }
  return s;
}

std::vector<std::pair<double, double>> read_pairs(const std::string& file, const CsvColumn& time,
                                                  const CsvColumn& value, double low, double high) {
  const CsvTable t = read_csv(file, {time, value});
  check_increasing(t, time.shown());
  std::vector<std::pair<double, double>> pairs;
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    check_range(t, i, time.shown(), t.rows[i][0], kTime.low, kTime.high);
    check_range(t, i, value.shown(), t.rows[i][1], low, high);
    pairs.emplace_back(t.rows[i][0], t.rows[i][1]);
  }
  return pairs;
}

namespace {

/// Columns of attitudes behind the time; they must be named: others put the scalar last.
std::vector<CsvColumn> attitude_columns(bool dated) {
  CsvColumn time{{"time", "t"}, "s"};
  time.dated = dated;
  return {time, {{"qw"}, ""}, {{"qx"}, ""}, {{"qy"}, ""}, {{"qz"}, ""}};
}

Quaternion unit_quaternion(const CsvTable& t, std::size_t i) {
  const std::vector<double>& r = t.rows[i];
  const double l = std::sqrt(r[1] * r[1] + r[2] * r[2] + r[3] * r[3] + r[4] * r[4]);
  if (!(std::fabs(l - 1.0) <= 1e-3)) {
    fail(t.file, t.lines[i], fmt::format("qw,qx,qy,qz: expected a quaternion of length 1, found length {}", l));
  }
  return Quaternion(r[1] / l, r[2] / l, r[3] / l, r[4] / l);
}

}  // namespace

std::vector<Attitude> read_attitudes(const std::string& file) {
  const CsvTable t = read_csv(file, attitude_columns(false), CsvHeader::required);
  check_increasing(t, "time_s");
  std::vector<Attitude> all;
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    check_range(t, i, "time_s", t.rows[i][0], kTime.low, kTime.high);
    all.push_back({t.rows[i][0], unit_quaternion(t, i)});
  }
  return all;
}

std::optional<Epoch> first_date(const CsvTable& table) {
  return table.epochs.empty() ? std::optional<Epoch>() : table.epochs.front();
}

std::vector<double> read_times(const CsvTable& t, const Epoch& start) {
  std::vector<double> times;
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    times.push_back(t.epochs.empty() ? t.rows[i][0] : ephemeris::seconds_between(start, t.epochs[i]));
    check_range(t, i, "time_s", times[i], kTime.low, kTime.high);
    if (i > 0 && !(times[i] > times[i - 1])) {
      fail(t.file, t.lines[i],
           fmt::format("time: must increase from row to row, but it is {} s after the one before",
                       times[i] - times[i - 1]));
    }
  }
  return times;
}

std::vector<Attitude> read_dated_attitudes(const std::string& file, const Epoch& start) {
  const CsvTable t = read_csv(file, attitude_columns(true), CsvHeader::required);
  const std::vector<double> times = read_times(t, start);
  std::vector<Attitude> all;
  for (std::size_t i = 0; i < t.rows.size(); ++i) all.push_back({times[i], unit_quaternion(t, i)});
  return all;
}

std::vector<Directions::Row> read_directions(const std::string& file, const Epoch& start) {
  CsvColumn time{{"time", "t"}, "s"}, range{{"range", "distance"}, "m"};
  time.dated = range.optional = true;
  const CsvTable t = read_csv(file, {time, {{"x"}, ""}, {{"y"}, ""}, {{"z"}, ""}, range}, CsvHeader::required);
  const std::vector<double> times = read_times(t, start);
  std::vector<Directions::Row> rows;
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    const std::vector<double>& r = t.rows[i];
    const double largest = std::max({std::fabs(r[1]), std::fabs(r[2]), std::fabs(r[3])});
    if (largest == 0.0) fail(file, t.lines[i], "x,y,z: expected a direction, found the zero vector");
    const Vec3 v(r[1] / largest, r[2] / largest, r[3] / largest);
    Directions::Row row{times[i], v / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z), 0.0};
    if (!std::isnan(r[4])) {
      check_range(t, i, "range_m", r[4], 1e-3, 1e13);
      row.range_m = r[4];
    }
    rows.push_back(row);
  }
  return rows;
}

BrdfTable read_brdf_table(const std::string& file) {
  const CsvTable t =
      read_csv(file, {{{"theta_i"}, "deg"}, {{"theta_o"}, "deg"}, {{"phi"}, "deg"}, {{"value", "brdf"}, ""}});
  BrdfTable b;
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    check_range(t, i, "theta_i_deg", t.rows[i][0], 0.0, 90.0);
    check_range(t, i, "theta_o_deg", t.rows[i][1], 0.0, 90.0);
    check_range(t, i, "phi_deg", t.rows[i][2], 0.0, 180.0);
    check_range(t, i, "value", t.rows[i][3], 0.0, 1e12);
  }
  const std::vector<double> axes[3] = {axis_of(t, 0), axis_of(t, 1), axis_of(t, 2)};
  // The product of three sizes may not fit into 64 bits. A grid far from full is refused before it is allocated.
  const double product =
      static_cast<double>(axes[0].size()) * static_cast<double>(axes[1].size()) * static_cast<double>(axes[2].size());
  if (product > 8.0 * static_cast<double>(t.rows.size()) + 1000.0) {
    fail(file, 0,
         fmt::format("{} rows are no full grid of {} x {} x {} angles", t.rows.size(), axes[0].size(), axes[1].size(),
                     axes[2].size()));
  }
  const auto cells = static_cast<std::size_t>(product);
  std::vector<int> line_of(cells, 0);
  b.value.assign(cells, 0.0);
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    std::size_t cell = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = std::lower_bound(axes[k].begin(), axes[k].end(), t.rows[i][k]) - axes[k].begin();
      cell = cell * axes[k].size() + static_cast<std::size_t>(at);
    }
    if (line_of[cell] != 0) fail(file, t.lines[i], fmt::format("the same angles as line {}", line_of[cell]));
    line_of[cell] = t.lines[i];
    b.value[cell] = t.rows[i][3];
  }
  const auto missing = std::find(line_of.begin(), line_of.end(), 0);
  if (missing != line_of.end()) {
    const std::size_t cell = static_cast<std::size_t>(missing - line_of.begin());
    const std::size_t n2 = axes[2].size(), n1 = axes[1].size();
    fail(file, 0,
         fmt::format("the grid of {} x {} x {} angles lacks theta_i_deg {}, theta_o_deg {}, phi_deg {}", axes[0].size(),
                     n1, n2, axes[0][cell / (n1 * n2)], axes[1][cell / n2 % n1], axes[2][cell % n2]));
  }
  const auto radians = [](std::vector<double> degrees) {
    for (double& d : degrees) d = d / 180.0 * CLRAY_PI;
    return degrees;
  };
  b.theta_i_rad = radians(axes[0]);
  b.theta_o_rad = radians(axes[1]);
  b.phi_rad = radians(axes[2]);
  return b;
}

}  // namespace clray
