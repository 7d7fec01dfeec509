// SPDX-License-Identifier: Apache-2.0
// Names of files; see file_names.hpp. Case is folded for the alphabets that have it in regular blocks (Latin, Greek,
// Cyrillic, Armenian); a fold that joins too much costs a "-2" and nothing else.
#include "text/file_names.hpp"

#include <algorithm>
#include <cstdint>

#include "text/text.hpp"

namespace clray::text {

namespace {

constexpr std::size_t kLongestPart = 48;

std::uint32_t folded(std::uint32_t c) {
  if ((c >= 'A' && c <= 'Z') || (c >= 0xc0 && c <= 0xde)) return c + 0x20;             // ASCII, Latin-1
  if ((c >= 0x139 && c <= 0x148) || (c >= 0x179 && c <= 0x17e)) return (c + 1) & ~1u;  // extended Latin: pairs
  if (c >= 0x100 && c <= 0x24f) return c & ~1u;
  if (c >= 0x391 && c <= 0x3ab) return c + 0x20;  // Greek
  if (c >= 0x410 && c <= 0x42f) return c + 0x20;  // Cyrillic
  if (c >= 0x400 && c <= 0x40f) return c + 0x50;
  if (c >= 0x460 && c <= 0x52f) return c & ~1u;
  if (c >= 0x531 && c <= 0x556) return c + 0x30;   // Armenian
  if (c >= 0x1e00 && c <= 0x1eff) return c & ~1u;  // Latin with several marks
  return c;
}

/// Hidden characters and bytes that are not UTF-8 become blanks, which no name keeps.
std::string cleaned(std::string_view text) {
  std::string clean;
  for (std::size_t i = 0; i < text.size();) {
    std::uint32_t c = 0;
    const std::size_t length = decode_utf8(text, i, &c);
    if (is_hidden(c) || (length == 1 && c >= 0x80)) {
      clean += ' ';
    } else {
      clean.append(text.substr(i, length));
    }
    i += length;
  }
  return clean;
}

/// A key that is equal for names that differ in case alone.
std::string without_case(std::string_view text) {
  const std::string clean = cleaned(text);
  std::string key;
  for (std::size_t i = 0; i < clean.size();) {
    std::uint32_t c = 0;
    const std::size_t length = decode_utf8(clean, i, &c);
    key += std::to_string(folded(c)) + ' ';
    i += length;
  }
  return key;
}

}  // namespace

std::string file_name_part(std::string_view text) {
  const std::string clean = cleaned(text);
  std::string part;
  for (std::size_t i = 0; i < clean.size();) {
    std::uint32_t c = 0;
    const std::size_t length = decode_utf8(clean, i, &c);
    if (part.size() + length > kLongestPart) break;
    const bool keep = length > 1 || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                      c == '_' || c == '-' || (c == '.' && !part.empty());
    if (keep) {
      part.append(clean, i, length);
    } else {
      part += '_';
    }
    i += length;
  }
  return part.empty() ? "unnamed" : part;
}

void FileNames::reserve(std::string_view stem) {
  taken_stems_.insert(without_case(stem));
}

void FileNames::release(std::string_view name) {
  taken_files_.erase(without_case(name));
}

std::string FileNames::stem(const std::vector<std::string>& parts, const std::string& kind) {
  std::string& stem = stems_[{kind, parts}];
  if (!stem.empty()) return stem;
  std::string wanted;
  for (const std::string& part : parts) wanted += (wanted.empty() ? "" : "-") + file_name_part(part);
  stem = wanted;
  for (int i = 2; !taken_stems_.insert(without_case(stem)).second; ++i) stem = wanted + "-" + std::to_string(i);
  return stem;
}

std::string FileNames::file(const std::string& stem, const std::string& extension) {
  std::string name = stem + "." + extension;
  for (int i = 2; !taken_files_.insert(without_case(name)).second; ++i) {
    name = stem + "-" + std::to_string(i) + "." + extension;
  }
  return name;
}

}  // namespace clray::text
