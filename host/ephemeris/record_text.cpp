// SPDX-License-Identifier: Apache-2.0
// Strict reading of record files; see record_text.hpp.
#include "ephemeris/record_text.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "clray/error.hpp"
#include "ephemeris/epoch.hpp"
#include "text/input_file.hpp"

namespace clray::ephemeris {

namespace {

constexpr std::size_t kLongestLine = 4096;

bool is_na(std::string_view text) {
  return text == "na" || text == "NA";
}

}  // namespace

RecordReader::RecordReader(const std::string& path) : path_(path), file_(text::open_input(path)) {}

bool RecordReader::read_line() {
  char buffer[kLongestLine + 2];
  if (!std::fgets(buffer, sizeof buffer, file_.get())) {
    if (std::ferror(file_.get())) throw Error(ErrorCode::input, "cannot be read", path_);
    return false;
  }
  ++number_;
  std::size_t length = std::strlen(buffer);
  const bool ended = length > 0 && buffer[length - 1] == '\n';
  if (!ended && !std::feof(file_.get())) fail("a line too long, or with a NUL in it");
  if (ended) --length;
  if (length > 0 && buffer[length - 1] == '\r') --length;
  line_.assign(buffer, length);
  fields_.clear();
  const std::string_view all(line_);
  for (std::size_t at = 0; at < all.size();) {
    const std::size_t begin = all.find_first_not_of(" \t", at);
    if (begin == std::string_view::npos) break;
    at = std::min(all.find_first_of(" \t", begin), all.size());
    fields_.push_back(all.substr(begin, at - begin));
  }
  return true;
}

bool RecordReader::next() {
  std::size_t blank = 0;
  while (true) {
    if (!read_line()) return false;
    if (!fields_.empty()) break;
    if (blank == 0) blank = number_;
  }
  if (blank != 0 && !blank_lines_) {
    number_ = blank;
    fail("an empty line");
  }
  type_.clear();
  for (const char c : fields_[0]) type_ += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return true;
}

void RecordReader::expect_fields(std::size_t low, std::size_t high) const {
  if (fields_.size() >= low && fields_.size() <= high) return;
  const std::string wanted = low == high                 ? fmt::format("{}", low)
                             : high == std::string::npos ? fmt::format("at least {}", low)
                                                         : fmt::format("{} to {}", low, high);
  fail(fmt::format("record {} has {} fields; expected {}", type_, fields_.size(), wanted));
}

double RecordReader::number(std::size_t i, const char* what) const {
  const std::string_view text = fields_[i];
  // from_chars takes no plus sign, and would take "inf" and "nan".
  const std::size_t sign = text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0;
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data() + sign, text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    fail(fmt::format("field {} ({}) is \"{}\"; expected a number", i + 1, what, text));
  }
  return value;
}

double RecordReader::number_or_na(std::size_t i, const char* what) const {
  return is_na(fields_[i]) ? std::numeric_limits<double>::quiet_NaN() : number(i, what);
}

long RecordReader::integer(std::size_t i, long low, long high, const char* what) const {
  const std::string_view text = fields_[i];
  long value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || value < low || value > high) {
    fail(fmt::format("field {} ({}) is \"{}\"; expected a whole number in [{}..{}]", i + 1, what, text, low, high));
  }
  return value;
}

long RecordReader::integer_or_na(std::size_t i, long low, long high, long na_value, const char* what) const {
  return is_na(fields_[i]) ? na_value : integer(i, low, high, what);
}

std::int64_t RecordReader::picoseconds(std::size_t i, const char* what) const {
  const std::string_view text = fields_[i];
  const auto bad = [&] {
    fail(fmt::format("field {} ({}) is \"{}\"; expected seconds with at most 12 decimals", i + 1, what, text));
  };
  std::int64_t value = 0;
  int decimals = -1, digits = 0;
  for (const char c : text) {
    if (c == '.' && decimals < 0) {
      decimals = 0;
    } else if (c >= '0' && c <= '9' && decimals < 12 && value < std::numeric_limits<std::int64_t>::max() / 20) {
      value = 10 * value + (c - '0');
      ++digits;
      if (decimals >= 0) ++decimals;
    } else {
      bad();
    }
  }
  if (digits == 0) bad();
  for (int k = decimals < 0 ? 0 : decimals; k < 12; ++k) {
    if (value > std::numeric_limits<std::int64_t>::max() / 10) bad();
    value *= 10;
  }
  return value;
}

void RecordReader::fail(const std::string& what) const {
  throw Error(ErrorCode::input, what, fmt::format("{}:{}", path_, number_));
}

}  // namespace clray::ephemeris
