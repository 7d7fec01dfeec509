// SPDX-License-Identifier: Apache-2.0
// A text file written in large pieces, with numbers of fixed decimals from integers: a million rows in a fraction of
// a second, the same digits everywhere.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "text/output_file.hpp"

namespace clray::slr {

class TextFile {
 public:
  /// Throws Error(output) where the file cannot be made.
  explicit TextFile(const std::string& path);

  TextFile& text(std::string_view text);
  /// `value`·10^-decimals, decimals 1 … 18.
  TextFile& decimal(std::int64_t value, int decimals);
  /// `s` seconds and `ps` picoseconds of [0, 1e12), as seconds with 12 decimals.
  TextFile& seconds(std::int64_t s, std::int64_t ps);
  TextFile& end_line();

  /// Throws Error(output) where anything could not be written.
  void close();

 private:
  void flush();

  text::OutputFile file_;
  std::string buffer_;
};

}  // namespace clray::slr
