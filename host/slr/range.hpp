// SPDX-License-Identifier: Apache-2.0
// Where the target is during a session: one-way distance by time of fire, from a fixed range, a table or a prediction,
// and the session's calendar. Times in s of the scene's motion.
#pragma once

#include <memory>

#include "clray/scene.hpp"
#include "slr/cpf.hpp"

namespace clray::slr {

/// Epoch of session time 0 where neither the station nor a prediction gives one: 2000-01-01 0h UTC.
inline constexpr std::int64_t kDefaultMjd = 51544;

class RangeModel {
 public:
  /// Reads the prediction if there is one. Throws Error(input).
  explicit RangeModel(const Station& station);

  /// One-way distance that a pulse fired at `time_s` travels, m. Throws Error(input) outside table or prediction.
  double range_m(double time_s) const;

  bool fixed() const { return !prediction_ && station_.ranges.empty(); }

  /// Epoch of time 0.
  const Epoch& zero() const { return zero_; }

  const Prediction* prediction() const { return prediction_.get(); }

 private:
  Station station_;
  std::unique_ptr<Prediction> prediction_;
  Epoch zero_;
  double prediction_offset_s_ = 0.0;  ///< of time 0 from the prediction's first position
};

}  // namespace clray::slr
