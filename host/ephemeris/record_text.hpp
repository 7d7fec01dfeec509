// SPDX-License-Identifier: Apache-2.0
// Reading the ILRS's record files strictly: lines of fields separated by blanks, every complaint with file and line.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "text/input_file.hpp"

namespace clray::ephemeris {

/// One line at a time, split into fields.
class RecordReader {
 public:
  /// Throws Error(input) where the file cannot be opened.
  explicit RecordReader(const std::string& path);

  /// The next line that is not blank; false at the end of the file. A NUL or a line over 4096 bytes is an error, and so
  /// is a blank line before the last record, unless they are allowed.
  bool next();
  void allow_blank_lines() { blank_lines_ = true; }

  const std::string& line() const { return line_; }
  std::size_t line_number() const { return number_; }
  std::size_t count() const { return fields_.size(); }
  std::string_view field(std::size_t i) const { return fields_[i]; }

  /// The record's type in capitals: the first field.
  const std::string& type() const { return type_; }

  /// Fails unless the record has between `low` and `high` fields, its type included; npos: without limit.
  void expect_fields(std::size_t low, std::size_t high) const;

  long integer(std::size_t i, long low, long high, const char* what) const;
  double number(std::size_t i, const char* what) const;
  /// NaN for "na".
  double number_or_na(std::size_t i, const char* what) const;
  /// `na_value` for "na".
  long integer_or_na(std::size_t i, long low, long high, long na_value, const char* what) const;
  /// A decimal number of seconds with at most 12 decimals, in ps, exactly.
  std::int64_t picoseconds(std::size_t i, const char* what) const;

  /// Throws Error(input) about this line.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  /// One line, split, be it blank.
  bool read_line();

  std::string path_, line_, type_;
  text::InputFile file_;
  std::size_t number_ = 0;
  bool blank_lines_ = false;
  std::vector<std::string_view> fields_;
};

}  // namespace clray::ephemeris
