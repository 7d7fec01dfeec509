// SPDX-License-Identifier: Apache-2.0
// How far the target is from the station: from a fixed range, a table or a prediction, and the calendar of a scene's
// motion. The one place that interpolates ranges; times are those of the motion.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clray/scene.hpp"
#include "ephemeris/cpf.hpp"

namespace clray::ephemeris {

/// Epoch of the motion's time 0 where neither the station nor a prediction gives one: 2000-01-01 0h UTC.
inline constexpr std::int64_t kDefaultMjd = 51544;

class RangeModel {
 public:
  /// Reads the prediction if there is one. Throws Error(input).
  explicit RangeModel(const Station& station);

  /// One-way distance that a pulse fired at `time` travels, m. Throws Error(input) outside table or prediction.
  double range_m(const Instant& time) const;
  double range_m(double time_s) const { return range_m(instant_of(time_s)); }

  /// Throws Error(input) unless the range is known from start to stop, the last pulse's flight included.
  void check_covers(double start_s, double stop_s) const;

  /// How high above the station's horizon (of the WGS 84 ellipsoid) the pulse fired at `time` meets the target; with a
  /// prediction alone.
  double elevation_rad(const Instant& time) const;

  bool fixed() const { return !prediction_ && rows_.empty(); }

  /// Epoch of time 0.
  const Epoch& zero() const { return zero_; }

  const Prediction* prediction() const { return prediction_.get(); }

 private:
  struct Row {
    Instant time;
    double range_m;
  };
  double since_first_s(const Instant& time) const;
  double table_range(const Instant& time) const;

  double range_m_ = 0.0;
  std::vector<Row> rows_;  ///< of a table
  std::unique_ptr<Prediction> prediction_;
  Vec3 position_m_{0.0};
  Epoch zero_;
};

/// Distance from the body to an observer at `time`: the observer's own, else that of the station (`ranges`, or null),
/// else 0. An observer at a laser's station has the station's range.
double observer_range_m(const Observer& observer, const RangeModel* ranges, const Instant& time);

}  // namespace clray::ephemeris
