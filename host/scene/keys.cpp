// SPDX-License-Identifier: Apache-2.0
// Binds the rows of keys.def to their members and runs over them; see keys.hpp. What a C++ type makes of a row stands
// in set_kind() and the three functions after it. A row that cannot be read is a fault of clray, not of a scene.
#include "scene/keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "clray/error.hpp"
#include "scene/key_forms.hpp"
#include "scene/value_checks.hpp"
#include "shared/portable.h"

namespace clray {
namespace {

/// The texts of a row.
struct RowTexts {
  const char *section, *member, *name, *values, *unit, *when, *meaning;
};

[[noreturn]] void malformed(const RowTexts& texts, const std::string& what) {
  throw Error(ErrorCode::bug, "malformed row of keys.def: " + what, fmt::format("{}.{}", texts.section, texts.name));
}

std::vector<std::string> split(const std::string& text, const std::string& by) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(by, at), text.size());
    if (end > at) parts.push_back(text.substr(at, end - at));
    at = end + by.size();
  }
  return parts;
}

/// How many of a key's units make one of its member's: 1 where they have the same name. Degrees apart.
double units_per_member(const KeyRow& row) {
  if (row.key.name == row.member) return 1.0;
  return row.unit == "mrad" ? 1e3 : row.unit == "urad" ? 1e6 : row.unit == "ns" ? 1e9 : 1e12;
}
double to_member(const KeyRow& row, double value) {
  return row.unit == "deg" ? value / 180.0 * CLRAY_PI : value / units_per_member(row);
}
double to_key(const KeyRow& row, double value) {
  return row.unit == "deg" ? value / CLRAY_PI * 180.0 : value * units_per_member(row);
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

/// What the values of a KEY are, from the words and the member's type; fills the row's range or choices.
template <class T>
void set_kind(const RowTexts& texts, KeyRow* row) {
  if constexpr (std::is_same_v<T, std::string>) {
    row->kind = KeyKind::name;
    if (row->values != "name") malformed(texts, "a text can only be a name");
  } else if constexpr (std::is_same_v<T, Vec3>) {
    row->kind = row->values == "direction" ? KeyKind::direction : KeyKind::vector;
    if (row->values != "direction" && row->values != "vector") malformed(texts, "expected direction or vector");
    row->values = row->kind == KeyKind::direction ? "[x, y, z], not zero" : "[x, y, z]";
  } else if (row->values.find('|') != std::string::npos) {
    if (!std::is_enum_v<T> && !std::is_same_v<T, bool>) malformed(texts, "words need an enum or a bool");
    row->kind = KeyKind::choice;
    row->choices = split(row->values, "|");
    row->values = fmt::format("\"{}\"", fmt::join(row->choices, "\" or \""));
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
  const std::string si = row->unit == "deg" || row->unit == "mrad" || row->unit == "urad" ? "_rad"
                         : row->unit == "ns" || row->unit == "ps"                         ? "_s"
                                                                                          : "";
  const std::string& m = row->member;
  const bool renamed = row->kind != KeyKind::choice && row->key.name != m;
  if (renamed && (si.empty() || m.size() < si.size() || m.compare(m.size() - si.size(), si.size(), si) != 0)) {
    malformed(texts, "no rule leads from '" + row->key.name + "' to '" + m + "'");
  }
}

std::string vector_text(const Vec3& v) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v.x, v.y, v.z);
}

template <class S, class T>
void read_member(TomlTable& t, const KeyRow& row, T S::*member, S* s) {
  const std::string& name = row.key.name;
  if constexpr (std::is_same_v<T, std::string>) {
    s->*member = t.name(name);
  } else if constexpr (std::is_same_v<T, Vec3>) {
    s->*member = row.kind == KeyKind::direction ? t.direction(name) : t.vector(name);
  } else if constexpr (std::is_same_v<T, double>) {
    s->*member = to_member(row, *t.row_key(row.key));
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

/// What is wrong with a member, or "".
template <class S, class T>
std::string member_fault(const KeyRow& row, T S::*member, const S& s) {
  if constexpr (std::is_same_v<T, std::string>) {
    return !(s.*member).empty() && !is_name(s.*member) ? std::string(kNameExpected) + ", found \"" + s.*member + "\""
                                                       : "";
  } else if constexpr (std::is_same_v<T, Vec3>) {
    return row.kind == KeyKind::direction ? unit_fault(s.*member) : vector_fault(s.*member);
  } else if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool>) {
    if (row.kind == KeyKind::truth || static_cast<std::size_t>(s.*member) < row.choices.size()) return "";
    return fmt::format("expected one of {}", fmt::join(row.choices, ", "));
  } else {
    // In the member's unit: rounding is monotonous, so what a file may give passes here, to the ends of the range.
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

template <class S>
std::vector<Key<S>>& storage() {
  static std::vector<Key<S>> rows;
  return rows;
}

std::vector<std::string>& section_storage() {
  static std::vector<std::string> names;
  return names;
}

template <class S>
void store(const RowTexts& texts, Key<S> key) {
  std::vector<std::string>& sections = section_storage();
  if (std::find(sections.begin(), sections.end(), key.section) == sections.end()) sections.push_back(key.section);
  for (const Key<S>& other : storage<S>()) {
    if (other.key.name == key.key.name && other.way == key.way) malformed(texts, "occurs twice");
  }
  storage<S>().push_back(std::move(key));
}

/// KEY: what the row's texts and the member's type say.
template <class S, class T>
void add_key(const RowTexts& texts, T S::*member) {
  Key<S> key;
  static_cast<KeyRow&>(key) = parse_texts(texts);
  set_kind<T>(texts, &key);
  const KeyRow row = key;
  const T start = S{}.*member;
  // What the member starts with may stay, also outside the range: nothing is given.
  const auto unset = [row, member, start](const S& s) { return !row.required && s.*member == start; };
  const bool none = !member_fault(row, member, S{}).empty() || member_text(row, member, S{}).empty();
  key.read = [row, member](TomlTable& t, S* s) { read_member(t, row, member, s); };
  key.check = [row, member, unset](const std::string& where, const S& s) {
    const std::string fault = unset(s) ? "" : member_fault(row, member, s);
    if (!fault.empty()) throw Error(ErrorCode::input, fault, where + "." + row.member);
  };
  key.text = [row, member, unset, none](const S& s) {
    return none && unset(s) ? row.fallback : member_text(row, member, s);
  };
  if (key.fallback.empty()) {
    const bool word = key.kind == KeyKind::name || key.kind == KeyKind::choice;
    key.fallback = none ? "none" : word ? "\"" + key.text(S{}) + "\"" : key.text(S{});
  }
  store(texts, std::move(key));
}

/// FORM.
template <class S>
void add_form(const RowTexts& texts, const KeyForm<S>& form) {
  Key<S> key;
  static_cast<KeyRow&>(key) = parse_texts(texts);
  if (key.fallback.empty()) key.fallback = "none";
  const std::string name = key.key.name;
  key.read = [form, name](TomlTable& t, S* s) { form.read(t, name, s); };
  key.check = [form](const std::string& where, const S& s) {
    if (form.check != nullptr) form.check(where, s);
  };
  key.text = form.text;
  store(texts, std::move(key));
}

/// The sections by their names.
namespace sections {
using source = Source;
using observer = Observer;
using motion = Motion;
using station = Station;
using trace = TraceOptions;
}  // namespace sections

bool bind_all() {
#define KEY(section, member, name, values, unit, when, meaning) \
  add_key(RowTexts{#section, #member, name, values, unit, when, meaning}, &sections::section::member);
#define FORM(section, form, name, values, unit, when, meaning) \
  add_form(RowTexts{#section, #form, name, values, unit, when, meaning}, forms::section##_##form);
#include "scene/keys.def"
#undef FORM
#undef KEY
  return true;
}

void bind_once() {
  static const bool bound = bind_all();
  (void)bound;
}

/// Which of the ways of a section this one is.
template <class S>
std::string way_of(const S&) {
  return "";
}
std::string way_of(const Source& s) {
  return s.kind == Source::Kind::sun ? "sun" : "laser";
}
std::string way_of(const Motion& m) {
  return m.attitudes.empty() ? "spin" : "table";
}

template <class S>
bool applies(const Key<S>& key, const S& s) {
  return key.way.empty() || key.way == way_of(s);
}

std::string expected_text(const KeyRow& row) {
  std::string expected = row.values;
  if (row.kind == KeyKind::vector || row.kind == KeyKind::direction) return "three numbers [x, y, z]";
  if (row.kind == KeyKind::number || row.kind == KeyKind::whole) key_accepts(row.key, 0.0, &expected);
  return expected;
}

template <class S>
std::vector<KeyRow> rows_of() {
  return {keys<S>().begin(), keys<S>().end()};
}

}  // namespace

template <class S>
const std::vector<Key<S>>& keys() {
  bind_once();
  return storage<S>();
}

const std::vector<std::string>& key_sections() {
  bind_once();
  return section_storage();
}

std::vector<KeyRow> key_rows(const std::string& section) {
  std::vector<KeyRow> found;
  for (const std::vector<KeyRow>& rows :
       {rows_of<Source>(), rows_of<Observer>(), rows_of<Motion>(), rows_of<Station>(), rows_of<TraceOptions>()}) {
    if (rows.front().section == section) found = rows;
  }
  return found;
}

template <class S>
void read_keys(TomlTable& t, S* s) {
  // A misspelt key is the likelier fault than a missing one: those first.
  for (const Key<S>& key : keys<S>()) t.know({key.key.name});
  t.finish();
  for (const Key<S>& key : keys<S>()) {
    const std::string& name = key.key.name;
    if (!applies(key, *s)) {
      const bool other = std::any_of(keys<S>().begin(), keys<S>().end(),
                                     [&](const Key<S>& k) { return k.key.name == name && applies(k, *s); });
      if (t.has(name) && !other) t.fail(name, fmt::format("belongs to a {}; this is a {}", key.way, way_of(*s)));
      continue;
    }
    if (!t.has(name)) {
      if (key.required) t.missing(name, expected_text(key));
      continue;
    }
    for (const std::string& other : key.not_beside) {
      if (t.has(other)) t.fail(name, "given beside " + other + "; expected only one of them");
    }
    key.read(t, s);
  }
}

template <class S>
void check_keys(const std::string& where, const S& s) {
  for (const Key<S>& key : keys<S>()) {
    if (applies(key, s)) key.check(where, s);
  }
}

template <class S>
std::vector<KeyValue> key_values(const S& s) {
  const auto given = [&](const Key<S>& key) { return applies(key, s) && key.text(s) != key.text(S{}); };
  const auto excludes = [](const KeyRow& a, const KeyRow& b) {
    return std::find(a.not_beside.begin(), a.not_beside.end(), b.key.name) != a.not_beside.end();
  };
  std::vector<KeyValue> values;
  for (const Key<S>& key : keys<S>()) {
    if (!applies(key, s)) continue;
    const bool excluded = !given(key) && std::any_of(keys<S>().begin(), keys<S>().end(), [&](const Key<S>& other) {
      return (excludes(key, other) || excludes(other, key)) && given(other);
    });
    if (!excluded) values.push_back({&key, key.text(s)});
  }
  return values;
}

template <class S>
std::string key_text(const S& s) {
  std::string text;
  for (const KeyValue& each : key_values(s)) {
    if (!each.value.empty()) text += (text.empty() ? "" : ", ") + each.row->key.name + " " + each.value;
  }
  return text;
}

#define CLRAY_SECTION(S)                                  \
  template const std::vector<Key<S>>& keys();             \
  template void read_keys(TomlTable&, S*);                \
  template void check_keys(const std::string&, const S&); \
  template std::vector<KeyValue> key_values(const S&);    \
  template std::string key_text(const S&);
CLRAY_SECTION(Source)
CLRAY_SECTION(Observer)
CLRAY_SECTION(Motion)
CLRAY_SECTION(Station)
CLRAY_SECTION(TraceOptions)
#undef CLRAY_SECTION

}  // namespace clray
