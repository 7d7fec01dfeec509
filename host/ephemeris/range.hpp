// SPDX-License-Identifier: Apache-2.0
// How far the target is from the station: from a fixed range, a table, a prediction or the orbit of a pass, and the
// calendar of a scene's motion or pass. The one place that interpolates ranges; times are those of the motion or pass.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clray/scene.hpp"
#include "ephemeris/cpf.hpp"
#include "ephemeris/site.hpp"

namespace clray::ephemeris {

/// Epoch of the motion's time 0 where neither the station nor a prediction gives one: 2000-01-01 0h UTC.
inline constexpr std::int64_t kDefaultMjd = 51544;

/// Where the body is, Earth-fixed, at seconds from an epoch.
struct Target {
  Epoch zero;
  double last_s = 0.0;                  ///< known from 0 to here
  std::function<Vec3(double)> place_m;  ///< throws Error(input) where it is not known
  std::string path;                     ///< of its file
  std::size_t rows = 0;
  std::shared_ptr<const Prediction> prediction;  ///< header of a CPF, or null
};

class RangeModel {
 public:
  /// Reads the prediction if there is one. Throws Error(input).
  explicit RangeModel(const Station& station);

  /// Of a pass: a target and a place, both Earth-fixed. Times count SI seconds from the pass's start.
  RangeModel(Target target, const Vec3& position_m, const Epoch& start);

  /// One-way distance that a pulse fired at `time` travels, m; the light time is solved for. In the Earth-fixed frame
  /// the Earth's rotation cancels between up- and downlink, except for 5 um at 1000 km and 0.1 mm at 20000 km. The
  /// Shapiro delay (1.3 to 16 mm) is left out. Throws Error(input) outside table or prediction.
  double range_m(const Instant& time) const;
  double range_m(double time_s) const { return range_m(instant_of(time_s)); }

  /// Throws Error(input) unless the range is known from start to stop, the last pulse's flight included.
  void check_covers(double start_s, double stop_s) const;

  /// How high above the station's horizon (of the WGS 84 ellipsoid) the pulse fired at `time` meets the target; with a
  /// target alone.
  double elevation_rad(const Instant& time) const { return sight(time).elevation_rad; }
  /// Elevation and azimuth.
  Sight sight(const Instant& time) const;

  bool fixed() const { return !target_ && rows_.empty(); }

  /// Epoch of time 0.
  const Epoch& zero() const { return zero_; }
  /// Epoch of a time.
  Epoch epoch(const Instant& time) const { return leaps_ ? later(zero_, time) : epoch_of(zero_, time); }

  /// The target, or null without prediction or orbit; its prediction's header, or null.
  const Target* target() const { return target_ ? &*target_ : nullptr; }
  const Prediction* prediction() const { return target_ ? target_->prediction.get() : nullptr; }

 private:
  struct Row {
    Instant time;
    double range_m;
  };
  double since_first_s(const Instant& time) const { return seconds_between(target_->zero, epoch(time)); }
  double distance_m(double since_s) const;
  double table_range(const Instant& time) const;

  double range_m_ = 0.0;
  std::vector<Row> rows_;  ///< of a table
  std::optional<Target> target_;
  Vec3 position_m_{0.0};
  Epoch zero_;
  bool leaps_ = false;  ///< times count leap seconds
};

/// Distance from the body to an observer at `time`: the observer's own, else that of the station (`ranges`, or null),
/// else 0. An observer at a laser's station has the station's range.
double observer_range_m(const Observer& observer, const RangeModel* ranges, const Instant& time);

}  // namespace clray::ephemeris
