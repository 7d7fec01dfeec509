// SPDX-License-Identifier: Apache-2.0
// Text cells in aligned columns, for a person. Text is UTF-8; a column's width is counted in characters.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace clray::text {

/// Characters of UTF-8 text.
std::size_t characters(const std::string& text);

/// Lines of cells, every column as wide as its widest cell, two spaces between.
class Columns {
 public:
  /// Cells are escaped as shown() does.
  void add(std::vector<std::string> cells);
  /// The lines, each after `indent`, without spaces at their ends.
  std::string text(const std::string& indent) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace clray::text
