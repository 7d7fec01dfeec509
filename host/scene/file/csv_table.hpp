// SPDX-License-Identifier: Apache-2.0
// Strict CSV tables of numbers whose columns are found by their names, with the unit at the name's end ("range_km"), in
// any order, and brought to the units that the reader wants. `#` begins a comment. Every complaint is an Error(input)
// with file:line.
#pragma once

#include <string>
#include <vector>

#include "clray/scene.hpp"

namespace clray {

/// A column that a table must have.
struct CsvColumn {
  /// What a header may call it, without the unit; the first name is the one that messages use.
  std::vector<std::string> names;
  /// Unit of the values as returned, "" for none. A header may state another of the same kind: time (s, ms, us, ns, ps,
  /// min, h, d), length (m, km, mm, um, nm, angstrom …), speed (m_s, km_s), angle (deg, rad), a share (percent), and
  /// W_m2 per nm, um, angstrom or m.
  std::string unit;
  /// A name that stands without a unit for a value in `unit`; "" for none.
  std::string bare = {};
  /// A time that may also be a date: "time_utc" (ISO 8601) or "mjd".
  bool dated = false;
  /// The table may lack it.
  bool optional = false;

  std::string shown() const { return unit.empty() ? names.front() : names.front() + "_" + unit; }
};

/// Rows of finite numbers in the order and the units of the columns asked for, each with the line that it stood on. A
/// column that the table lacks is NaN.
struct CsvTable {
  std::string file;
  std::vector<std::vector<double>> rows;
  std::vector<int> lines;
  std::vector<Epoch> epochs;  ///< of the rows, where the table has dates; its column then holds NaN
};

/// Whether a table may do without a header, its columns then standing in the order and the units asked for.
enum class CsvHeader { optional, required };

/// Reads `file`. The header is the first line of which no field is a number, or a comment above the first row that
/// names the columns. A header that lacks a column, has one more or names an unknown unit is an error that says what
/// was found and what was expected.
CsvTable read_csv(const std::string& file, const std::vector<CsvColumn>& columns,
                  CsvHeader header = CsvHeader::optional);

}  // namespace clray
