// SPDX-License-Identifier: Apache-2.0
// Words, numbers and lines of text mesh files; see mesh_text.hpp.
#include "scene/mesh/mesh_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "scene/mesh/mesh_soup.hpp"
#include "text/text.hpp"

namespace clray {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// from_chars says "out of range" for both 1e400 and 1e-400; the second counts as zero.
bool underflows(std::string_view word) {
  std::int64_t exponent = 0, leading = 0;
  bool point = false, significant = false;
  std::size_t i = 0;
  for (; i < word.size() && word[i] != 'e' && word[i] != 'E'; ++i) {
    if (word[i] == '.') {
      point = true;
    } else if (is_digit(word[i])) {
      significant = significant || word[i] != '0';
      if (significant && !point) ++leading;
      if (!significant && point) --leading;
    }
  }
  if (i + 1 < word.size()) {
    const char* p = word.data() + i + 1;
    const char* end = word.data() + word.size();
    if (*p == '+') ++p;
    if (std::from_chars(p, end, exponent).ec == std::errc::result_out_of_range) return *p == '-';
  }
  return exponent + leading < 0;
}

}  // namespace

std::string quote_word(std::string_view word) {
  std::size_t end = 0;
  for (std::uint32_t c = 0; end < word.size() && end < 40;) end += text::decode_utf8(word, end, &c);
  return "'" + text::shown(word.substr(0, end)) + (end < word.size() ? "…'" : "'");
}

std::string without_comment(std::string_view name, bool glued) {
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] != '#' || (i > 0 && !is_blank(name[i - 1]))) continue;
    if (!glued && i + 1 < name.size() && !is_blank(name[i + 1])) continue;
    while (i > 0 && is_blank(name[i - 1])) --i;
    return std::string(name.substr(0, i));
  }
  return std::string(name);
}

std::string parse_number(std::string_view word, double& value) {
  const char* p = word.data();
  const char* end = p + word.size();
  if (word.size() > 1 && *p == '+' && p[1] != '-') ++p;
  const auto [stop, error] = std::from_chars(p, end, value);
  if (error == std::errc::result_out_of_range && stop == end) {
    if (!underflows(word)) return quote_word(word) + " is too large for a double";
    value = 0.0;
    return {};
  }
  if (error != std::errc() || stop != end) return quote_word(word) + " is no number";
  if (!std::isfinite(value)) return quote_word(word) + " is not finite";
  return {};
}

TextCursor::TextCursor(std::string_view text, const std::string& path)
    : begin_(text.data()), p_(text.data()), end_(text.data() + text.size()), path_(&path) {
  if (text.substr(0, 3) == "\xef\xbb\xbf") p_ += 3;
}

std::size_t TextCursor::line_end_length(const char* p) const {
  if (p == end_) return 0;
  if (*p == '\n') return 1;
  if (*p == '\r') return p + 1 != end_ && p[1] == '\n' ? 2 : 1;
  return 0;
}

bool TextCursor::at_continuation() const {
  return p_ != end_ && *p_ == '\\' && line_end_length(p_ + 1) > 0;
}

bool TextCursor::more_on_line() {
  while (p_ != end_) {
    if (is_blank(*p_)) {
      ++p_;
    } else if (at_continuation()) {
      p_ += 1 + line_end_length(p_ + 1);
      ++line_;
    } else {
      return *p_ != '\n' && *p_ != '\r' && *p_ != '#';
    }
  }
  return false;
}

void TextCursor::next_line() {
  while (p_ != end_ && *p_ != '\n' && *p_ != '\r') ++p_;
  if (p_ == end_) return;
  p_ += line_end_length(p_);
  ++line_;
}

bool TextCursor::next_filled_line() {
  while (!more_on_line()) {
    if (at_end()) return false;
    next_line();
  }
  return true;
}

std::string_view TextCursor::word() {
  if (!more_on_line()) return {};
  const char* start = p_;
  while (p_ != end_ && !is_blank(*p_) && *p_ != '\n' && *p_ != '\r' && *p_ != '#' && !at_continuation()) ++p_;
  return {start, static_cast<std::size_t>(p_ - start)};
}

std::string_view TextCursor::rest() {
  while (p_ != end_ && is_blank(*p_)) ++p_;
  const char* start = p_;
  bool comment = false;  // in which a backslash continues nothing
  for (; p_ != end_ && *p_ != '\n' && *p_ != '\r' && (comment || !at_continuation()); ++p_)
    comment = comment || (*p_ == '#' && (p_ == start || is_blank(p_[-1])) && (p_ + 1 == end_ || is_blank(p_[1])));
  const char* stop = p_;
  while (stop != start && is_blank(stop[-1])) --stop;
  return {start, static_cast<std::size_t>(stop - start)};
}

double TextCursor::number(const char* what) {
  const std::string_view text = word();
  if (text.empty()) fail(std::string("the line ends where ") + what + " was expected");
  double value = 0.0;
  const std::string trouble = parse_number(text, value);
  if (!trouble.empty()) fail(trouble + "; " + what + " (a finite number) was expected");
  return value;
}

std::int64_t TextCursor::integer(const char* what, std::int64_t low, std::int64_t high) {
  const std::string_view text = word();
  if (text.empty()) fail(std::string("the line ends where ") + what + " was expected");
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || value < low || value > high) {
    fail(quote_word(text) + "; " + what + " (an integer from " + std::to_string(low) + " to " + std::to_string(high) +
         ") was expected");
  }
  return value;
}

void TextCursor::fail(const std::string& message) const {
  fail_input(*path_, line_, message);
}

}  // namespace clray
