// SPDX-License-Identifier: Apache-2.0
// The tables for whoever offers their keys elsewhere (clray/keys.hpp): the rows of brdf.def, shape.def, detector.def,
// walk.def and the sections of keys.def, as one kind of list.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "clray/keys.hpp"
#include "scene/file/keys.hpp"
#include "scene/tables.hpp"
#include "text/columns.hpp"
#include "text/near_miss.hpp"

namespace clray {
namespace {

const std::vector<std::string> kTables{"brdf", "shape", "detector", "walk"};

std::string default_text(const TableKey& key) {
  if (!key.default_key.empty()) return key.default_key;
  if (std::isnan(key.default_value)) return "none";
  if (key.is_switch) return key.default_value != 0.0 ? "true" : "false";
  return fmt::format("{:.6g}", key.default_value);
}

/// A row of one of kTables by its name, or null.
const TableRow* row_named(const std::string& name) {
  for (const std::string& kind : kTables) {
    const int index = table_index(kind, name);
    if (index >= 0) return &table(kind)[static_cast<std::size_t>(index)];
  }
  return nullptr;
}

std::string key_lines(const std::vector<KeyInfo>& keys) {
  text::Columns lines;
  for (const KeyInfo& key : keys) lines.add({key.name, key.fallback, key.values, key.meaning});
  return lines.text("    ");
}

std::vector<KeyInfo> infos(const TableRow& row) {
  std::vector<KeyInfo> all;
  for (const TableKey& key : row.keys) all.push_back({key.name, default_text(key), range_words(key), key.meaning});
  return all;
}

std::vector<KeyInfo> infos(const std::vector<KeyRow>& rows) {
  std::vector<KeyInfo> all;
  for (const KeyRow& row : rows) {
    const std::string way = row.way.empty() ? "" : row.way + ": ";
    all.push_back({row.key.name, row.fallback, row.values, way + row.key.meaning});
  }
  return all;
}

[[noreturn]] void unknown(const std::string& name, const std::vector<std::string>& known) {
  throw Error(ErrorCode::usage,
              fmt::format("there is no list '{}'; expected one of {}{}", name, fmt::join(known, ", "),
                          text::did_you_mean(name, known)),
              "--list");
}

}  // namespace

const std::vector<std::string>& table_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = kTables;
    all.push_back("keys");
    all.insert(all.end(), key_sections().begin(), key_sections().end());
    return all;
  }();
  return names;
}

std::vector<std::string> table_rows(const std::string& table) {
  return row_names(table);
}

std::vector<KeyInfo> scene_keys(const std::string& of) {
  const std::vector<KeyRow> section = key_rows(of);
  if (!section.empty()) return infos(section);
  const TableRow* row = row_named(of);
  if (row == nullptr) throw Error(ErrorCode::usage, "there is no section and no row '" + of + "'");
  return infos(*row);
}

const std::vector<std::pair<std::string, double>>& length_units() {
  static const std::vector<std::pair<std::string, double>> units{
      {"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};
  return units;
}

std::string key_fault(const std::string& of, const std::string& name, double value) {
  std::vector<TableKey> numbers;
  for (const KeyRow& row : key_rows(of)) {
    if (row.kind == KeyKind::number || row.kind == KeyKind::whole) numbers.push_back(row.key);
  }
  if (const TableRow* row = row_named(of)) numbers = row->keys;
  const auto key = std::find_if(numbers.begin(), numbers.end(), [&](const TableKey& k) { return k.name == name; });
  if (key == numbers.end()) throw Error(ErrorCode::bug, "there is no number '" + name + "' in '" + of + "'");
  std::string expected;
  return key_accepts(*key, value, &expected) ? "" : "expected " + expected;
}

std::string key_fault(const std::string& of, const std::string& name, const std::string& word) {
  for (const KeyRow& row : key_rows(of)) {
    if (row.key.name != name || row.kind != KeyKind::choice) continue;
    if (std::find(row.choices.begin(), row.choices.end(), word) != row.choices.end()) return "";
    return fmt::format("expected one of {}{}", fmt::join(row.choices, ", "), text::did_you_mean(word, row.choices));
  }
  throw Error(ErrorCode::bug, "there is no choice '" + name + "' in '" + of + "'");
}

std::string list_table(const std::string& name) {
  std::string text;
  if (std::find(kTables.begin(), kTables.end(), name) != kTables.end()) {
    for (const TableRow& row : table(name)) {
      if (!row.inner) text += row.name + ": " + row.meaning + "\n" + key_lines(infos(row));
    }
    return text;
  }
  for (const std::string& section : key_sections()) {
    if (name == section || name == "keys") text += "[" + section + "]\n" + key_lines(scene_keys(section));
  }
  if (text.empty()) unknown(name, table_names());
  return text;
}

}  // namespace clray
