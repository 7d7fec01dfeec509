// SPDX-License-Identifier: Apache-2.0
// Numbers and names as text in result files; see text.hpp. Only std::to_chars is used for numbers: printf and
// streams follow the locale.
#include "text/text.hpp"

#include <charconv>
#include <cmath>

#include "clray/result.hpp"
#include "clray/write.hpp"

namespace clray::text {

namespace {

/// Length in bytes of the valid UTF-8 character that starts at `i`, or 0.
std::size_t utf8_length(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(i);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xc2 && lead < 0xe0   ? 2
                             : lead >= 0xe0 && lead < 0xf0 ? 3
                             : lead >= 0xf0 && lead < 0xf5 ? 4
                                                           : 0;
  if (length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xc0) != 0x80) return 0;
  }
  const unsigned char second = byte(i + 1);
  if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second >= 0xa0)) return 0;
  if ((lead == 0xf0 && second < 0x90) || (lead == 0xf4 && second >= 0x90)) return 0;
  return length;
}

std::string chars(double value, std::chars_format format, int precision) {
  char buffer[400];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, format, precision).ptr;
  return {buffer, end};
}

}  // namespace

std::string number(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

std::string trimmed(std::string_view text, std::string_view of) {
  const std::size_t begin = text.find_first_not_of(of);
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(of) - begin + 1));
}

std::string rounded(double value, int digits) {
  return std::isfinite(value) ? chars(value, std::chars_format::general, digits) : number(value);
}

std::size_t decode_utf8(std::string_view text, std::size_t i, std::uint32_t* character) {
  const std::size_t length = utf8_length(text, i);
  const auto byte = [&](std::size_t k) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[k])); };
  if (length <= 1) {
    *character = byte(i);
    return 1;
  }
  *character = byte(i) & (0xffu >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) *character = *character << 6 | (byte(i + k) & 0x3f);
  return length;
}

bool is_hidden(std::uint32_t c) {
  return c < 0x20 || (c >= 0x7f && c < 0xa0) || (c >= 0x200e && c <= 0x200f) || (c >= 0x2028 && c <= 0x202e) ||
         (c >= 0x2066 && c <= 0x2069) || c == 0x61c || c == 0xfeff;
}

namespace {

template <class Keep, class Escape>
std::string escaped(std::string_view text, const Keep& keep, const Escape& escape) {
  std::string line;
  for (std::size_t i = 0; i < text.size();) {
    std::uint32_t c = 0;
    const std::size_t length = decode_utf8(text, i, &c);
    const bool broken = length == 1 && c >= 0x80;
    if (!broken && (!is_hidden(c) || keep(c))) {
      line.append(text.substr(i, length));
    } else {
      line += escape(c, broken);
    }
    i += length;
  }
  return line;
}

std::string escape_for_eyes(std::uint32_t c, bool) {
  return c < 0x100 ? "\\x" + hex16(c).substr(14) : "\\u" + hex16(c).substr(12);
}

}  // namespace

std::string shown(std::string_view text) {
  return escaped(
      text, [](std::uint32_t) { return false; }, escape_for_eyes);
}

std::string shown_lines(std::string_view text) {
  return escaped(
      text, [](std::uint32_t c) { return c == '\n' || c == '\t'; }, escape_for_eyes);
}

std::string shown_json(std::string_view json) {
  return escaped(
      json, [](std::uint32_t c) { return c == '\n'; },
      [](std::uint32_t c, bool broken) { return "\\u" + (broken ? std::string("fffd") : hex16(c).substr(12)); });
}

std::string ascii(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    const unsigned char c = static_cast<unsigned char>(text[i]);
    plain += length == 1 && c >= 0x20 && c < 0x7f ? text[i] : '?';
    i += length == 0 ? 1 : length;
  }
  return plain;
}

std::string counted(std::uint64_t count, std::string_view one, std::string_view several) {
  std::string text = std::to_string(count) + " ";
  text += count == 1 || several.empty() ? one : several;
  if (count != 1 && several.empty()) text += 's';
  return text;
}

std::string hex16(unsigned long long value) {
  std::string digits(16, '0');
  for (int i = 15; i >= 0; --i, value >>= 4) digits[i] = "0123456789abcdef"[value & 15];
  return digits;
}

}  // namespace clray::text

namespace clray {

std::string format_with_error(double value, double error) {
  using text::rounded;
  if (!std::isfinite(value)) return "n/a";
  if (!std::isfinite(error)) return rounded(value, 6) + " ± n/a";
  if (error == 0.0) return rounded(value, 6) + " ± 0";
  const int error_power = static_cast<int>(std::floor(std::log10(std::fabs(error))));
  const double largest = std::fmax(std::fabs(value), std::fabs(error));
  const int power = static_cast<int>(std::floor(std::log10(largest)));
  const bool plain = power > -4 && power < 7 && error_power < 2;
  if (plain) {
    const int decimals = 1 - error_power > 15 ? 15 : 1 - error_power;
    return text::chars(value, std::chars_format::fixed, decimals) + " ± " +
           text::chars(error, std::chars_format::fixed, decimals);
  }
  const double scale = std::pow(10.0, power);
  int decimals = power - error_power + 1;
  decimals = decimals < 0 ? 0 : decimals > 15 ? 15 : decimals;
  return "(" + text::chars(value / scale, std::chars_format::fixed, decimals) + " ± " +
         text::chars(error / scale, std::chars_format::fixed, decimals) + ")e" + std::to_string(power);
}

}  // namespace clray
