// SPDX-License-Identifier: Apache-2.0
// ILRS Consolidated Prediction Format, versions 1 (Ricklefs 2006) and 2 (Ricklefs 2018): a reader of what a pass and a
// session need. Metres; Earth-fixed, or of the two celestial frames that the format knows; UTC.
#pragma once

#include <string>

#include "ephemeris/trajectory.hpp"

namespace clray::ephemeris {

/// What the header of a prediction says.
struct Prediction {
  std::string source, target;
  int version = 2;
  int year = 0, month = 0, day = 0, hour = 0;  ///< of its making
  long sequence = 0;                           ///< of the day; of version 1 also what part of the day it is
  long sub_daily = 0;                          ///< of version 2
  std::string cospar, sic, norad;              ///< as written, "na" where missing
  long target_class = 0, target_location = 1;
  double step_s = 0.0;  ///< of the header; 0: variable
};

/// Reads a file: one segment, interpolated by polynomials of the 9th order as the format asks for. Blank lines, free
/// notes and lower case are taken as archives have them. Throws Error(input) with file:line for unknown or malformed
/// records, another version, epochs out of order, a gap in the table, or a missing end (record 99).
Trajectory read_cpf(const std::string& path);

}  // namespace clray::ephemeris
