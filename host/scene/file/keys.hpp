// SPDX-License-Identifier: Apache-2.0
// The rows of keys.def as data, bound to the members of Source, Observer, Motion, Station and TraceOptions, and what is
// done with them: reading a section of a scene file, checking one that was filled by hand, wording it for a person.
// Numbers of a row are in the unit of its key's name; members are in SI where the names differ.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "clray/scene.hpp"
#include "scene/file/toml_reader.hpp"
#include "scene/tables.hpp"

namespace clray {

enum class KeyKind { number, whole, truth, choice, vector, direction, name, form };

/// One row, without what binds it to its member.
struct KeyRow {
  TableKey key;  ///< name, range (numbers), meaning
  KeyKind kind = KeyKind::form;
  std::string section, member, unit;
  std::string values;                   ///< what may be given, for a person: "(0,inf)", "1 to 64", "\"a\" or \"b\""
  std::string fallback;                 ///< what holds if nothing is given: a value, "none" or "required"
  std::vector<std::string> choices;     ///< of a choice
  bool required = false;                ///< in the section's way `way`
  std::string way;                      ///< the way of the section that has this key; empty: all
  std::vector<std::string> not_beside;  ///< keys that exclude this one
};

/// A key whose value has a form of its own.
template <class Section>
struct KeyForm {
  /// Reads the key, which is there.
  void (*read)(TomlTable& table, const std::string& key, Section* section);
  /// Throws Error(input) where a section filled by hand is wrong; `where` is the section's path. May be null.
  void (*check)(const std::string& where, const Section& section);
  /// The value for a person; empty where there is none.
  std::string (*text)(const Section& section);
};

/// A row and its member.
template <class Section>
struct Key : KeyRow {
  std::function<void(TomlTable&, Section*)> read;                 ///< the key, which is there
  std::function<void(const std::string&, const Section&)> check;  ///< throws Error(input)
  std::function<double(const Section&)> number;                   ///< in the key's unit; NaN where it is no number
  std::function<std::string(const Section&)> text;                ///< for a person; empty where nothing is given
};

/// The rows of a section in the order of keys.def.
template <class Section>
const std::vector<Key<Section>>& keys();

/// All rows of a section by its name ("station"), for listings; empty where there is no such section.
std::vector<KeyRow> key_rows(const std::string& section);

/// The sections of keys.def, in order.
const std::vector<std::string>& key_sections();

/// Reads the keys of a section that are there; complains of others, of missing ones and of those that exclude each
/// other.
template <class Section>
void read_keys(TomlTable& table, Section* section);

/// Checks each member of a section filled by hand by its row. Throws Error(input) with `where`.member.
template <class Section>
void check_keys(const std::string& where, const Section& section);

/// A key of a section and its value.
struct KeyValue {
  const KeyRow* row;
  std::string value;  ///< for a person; empty: nothing is given
};

/// Every key that the section, as it is, may have, but those that a given key excludes.
template <class Section>
std::vector<KeyValue> key_values(const Section& section);

/// "key value, key value, …" of what is given or has a default.
template <class Section>
std::string key_text(const Section& section);

}  // namespace clray
