// SPDX-License-Identifier: Apache-2.0
// Binds the rows of keys.def to their members and runs over them; see keys.hpp. What a member's type makes of a row
// stands in key_member.hpp.
#include "scene/file/keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "scene/file/key_forms.hpp"
#include "scene/file/key_member.hpp"

namespace clray {
namespace {

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

/// The name of a section in scene files.
std::string section_name(const char* section) {
  return std::string(section) == "attitude" ? "pass.attitude" : section;
}

/// A KEY, from the row's texts and the member's type.
template <class S, class T>
void add_key(const RowTexts& texts, T S::*member) {
  Key<S> key;
  static_cast<KeyRow&>(key) = parse_texts(texts);
  key.section = section_name(texts.section);
  set_kind<T>(texts, &key);
  const KeyRow row = key;
  const T start = S{}.*member;
  // The member may keep what it starts with, even outside the range: that means "not given".
  const auto unset = [row, member, start](const S& s) { return !row.required && s.*member == start; };
  const bool none = !member_fault(row, member, S{}).empty() || member_text(row, member, S{}).empty();
  key.read = [row, member](TomlTable& t, S* s) { read_member(t, row, member, s); };
  key.check = [row, member, unset](const std::string& where, const S& s) {
    const std::string fault = unset(s) ? "" : member_fault(row, member, s);
    if (!fault.empty()) throw Error(ErrorCode::input, fault, where + "." + row.member);
  };
  key.number = [row, member](const S& s) { return member_number(row, member, s); };
  key.text = [row, member, unset, none](const S& s) {
    return none && unset(s) ? row.fallback : member_text(row, member, s);
  };
  if (key.fallback.empty()) {
    const bool word = key.kind == KeyKind::name || key.kind == KeyKind::choice;
    key.fallback = none ? "none" : word ? "\"" + key.text(S{}) + "\"" : key.text(S{});
  }
  store(texts, std::move(key));
}

/// A FORM.
template <class S>
void add_form(const RowTexts& texts, const KeyForm<S>& form) {
  Key<S> key;
  static_cast<KeyRow&>(key) = parse_texts(texts);
  key.section = section_name(texts.section);
  if (key.fallback.empty()) key.fallback = "none";
  const std::string name = key.key.name;
  key.read = [form, name](TomlTable& t, S* s) { form.read(t, name, s); };
  key.check = [form](const std::string& where, const S& s) {
    if (form.check != nullptr) form.check(where, s);
  };
  key.number = [](const S&) { return std::nan(""); };
  key.text = form.text;
  store(texts, std::move(key));
}

/// The sections by their names.
namespace sections {
using source = Source;
using observer = Observer;
using motion = Motion;
using pass = Pass;
using attitude = PassAttitude;
using station = Station;
using trace = TraceOptions;
}  // namespace sections

bool bind_all() {
#define KEY(section, member, name, values, unit, when, meaning) \
  add_key(RowTexts{#section, #member, name, values, unit, when, meaning}, &sections::section::member);
#define FORM(section, form, name, values, unit, when, meaning) \
  add_form(RowTexts{#section, #form, name, values, unit, when, meaning}, forms::section##_##form);
#include "scene/file/keys.def"
#undef FORM
#undef KEY
  return true;
}

void bind_once() {
  static const bool bound = bind_all();
  (void)bound;
}

/// The way that this section is of: laser or sun, spin or table.
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
  for (const std::vector<KeyRow>& rows : {rows_of<Source>(), rows_of<Observer>(), rows_of<Motion>(), rows_of<Pass>(),
                                          rows_of<PassAttitude>(), rows_of<Station>(), rows_of<TraceOptions>()}) {
    if (rows.front().section == section) found = rows;
  }
  return found;
}

template <class S>
void read_keys(TomlTable& t, S* s) {
  // A misspelt key is likelier than a missing one, so it is told first.
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
CLRAY_SECTION(Pass)
CLRAY_SECTION(PassAttitude)
CLRAY_SECTION(Station)
CLRAY_SECTION(TraceOptions)
#undef CLRAY_SECTION

}  // namespace clray
