// SPDX-License-Identifier: Apache-2.0
// Numbers and words as text in result files: shortest digits that read back to the same double, whatever the locale,
// and texts of users made fit for one line, for FITS headers, for UTF-8.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace clray::text {

/// Shortest text that reads back to the same double; "nan", "inf" and "-inf" for what is not finite.
std::string number(double value);

/// `digits` significant digits, for titles and labels.
std::string rounded(double value, int digits);

/// A text without those of the characters `of` that it begins and ends with.
std::string trimmed(std::string_view text, std::string_view of);

/// Whether a character does something in a terminal or to the order of letters instead of being seen: controls (C0,
/// DEL, C1), marks of the direction of writing, separators of lines and paragraphs.
bool is_hidden(std::uint32_t character);

/// Text of users and files as it is shown: in a terminal, a head of a file, a title. One line: hidden characters are
/// written as \x1b or \u202e, bytes that are not UTF-8 as \xff. Escaping twice changes nothing more.
std::string shown(std::string_view text);

/// The same for texts of several lines: line ends and tabs are kept.
std::string shown_lines(std::string_view text);

/// A JSON text whose strings hold hidden characters as \u009b.
std::string shown_json(std::string_view json);

/// The UTF-8 character that starts at byte `i`, and its length in bytes; a byte that starts none stands for itself.
std::size_t decode_utf8(std::string_view text, std::size_t i, std::uint32_t* character);

/// Only printable ASCII, as FITS headers demand; the rest becomes '?'.
std::string ascii(std::string_view text);

/// "1 pair", "2 pairs", "0 pairs"; with `several`, "1 byte follows", "3 bytes follow".
std::string counted(std::uint64_t count, std::string_view one, std::string_view several = {});

/// 16 hexadecimal digits.
std::string hex16(unsigned long long value);

}  // namespace clray::text
