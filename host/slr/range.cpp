// SPDX-License-Identifier: Apache-2.0
// Range by time; see range.hpp.
#include "slr/range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"

namespace clray::slr {

namespace {

constexpr std::size_t kTablePoints = 4;  // a cubic through the four nearest points; all of them where there are fewer

[[noreturn]] void refuse(const std::string& key, const std::string& what) {
  throw Error(ErrorCode::input, what, key);
}

void check_table(const std::vector<std::pair<double, double>>& table) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!(table[i].second > 0.0) || !std::isfinite(table[i].second) || !std::isfinite(table[i].first)) {
      refuse("station.ranges", fmt::format("row {}: range is {} m; expected more than 0 m", i + 1, table[i].second));
    }
    if (i > 0 && !(table[i].first > table[i - 1].first)) {
      refuse("station.ranges", fmt::format("row {}: time does not increase", i + 1));
    }
  }
}

double table_range(const std::vector<std::pair<double, double>>& table, double time_s) {
  if (!(time_s >= table.front().first && time_s <= table.back().first)) {
    refuse("station.ranges",
           fmt::format("{:.6f} s is outside the table ({} to {} s)", time_s, table.front().first, table.back().first));
  }
  const auto above =
      std::upper_bound(table.begin(), table.end(), time_s, [](double t, const auto& row) { return t < row.first; });
  const auto after = static_cast<std::size_t>(above - table.begin());
  const std::size_t points = std::min(kTablePoints, table.size());
  const std::size_t first = std::min(after > points / 2 ? after - points / 2 : 0, table.size() - points);
  double range = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < points; ++j) {
      if (j != i) weight *= (time_s - table[first + j].first) / (table[first + i].first - table[first + j].first);
    }
    range += weight * table[first + i].second;
  }
  return range;
}

}  // namespace

RangeModel::RangeModel(const Station& station) : station_(station), zero_{kDefaultMjd, 0} {
  if (!(station.start_mjd >= 0.0) || station.start_mjd > 1e6) {
    refuse("station.start_mjd", fmt::format("is {}; expected 0 or a Modified Julian Date", station.start_mjd));
  }
  const double day = std::floor(station.start_mjd);
  if (station.start_mjd > 0.0) zero_ = epoch_of(static_cast<std::int64_t>(day), (station.start_mjd - day) * 86400.0);
  if (!station.cpf_file.empty()) {
    prediction_ = std::make_unique<Prediction>(read_cpf(station.cpf_file));
    const Vec3& p = station.position_m;
    if (p == Vec3(0.0)) refuse("station.position_m", "is missing; expected Earth-fixed coordinates beside cpf");
    if (station.start_mjd == 0.0) zero_ = prediction_->first;
    prediction_offset_s_ = seconds_between(prediction_->first, zero_);
  } else if (!station.ranges.empty()) {
    check_table(station.ranges);
  } else if (!(station.range_m > 0.0) || !std::isfinite(station.range_m)) {
    refuse("station.range_m", fmt::format("is {}; expected more than 0 m", station.range_m));
  }
}

double RangeModel::range_m(double time_s) const {
  if (prediction_) return distance_at(*prediction_, station_.position_m, prediction_offset_s_ + time_s);
  return station_.ranges.empty() ? station_.range_m : table_range(station_.ranges, time_s);
}

}  // namespace clray::slr
