// SPDX-License-Identifier: Apache-2.0
// Walks over the words and numbers of a text mesh file (OBJ, MTL, OFF, ASCII PLY and STL) and knows the line
// it is on. Numbers are read in double with std::from_chars, so no locale matters. Line ends: LF, CRLF or CR;
// a backslash before a line end continues the line; '#' starts a comment.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace clray {

/// A cursor over text that outlives it.
class TextCursor {
 public:
  TextCursor(std::string_view text, const std::string& path);

  bool at_end() const { return p_ == end_; }
  std::uint64_t line() const { return line_; }
  /// Bytes from the start of the text to the cursor.
  std::size_t offset() const { return static_cast<std::size_t>(p_ - begin_); }

  /// Skips blanks and continued line ends; true if a word follows on this line.
  bool more_on_line();
  /// Skips the rest of the line, comment included, and its end.
  void next_line();
  /// Skips empty and comment lines; false at the end of the text.
  bool next_filled_line();
  /// The word under the cursor (empty at the end of the line).
  std::string_view word();
  /// Puts the last `n` characters of the word just read back.
  void back(std::size_t n) { p_ -= n; }
  /// The rest of the line without trailing blanks, spaces and '#' kept.
  std::string_view rest();

  /// The next word as a finite number; `what` names it in the error.
  double number(const char* what);
  /// The next word as an integer in [low, high].
  std::int64_t integer(const char* what, std::int64_t low, std::int64_t high);

  [[noreturn]] void fail(const std::string& message) const;

 private:
  bool at_continuation() const;
  std::size_t line_end_length(const char* p) const;

  const char* begin_;
  const char* p_;
  const char* end_;
  std::uint64_t line_ = 1;
  const std::string* path_;
};

/// `word` in quotes, shortened and with unprintable bytes escaped, for messages.
std::string quote_word(std::string_view word);

/// A name that takes the rest of its line, without the comment behind it: what follows a '#' that comes after a blank
/// (or first) and, unless `glued`, before a blank (or last). "Material #25" is a name, "foil # bright" one with a
/// comment.
std::string without_comment(std::string_view name, bool glued = false);

/// `word` as a double. Returns an empty string, or what is wrong with it.
std::string parse_number(std::string_view word, double& value);

}  // namespace clray
