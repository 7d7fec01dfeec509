// SPDX-License-Identifier: Apache-2.0
// The columns of a row of keys.def and its units; see key_member.hpp.
#include "scene/file/key_member.hpp"

#include "clray/error.hpp"
#include "shared/portable.h"

namespace clray {
namespace {

std::vector<std::string> split(const std::string& text, const std::string& by) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(by, at), text.size());
    if (end > at) parts.push_back(text.substr(at, end - at));
    at = end + by.size();
  }
  return parts;
}

/// A unit of keys whose members are in SI, by the ends of their names.
struct KeyUnit {
  const char *name, *member_end;
  double per_si;  ///< 0: degrees
};

constexpr KeyUnit kUnits[] = {
    {"ps", "_s", 1e12}, {"ns", "_s", 1e9}, {"urad", "_rad", 1e6}, {"mrad", "_rad", 1e3}, {"deg", "_rad", 0.0}};

/// The row's unit if the member has another; else null.
const KeyUnit* unit_of(const KeyRow& row) {
  if (row.key.name == row.member) return nullptr;
  const auto unit =
      std::find_if(std::begin(kUnits), std::end(kUnits), [&](const KeyUnit& u) { return row.unit == u.name; });
  return unit == std::end(kUnits) ? nullptr : &*unit;
}

}  // namespace

void malformed(const RowTexts& texts, const std::string& what) {
  throw Error(ErrorCode::bug, "malformed row of keys.def: " + what, fmt::format("{}.{}", texts.section, texts.name));
}

std::vector<std::string> row_words(const std::string& values) {
  static const std::string start = "row of ";
  std::vector<std::string> words = words_of(values);
  if (words.empty() || words.back().rfind(start, 0) != 0) return {};
  const std::vector<std::string>& rows = row_names(words.back().substr(start.size()));
  words.pop_back();
  words.insert(words.end(), rows.begin(), rows.end());
  return words;
}

void set_choices(const std::vector<std::string>& words, KeyRow* row) {
  row->choices = words;
  row->values = fmt::format("\"{}\"", fmt::join(words, "\" or \""));
}

std::string choice_fault(const KeyRow& row, const std::string& word) {
  if (std::find(row.choices.begin(), row.choices.end(), word) != row.choices.end()) return "";
  return fmt::format("expected one of {}", fmt::join(row.choices, ", "));
}

double to_member(const KeyRow& row, double value) {
  const KeyUnit* unit = unit_of(row);
  if (unit == nullptr) return value;
  return unit->per_si > 0.0 ? value / unit->per_si : value / 180.0 * CLRAY_PI;
}

double to_key(const KeyRow& row, double value) {
  const KeyUnit* unit = unit_of(row);
  if (unit == nullptr) return value;
  return unit->per_si > 0.0 ? value * unit->per_si : value / CLRAY_PI * 180.0;
}

KeyRow parse_texts(const RowTexts& texts) {
  KeyRow row;
  row.section = texts.section;
  row.member = texts.member;
  row.unit = texts.unit;
  row.key.name = texts.name;
  row.key.meaning = texts.meaning;
  if (row.key.meaning.empty()) malformed(texts, "needs a meaning");
  const std::vector<std::string> parts = split(texts.values, " = ");
  if (parts.empty()) malformed(texts, "needs values");
  row.values = parts[0];
  if (parts.size() > 1) row.fallback = parts[1];
  if (row.values.rfind("required ", 0) == 0) {
    row.required = true;
    row.fallback = "required";
    row.values.erase(0, 9);
  }
  for (const std::string& word : split(texts.when, " ")) {
    if (word[0] == '!') {
      row.not_beside.push_back(word.substr(1));
    } else {
      row.way = word;
    }
  }
  return row;
}

std::vector<std::string> words_of(const std::string& values) {
  return split(values, "|");
}

void check_unit_rule(const RowTexts& texts, const KeyRow& row) {
  if (row.kind == KeyKind::choice || row.key.name == row.member) return;
  const KeyUnit* unit = unit_of(row);
  const std::string end = unit == nullptr ? "" : unit->member_end;
  const std::string& m = row.member;
  if (unit == nullptr || m.size() < end.size() || m.compare(m.size() - end.size(), end.size(), end) != 0) {
    malformed(texts, "no rule leads from '" + row.key.name + "' to '" + m + "'");
  }
}

std::string vector_text(const Vec3& v) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v.x, v.y, v.z);
}

}  // namespace clray
