// SPDX-License-Identifier: Apache-2.0
// Earth orientation parameters of the IERS: UT1 - UTC and the pole by day, from a file, or none.
#pragma once

#include <string>
#include <vector>

#include "ephemeris/epoch.hpp"

namespace clray::pass {

/// At one instant.
struct EarthAngles {
  double ut1_utc_s = 0.0;
  double pole_x_rad = 0.0, pole_y_rad = 0.0;
};

/// By day, linear between days; UT1 goes on evenly through a leap second.
class EarthOrientation {
 public:
  /// Zero at all times.
  EarthOrientation() = default;

  /// Reads "finals" files of the IERS (finals2000A.all and its like by columns, or .csv with ; or , and the names MJD,
  /// x_pole, y_pole, UT1-UTC), or a CSV file of mjd, ut1_utc_s, x_pole_arcsec, y_pole_arcsec. Days without UT1 are left
  /// out. Throws Error(input) with file:line.
  explicit EarthOrientation(const std::string& path);

  bool known() const { return !days_.empty(); }
  /// Throws Error(input) outside the file's days.
  EarthAngles at(const ephemeris::Epoch& epoch) const;

 private:
  struct Day {
    double mjd = 0.0, ut1_tai_s = 0.0, x_arcsec = 0.0, y_arcsec = 0.0;
  };
  void add(int line, double mjd, double ut1_utc_s, double x_arcsec, double y_arcsec);
  void read_columns(const std::vector<std::string>& lines);
  void read_names(const std::vector<std::string>& lines);

  std::string path_;
  std::vector<Day> days_;
};

}  // namespace clray::pass
