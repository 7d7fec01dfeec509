// SPDX-License-Identifier: Apache-2.0
// Buffered text; see text_file.hpp.
#include "slr/text_file.hpp"

namespace clray::slr {

namespace {

constexpr std::size_t kPiece = 1u << 18;

}  // namespace

TextFile::TextFile(const std::string& path) : file_(path) {
  buffer_.reserve(kPiece + 512);
}

TextFile& TextFile::text(std::string_view text) {
  buffer_.append(text);
  return *this;
}

TextFile& TextFile::decimal(std::int64_t value, int decimals) {
  char digits[24];
  int at = sizeof digits;
  std::uint64_t left = value < 0 ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
  for (int k = 0; left > 0 || k <= decimals; ++k) {
    if (k == decimals) digits[--at] = '.';
    digits[--at] = static_cast<char>('0' + left % 10);
    left /= 10;
  }
  if (value < 0) digits[--at] = '-';
  buffer_.append(digits + at, sizeof digits - static_cast<std::size_t>(at));
  return *this;
}

TextFile& TextFile::seconds(std::int64_t s, std::int64_t ps) {
  constexpr std::int64_t kSecond_ps = 1000000000000;
  if (s < 0) buffer_ += '-';
  if (s < 0 && ps > 0) {
    ++s;
    ps = kSecond_ps - ps;
  }
  buffer_ += std::to_string(s < 0 ? -s : s);
  char digits[13];
  for (int k = 12; k > 0; --k, ps /= 10) digits[k] = static_cast<char>('0' + ps % 10);
  digits[0] = '.';
  buffer_.append(digits, sizeof digits);
  return *this;
}

TextFile& TextFile::end_line() {
  buffer_ += '\n';
  if (buffer_.size() >= kPiece) flush();
  return *this;
}

void TextFile::flush() {
  file_.put(buffer_);
  buffer_.clear();
}

void TextFile::close() {
  flush();
  file_.close();
}

}  // namespace clray::slr
