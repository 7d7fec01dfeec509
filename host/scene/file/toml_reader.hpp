// SPDX-License-Identifier: Apache-2.0
// A strict view of one TOML table: typed, range-checked values, every complaint with file:line:column, the key, what
// was expected and, for a near miss, "did you mean". A key that nobody asked for is an error at finish().
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "clray/scene.hpp"
#include "scene/file/toml_library.hpp"
#include "scene/tables.hpp"
#include "text/near_miss.hpp"

namespace clray {

/// Where a number may lie; `text` is for messages: "[0,1]", "(0,inf) m".
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_included = true, high_included = true;
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Range kAny{-kInfinity, kInfinity, false, false};
constexpr Range kPositive{0.0, kInfinity, false, false};
constexpr Range kNotNegative{0.0, kInfinity, true, false};
constexpr Range kShare{0.0, 1.0, true, true};
/// Times of tables, s: room for Unix, GPS and Julian seconds (the keys' own are in keys.def).
constexpr Range kTime{-1e12, 1e12, true, true};

using text::did_you_mean;

class TomlTable {
 public:
  /// `label` is what messages call the table, e.g. "source" or "component"; `file` is the scene's. `elsewhere` has
  /// files that stand anywhere, by the names that keys give them (SceneOptions::files).
  TomlTable(const toml::table& table, std::string label, std::string file,
            const std::map<std::string, std::string>* elsewhere = nullptr);

  bool has(const std::string& key);
  double number(const std::string& key, const Range& range, std::optional<double> fallback = {});
  std::uint64_t whole(const std::string& key, std::uint64_t low, std::uint64_t high);
  bool boolean(const std::string& key, bool fallback);
  std::string text(const std::string& key, std::optional<std::string> fallback = {});
  /// A text out of `choices`.
  std::string choice(const std::string& key, const std::vector<std::string>& choices,
                     const std::optional<std::string>& fallback = {});
  /// A name fit for result keys and file names.
  std::string name(const std::string& key, std::optional<std::string> fallback = {});
  /// Three finite numbers.
  Vec3 vector(const std::string& key, std::optional<Vec3> fallback = {});
  /// Three finite numbers, not all zero, normalised.
  Vec3 direction(const std::string& key, std::optional<Vec3> fallback = {});
  /// A key of a table row (number, or boolean for a switch); nothing if absent.
  std::optional<double> row_key(const TableKey& key);
  /// A whole number of a table row, exact also beyond 2^53.
  std::uint64_t row_whole(const TableKey& key);
  /// A file inside the scene's folder, or one of those elsewhere, that exists, as a path to open.
  std::string file(const std::string& key);
  /// A table below this one, or nothing.
  std::optional<TomlTable> table(const std::string& key);
  /// [key] or [[key]], in order.
  std::vector<TomlTable> tables(const std::string& key);
  /// The keys of this table as they stand, for tables with free keys; marks them as known.
  std::vector<std::string> keys();
  /// A node for special readers; marks the key as known. Null if absent.
  const toml::node* node(const std::string& key);
  /// Checks one number: type, finiteness and range.
  double number_of(const toml::node& node, const std::string& key, const Range& range) const;

  /// Throws if any key was never asked for.
  void finish();
  /// Marks keys as known, so that they are suggested.
  void know(const std::vector<std::string>& keys);

  [[noreturn]] void fail(const std::string& key, const std::string& message) const;
  [[noreturn]] void fail_at(const toml::source_region& where, const std::string& message) const;
  /// Complains that a key is missing, or of a misspelt one that could be it.
  [[noreturn]] void missing(const std::string& key, const std::string& expected) const;
  std::string key_path(const std::string& key) const { return label_.empty() ? key : label_ + "." + key; }
  const std::string& label() const { return label_; }
  /// Where the table stands, for errors found later.
  std::string place(const std::string& key = {}) const;
  /// A table within this one.
  TomlTable inner(const toml::table& table, std::string label) const {
    return TomlTable(table, std::move(label), file_, elsewhere_);
  }

 private:
  [[noreturn]] void unknown(const toml::key& key) const;
  std::string place_of(const toml::source_region& where) const;

  const toml::table* table_;
  std::string label_;
  std::string file_;
  const std::map<std::string, std::string>* elsewhere_;
  std::set<std::string> known_;
};

/// A TOML file. Throws Error(input) with file:line:column.
toml::table parse_toml(const std::string& text, const std::string& path);

/// What stands there, for messages: `"green"`, `true`, `1.5`, `a table`.
std::string found(const toml::node& node);

/// "[0,1]", "(0,inf)".
std::string range_text(const Range& range);

}  // namespace clray
