// SPDX-License-Identifier: Apache-2.0
// Values as people type them: counts, durations, percentages, directions, units; see arguments.hpp. Independent of the
// locale: a decimal point is a point.
#include <charconv>
#include <cmath>

#include "arguments.hpp"
#include "clray/error.hpp"
#include "clray/keys.hpp"

namespace clray::cli {

namespace {

[[noreturn]] void reject(const std::string& option, const std::string& text, const std::string& expected) {
  throw Error(ErrorCode::usage, "'" + text + "' is not understood; expected " + expected, option);
}

/// Number at the start of `text` and what follows it.
bool leading_number(const std::string& text, double& value, std::string& rest) {
  const char* begin = text.data();
  const char* const end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;
  const auto [after, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || !std::isfinite(value)) return false;
  rest.assign(after, end);
  return true;
}

double number(const std::string& text, const std::string& option, const std::string& expected) {
  double value = 0.0;
  std::string rest;
  if (!leading_number(text, value, rest) || !rest.empty()) reject(option, text, expected);
  return value;
}

}  // namespace

std::uint64_t parse_count(const std::string& text, const std::string& option) {
  const std::string expected = "a whole number such as 65536, 1e6, 2^22 or 4M";
  std::uint64_t whole = 0;
  const auto [after, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (error == std::errc{} && after == text.data() + text.size()) return whole;
  double value = 0.0;
  std::string rest;
  if (!leading_number(text, value, rest)) reject(option, text, expected);
  if (!rest.empty() && rest[0] == '^') {
    const double power = number(rest.substr(1), option, expected);
    value = std::pow(value, power);
    rest.clear();
  }
  if (rest == "k" || rest == "K")
    value *= 1e3;
  else if (rest == "M")
    value *= 1e6;
  else if (rest == "G")
    value *= 1e9;
  else if (!rest.empty())
    reject(option, text, expected);
  if (!(value >= 0.0) || value != std::floor(value)) reject(option, text, expected);
  if (value > 9.0e18) reject(option, text, expected + ", at most 9e18");
  return static_cast<std::uint64_t>(value);
}

std::uint64_t parse_bytes(const std::string& text, const std::string& option) {
  const bool letter = !text.empty() && text.back() == 'B';
  const std::uint64_t bytes = parse_count(letter ? text.substr(0, text.size() - 1) : text, option);
  if (bytes == 0) reject(option, text, "a size such as 800M or 4G, above zero");
  return bytes;
}

double parse_duration(const std::string& text, const std::string& option) {
  const std::string expected = "a time such as 30, 30s, 500ms, 5m or 2h";
  double value = 0.0;
  std::string unit;
  if (!leading_number(text, value, unit)) reject(option, text, expected);
  if (unit == "ms")
    value *= 1e-3;
  else if (unit == "m" || unit == "min")
    value *= 60.0;
  else if (unit == "h")
    value *= 3600.0;
  else if (!unit.empty() && unit != "s")
    reject(option, text, expected);
  return value;
}

Share parse_share(const std::string& text, const std::string& option) {
  const std::string expected = "a share i/n such as 3/8, with i of 1 to n and n of at most 1000000";
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) reject(option, text, expected);
  const std::uint64_t number = parse_count(text.substr(0, slash), option),
                      of = parse_count(text.substr(slash + 1), option);
  if (number < 1 || number > of || of > 1000000) reject(option, text, expected);
  return {static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(of)};
}

double parse_percent(const std::string& text, const std::string& option) {
  const std::string expected = "a percentage such as 1 or 0.1%";
  const bool sign = !text.empty() && text.back() == '%';
  return number(sign ? text.substr(0, text.size() - 1) : text, option, expected);
}

Vec3 parse_direction(const std::string& text, const std::string& option) {
  const std::string expected = "three numbers X,Y,Z of the body frame, not all zero, such as 0,0,1";
  Vec3 v{0.0};
  std::size_t begin = 0;
  for (int i = 0; i < 3; ++i) {
    const std::size_t comma = text.find(',', begin);
    if ((comma == std::string::npos) != (i == 2)) reject(option, text, expected);
    v[i] = number(text.substr(begin, comma - begin), option, expected);
    begin = comma + 1;
  }
  // Scaled first, so that neither tiny nor huge components overflow when squared.
  const double largest = std::fmax(std::fmax(std::fabs(v.x), std::fabs(v.y)), std::fabs(v.z));
  if (!(largest > 0.0)) reject(option, text, expected);
  v /= largest;
  const double length = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return v / length;
}

double parse_length_unit(const std::string& text, const std::string& option) {
  std::string expected;
  for (const auto& [name, metres] : length_units()) {
    if (text == name) return metres;
    expected += name + ", ";
  }
  expected += "or a number of metres";
  const double value = number(text, option, expected);
  if (!(value > 0.0)) reject(option, text, expected);
  return value;
}

}  // namespace clray::cli
