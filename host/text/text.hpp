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

/// Control characters become spaces, bytes that are not UTF-8 become '?'.
std::string one_line(std::string_view text);

/// The UTF-8 character that starts at byte `i`, and its length in bytes; a byte that starts none stands for itself.
std::size_t decode_utf8(std::string_view text, std::size_t i, std::uint32_t* character);

/// Only printable ASCII, as FITS headers demand; the rest becomes '?'.
std::string ascii(std::string_view text);

/// "1 pair", "2 pairs", "0 pairs"; with `several`, "1 byte follows", "3 bytes follow".
std::string counted(std::uint64_t count, std::string_view one, std::string_view several = {});

/// 16 hexadecimal digits.
std::string hex16(unsigned long long value);

}  // namespace clray::text
