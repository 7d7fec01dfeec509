// SPDX-License-Identifier: Apache-2.0
// Range by time; see range.hpp.
#include "ephemeris/range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "ephemeris/site.hpp"

namespace clray::ephemeris {

namespace {

constexpr std::size_t kTablePoints = 4;   // of a cubic; a table with fewer points uses all of them
constexpr double kFirstMjd = -2400000.5;  // the Julian Date 0: a time 0 of Julian seconds

[[noreturn]] void refuse(const std::string& key, const std::string& what) {
  throw Error(ErrorCode::input, what, key);
}

void check_table(const std::vector<std::pair<double, double>>& table) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!(table[i].second > 0.0) || !std::isfinite(table[i].second)) {
      refuse("station.ranges", fmt::format("row {}: range is {} m; expected more than 0 m", i + 1, table[i].second));
    }
    if (!(std::fabs(table[i].first) <= kLatest_s)) {
      refuse("station.ranges",
             fmt::format("row {}: time is {} s; expected at most {} s from 0", i + 1, table[i].first, kLatest_s));
    }
    if (i > 0 && !(table[i].first > table[i - 1].first)) {
      refuse("station.ranges", fmt::format("row {}: time does not increase", i + 1));
    }
  }
}

/// A prediction as a target. Throws Error(input) where its positions are not Earth-fixed.
Target target_of(Trajectory prediction) {
  if (prediction.frame != Frame::itrf) {
    refuse(prediction.path,
           "its positions are not Earth-fixed (reference frame 0 of record H2); [pass] takes such a file");
  }
  auto shared = std::make_shared<const Trajectory>(std::move(prediction));
  return {shared->zero,
          shared->last_s(),
          [shared](double since_s) { return shared->at(since_s).value; },
          shared->path,
          shared->segments.front().positions.times().size(),
          shared->prediction};
}

/// Seconds, with enough digits to tell any two times apart.
std::string seconds_text(const Instant& time) {
  return fmt::format("{} s", static_cast<double>(time.s) + static_cast<double>(time.ps) * 1e-12);
}

}  // namespace

RangeModel::RangeModel(const Station& station)
    : range_m_(station.range_m), position_m_(station.position_m), zero_{kDefaultMjd, 0} {
  if (!(station.start_mjd >= kFirstMjd) || station.start_mjd > 1e6) {
    refuse("station.start_mjd", fmt::format("is {}; expected a Modified Julian Date", station.start_mjd));
  }
  const double day = std::floor(station.start_mjd);
  if (station.start_mjd != 0.0)
    zero_ = epoch_of(static_cast<std::int64_t>(day), (station.start_mjd - day) * kSecondsPerDay);
  if (!station.cpf_file.empty()) {
    target_ = target_of(read_cpf(station.cpf_file));
    const double radius = glm::length(position_m_);
    if (radius == 0.0) refuse("station.position_m", "is missing; expected Earth-fixed coordinates beside cpf");
    if (!(radius > 5e6 && radius < 8e6)) {
      refuse("station.position_m",
             fmt::format("lies {:.6g} m from the Earth's centre; expected Earth-fixed metres of a "
                         "place on its surface",
                         radius));
    }
    if (station.start_mjd == 0.0) zero_ = target_->zero;
  } else if (!station.ranges.empty()) {
    check_table(station.ranges);
    for (const auto& [time_s, range_m] : station.ranges) rows_.push_back({instant_of(time_s), range_m});
  } else if (!(station.range_m > 0.0) || !std::isfinite(station.range_m)) {
    refuse("station.range_m", fmt::format("is {}; expected more than 0 m", station.range_m));
  }
}

RangeModel::RangeModel(Target target, const Vec3& position_m, const Epoch& start)
    : target_(std::move(target)), position_m_(position_m), zero_(start), leaps_(true) {}

double RangeModel::distance_m(double since_s) const {
  double distance = glm::length(target_->place_m(since_s) - position_m_);
  // Each round reduces the error of the light time by v/c < 3e-5, so four rounds leave none.
  for (int round = 0; round < 4; ++round) {
    const double flight_s = distance / constants::kLightSpeed_m_s;
    const double next = glm::length(target_->place_m(since_s + flight_s) - position_m_);
    if (next == distance) break;
    distance = next;
  }
  return distance;
}

double RangeModel::table_range(const Instant& time) const {
  const auto outside = [&] {
    refuse("station.ranges", fmt::format("{} is outside the table ({} to {})", seconds_text(time),
                                         seconds_text(rows_.front().time), seconds_text(rows_.back().time)));
  };
  if (seconds_between(time, rows_.front().time) > 0.0 || seconds_between(rows_.back().time, time) > 0.0) outside();
  const auto above = std::upper_bound(rows_.begin(), rows_.end(), time, [](const Instant& t, const Row& row) {
    return seconds_between(t, row.time) > 0.0;
  });
  const auto after = static_cast<std::size_t>(above - rows_.begin());
  const std::size_t points = std::min(kTablePoints, rows_.size());
  const std::size_t first = std::min(after > points / 2 ? after - points / 2 : 0, rows_.size() - points);
  double range = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < points; ++j) {
      if (j == i) continue;
      const Instant& other = rows_[first + j].time;
      weight *= seconds_between(other, time) / seconds_between(other, rows_[first + i].time);
    }
    range += weight * rows_[first + i].range_m;
  }
  return range;
}

double RangeModel::range_m(const Instant& time) const {
  if (target_) return distance_m(since_first_s(time));
  return rows_.empty() ? range_m_ : table_range(time);
}

void RangeModel::check_covers(double start_s, double stop_s) const {
  const Instant start = instant_of(start_s), stop = instant_of(stop_s);
  const auto between = [](const std::string& from, const std::string& to) {
    return from == to ? from : from + " to " + to;
  };
  if (target_) {
    const double last = target_->last_s;
    const double end = std::clamp(since_first_s(stop), 0.0, last);
    const double flight = glm::length(target_->place_m(end) - position_m_) / constants::kLightSpeed_m_s;
    if (since_first_s(start) >= 0.0 && since_first_s(stop) + flight * (1.0 + 1e-4) <= last) return;
    refuse(target_->path,
           fmt::format("the prediction covers {}; the motion needs {}, and {:.3f} s more for the last pulse's flight "
                       "(its time 0 is {})",
                       between(date_text(target_->zero), date_text(later(target_->zero, last))),
                       between(date_text(epoch(start)), date_text(epoch(stop))), flight, date_text(zero_)));
  }
  if (rows_.empty()) return;
  if (seconds_between(rows_.front().time, start) >= 0.0 && seconds_between(stop, rows_.back().time) >= 0.0) return;
  refuse("station.ranges", fmt::format("the table covers {}; the motion needs {}",
                                       between(seconds_text(rows_.front().time), seconds_text(rows_.back().time)),
                                       between(seconds_text(start), seconds_text(stop))));
}

Sight RangeModel::sight(const Instant& time) const {
  const double since = since_first_s(time);
  const double flight = distance_m(since) / constants::kLightSpeed_m_s;
  return sight_of(position_m_, target_->place_m(since + flight) - position_m_);
}

double observer_range_m(const Observer& observer, const RangeModel* ranges, const Instant& time) {
  if (observer.range_m > 0.0) return observer.range_m;
  return ranges ? ranges->range_m(time) : 0.0;
}

}  // namespace clray::ephemeris
