// SPDX-License-Identifier: Apache-2.0
// The keys of scene files as the program's tables state them, for whoever offers them elsewhere: a command line, a
// form, another language. Units are those of the keys' names.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "clray/export.hpp"

CLRAY_API_BEGIN
namespace clray {

/// One key, all in words.
struct KeyInfo {
  std::string name;      ///< as a scene file has it
  std::string fallback;  ///< what holds if it is not given: a value, "none" or "required"
  std::string values;    ///< what may be given: "(0,inf)", "1 to 64", "\"laser\" or \"sun\"", "file"
  std::string meaning;   ///< with the unit, where the name has none
};

/// The names that list_table() knows: the sections of a scene file and the tables brdf, shape and detector; "keys" is
/// all sections together.
const std::vector<std::string>& table_names();

/// The names of the rows of brdf, shape or detector.
std::vector<std::string> table_rows(const std::string& table);

/// The keys of a section of a scene file ("station") or of a row of a table ("delay"), in their order. Throws
/// Error(usage) where there is none of this name.
std::vector<KeyInfo> scene_keys(const std::string& of);

/// Names of units of length and the metres that each has.
const std::vector<std::pair<std::string, double>>& length_units();

/// What is wrong with a number, or a word, for a key, such as ("trace", "seed", -1): "expected …"; empty if nothing is.
std::string key_fault(const std::string& of, const std::string& name, double value);
/// The same of a word.
std::string key_fault(const std::string& of, const std::string& name, const std::string& word);

/// The rows of a table, each with a line per key: name, default, values, meaning. Throws Error(usage) for a name that
/// is not in table_names().
std::string list_table(const std::string& name);

}  // namespace clray
CLRAY_API_END
