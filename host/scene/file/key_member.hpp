// SPDX-License-Identifier: Apache-2.0
// What follows for a key from its row in keys.def and from the C++ type of its member: the kind of its values, and how
// the member is read, worded and checked. Only keys.cpp includes it, to bind the rows.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "scene/file/keys.hpp"
#include "scene/file/value_checks.hpp"
#include "scene/tables.hpp"

namespace clray {

/// The texts of a row.
struct RowTexts {
  const char *section, *member, *name, *values, *unit, *when, *meaning;
};

/// Throws Error(bug): a row that cannot be read is a fault of clray, not of a scene.
[[noreturn]] void malformed(const RowTexts& texts, const std::string& what);

/// Columns of a row, before the member's type is known.
KeyRow parse_texts(const RowTexts& texts);

/// Words of a row's values: "a|b".
std::vector<std::string> words_of(const std::string& values);

/// The words of "auto|row of walk": those before the table, then the names of its rows. None if there is no table.
std::vector<std::string> row_words(const std::string& values);

void set_choices(const std::vector<std::string>& words, KeyRow* row);

/// What is wrong with a word, or "".
std::string choice_fault(const KeyRow& row, const std::string& word);

/// Complains if the member has another name than the key and no rule converts the key's unit to the member's.
void check_unit_rule(const RowTexts& texts, const KeyRow& row);

/// From the unit of a key to that of a member with a name of its own, and back.
double to_member(const KeyRow& row, double value);
double to_key(const KeyRow& row, double value);

/// "[x, y, z]".
std::string vector_text(const Vec3& v);

/// What the values of a KEY are, from the words and the member's type; fills the row's range or choices.
template <class T>
void set_kind(const RowTexts& texts, KeyRow* row) {
  if constexpr (std::is_same_v<T, std::string>) {
    const std::vector<std::string> words = row_words(row->values);
    row->kind = words.empty() ? KeyKind::name : KeyKind::choice;
    if (words.empty() && row->values != "name") malformed(texts, "a text is a name, or the row of a table");
    if (!words.empty()) set_choices(words, row);
  } else if constexpr (std::is_same_v<T, Vec3>) {
    row->kind = row->values == "direction" ? KeyKind::direction : KeyKind::vector;
    if (row->values != "direction" && row->values != "vector") malformed(texts, "expected direction or vector");
    row->values = row->kind == KeyKind::direction ? "[x, y, z], not zero" : "[x, y, z]";
  } else if (row->values.find('|') != std::string::npos) {
    if (!std::is_enum_v<T> && !std::is_same_v<T, bool>) malformed(texts, "words need an enum or a bool");
    row->kind = KeyKind::choice;
    set_choices(words_of(row->values), row);
  } else {
    row->key.range = row->values;
    parse_range(texts.name, &row->key);
    row->kind = row->key.is_switch ? KeyKind::truth : row->key.is_whole ? KeyKind::whole : KeyKind::number;
    const bool fits = row->kind == KeyKind::truth   ? std::is_same_v<T, bool>
                      : row->kind == KeyKind::whole ? std::is_integral_v<T> && !std::is_same_v<T, bool>
                                                    : std::is_same_v<T, double>;
    if (!fits) malformed(texts, "range '" + row->values + "' does not fit the member's type");
    row->values = range_words(row->key);
  }
  check_unit_rule(texts, *row);
}

/// Reads the key, which must be there, into its member.
template <class S, class T>
void read_member(TomlTable& t, const KeyRow& row, T S::*member, S* s) {
  const std::string& name = row.key.name;
  if constexpr (std::is_same_v<T, std::string>) {
    s->*member = row.kind == KeyKind::choice ? t.choice(name, row.choices) : t.name(name);
  } else if constexpr (std::is_same_v<T, Vec3>) {
    s->*member = row.kind == KeyKind::direction ? t.direction(name) : t.vector(name);
  } else if constexpr (std::is_same_v<T, double>) {
    double value = *t.row_key(row.key);
    // Whole turns of an unbounded angle are taken off while that is exact.
    if (row.unit == "deg" && std::isinf(row.key.high)) value = std::fmod(value, 360.0);
    s->*member = to_member(row, value);
  } else {
    if (row.kind == KeyKind::choice) {
      const std::string word = t.choice(name, row.choices);
      s->*member = static_cast<T>(std::find(row.choices.begin(), row.choices.end(), word) - row.choices.begin());
    } else if (row.kind == KeyKind::truth) {
      s->*member = static_cast<T>(t.boolean(name, false));
    } else {
      s->*member = static_cast<T>(t.row_whole(row.key));
    }
  }
}

/// The member as a scene file would give it.
template <class S, class T>
std::string member_text(const KeyRow& row, T S::*member, const S& s) {
  if constexpr (std::is_same_v<T, std::string>) {
    return s.*member;
  } else if constexpr (std::is_same_v<T, Vec3>) {
    return vector_text(s.*member);
  } else if constexpr (std::is_same_v<T, double>) {
    return fmt::format("{:.12g}", to_key(row, s.*member));
  } else if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool>) {
    if (row.kind == KeyKind::truth) return static_cast<int>(s.*member) != 0 ? "true" : "false";
    const auto index = static_cast<std::size_t>(s.*member);
    return index < row.choices.size() ? row.choices[index] : "?";
  } else {
    return fmt::format("{}", s.*member);
  }
}

/// The member in the key's unit; NaN where it is no number.
template <class S, class T>
double member_number(const KeyRow& row, T S::*member, const S& s) {
  if constexpr (std::is_same_v<T, double>) return to_key(row, s.*member);
  if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) return static_cast<double>(s.*member);
  return std::nan("");
}

/// What is wrong with a member, or "".
template <class S, class T>
std::string member_fault(const KeyRow& row, T S::*member, const S& s) {
  if constexpr (std::is_same_v<T, std::string>) {
    if (row.kind == KeyKind::choice) return choice_fault(row, s.*member);
    return !(s.*member).empty() && !is_name(s.*member) ? std::string(kNameExpected) + ", found \"" + s.*member + "\""
                                                       : "";
  } else if constexpr (std::is_same_v<T, Vec3>) {
    return row.kind == KeyKind::direction ? unit_fault(s.*member) : vector_fault(s.*member);
  } else if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool>) {
    if (row.kind == KeyKind::truth || static_cast<std::size_t>(s.*member) < row.choices.size()) return "";
    return choice_fault(row, "");
  } else {
    // Compared in the member's unit. Rounding keeps order, so every value that a file may give passes here.
    TableKey key = row.key;
    key.low = to_member(row, key.low);
    key.high = to_member(row, key.high);
    std::string expected;
    const auto value = static_cast<double>(s.*member);
    if (key_accepts(key, value, &expected)) return "";
    const std::string unit = row.key.name == row.member ? "" : " " + row.unit;
    return fmt::format("expected {}{}, found {}{}", expected, unit, to_key(row, value), unit);
  }
}

}  // namespace clray
