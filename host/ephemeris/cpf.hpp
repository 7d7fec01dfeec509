// SPDX-License-Identifier: Apache-2.0
// ILRS Consolidated Prediction Format v2 (Ricklefs 2018): a strict reader of the subset that a session needs, and the
// interpolation that the format asks for. Earth-fixed metres, UTC.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "clray/scene.hpp"
#include "ephemeris/epoch.hpp"

namespace clray::ephemeris {

/// A prediction: header and positions (records 10).
struct Prediction {
  std::string path, source, target;
  int version = 2;
  int year = 0, month = 0, day = 0, hour = 0;  ///< of its making
  long sequence = 0, sub_daily = 0;
  std::string cospar, sic, norad;  ///< as written, "na" where missing
  long target_class = 0, target_location = 1;
  double step_s = 0.0;         ///< of the header; 0: variable
  Epoch first;                 ///< of the first position
  std::vector<double> time_s;  ///< from `first`
  std::vector<Vec3> position_m;
  /// For each first point of ten: 1 over the product of time differences in each point's Lagrange polynomial.
  std::vector<std::array<double, 10>> inverse_products;
};

/// Reads a file. Throws Error(input) with file:line for unknown or malformed records, another version, another frame
/// than Earth-fixed, epochs out of order, a gap in the table, a leap second, or a missing end (record 99).
Prediction read_cpf(const std::string& path);

/// Where the target is `time_s` after the first position: 9th-order Lagrange interpolation over the ten nearest
/// positions, five on each side except near the ends. Throws Error(input) outside the table.
Vec3 position_at(const Prediction& prediction, double time_s);

/// One-way distance that a pulse fired at `time_s` travels until it meets the target, m; the light time is solved for.
/// In the Earth-fixed frame the Earth's rotation cancels between up- and downlink, except for 5 um at 1000 km and 0.1
/// mm at 20000 km. The Shapiro delay (1.3 to 16 mm) is left out.
double distance_at(const Prediction& prediction, const Vec3& station_m, double time_s);

}  // namespace clray::ephemeris
