// SPDX-License-Identifier: Apache-2.0
// Numbers and names as text in result files: shortest digits that read back to the same double, whatever the
// locale, and file names made of what users call their things.
#pragma once

#include <string>
#include <string_view>

namespace clray::text {

/// Shortest text that reads back to the same double; "nan", "inf" and "-inf" for what is not finite.
std::string number(double value);

/// `digits` significant digits, for titles and labels.
std::string rounded(double value, int digits);

/// Control characters become spaces, bytes that are not UTF-8 become '?'.
std::string one_line(std::string_view text);

/// Part of a file name: letters, digits, '.', '_', '-' and UTF-8 are kept, the rest becomes '_'; at most 80 bytes,
/// never empty, no leading dot.
std::string file_name_part(std::string_view text);

/// Only printable ASCII, as FITS headers demand; the rest becomes '?'.
std::string ascii(std::string_view text);

/// 16 hexadecimal digits.
std::string hex16(unsigned long long value);

}  // namespace clray::text
