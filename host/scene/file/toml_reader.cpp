// SPDX-License-Identifier: Apache-2.0
// Strict reading of TOML tables for scene files, see toml_reader.hpp.
#include "scene/file/toml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "clray/error.hpp"
#include "scene/file/toml_depth.hpp"
#include "scene/file/value_checks.hpp"
#include "text/input_file.hpp"

namespace clray {
namespace {

namespace fs = std::filesystem;

bool inside(const Range& r, double value) {
  return (r.low_included ? value >= r.low : value > r.low) && (r.high_included ? value <= r.high : value < r.high);
}

bool before(const toml::source_region& a, const toml::source_region& b) {
  return a.begin.line != b.begin.line ? a.begin.line < b.begin.line : a.begin.column < b.begin.column;
}

}  // namespace

toml::table parse_toml(const std::string& text, const std::string& path) {
  if (const TextPlace deep = deep_key(text); deep.line > 0) {
    throw Error(ErrorCode::input,
                fmt::format("a key of more than {} parts; at most that many were expected", kMostKeyParts),
                fmt::format("{}:{}:{}", path, deep.line, deep.column));
  }
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& e) {
    const toml::source_position at = e.source().begin;
    throw Error(ErrorCode::input, "not TOML: " + std::string(e.description()),
                fmt::format("{}:{}:{}", path, at.line, at.column));
  }
}

std::string found(const toml::node& node) {
  if (const auto* s = node.as_string()) return "\"" + s->get() + "\"";
  if (const auto* b = node.as_boolean()) return b->get() ? "true" : "false";
  if (const auto* i = node.as_integer()) return fmt::format("{}", i->get());
  if (const auto* d = node.as_floating_point()) return fmt::format("{}", d->get());
  if (node.is_table()) return "a table";
  if (const auto* a = node.as_array()) return fmt::format("an array of {}", a->size());
  return "a date or time";
}

std::string range_text(const Range& r) {
  return fmt::format("{}{},{}{}", r.low_included ? '[' : '(', r.low, r.high, r.high_included ? ']' : ')');
}

TomlTable::TomlTable(const toml::table& table, std::string label, std::string file,
                     const std::map<std::string, std::string>* elsewhere)
    : table_(&table), label_(std::move(label)), file_(std::move(file)), elsewhere_(elsewhere) {}

std::string TomlTable::place_of(const toml::source_region& where) const {
  return fmt::format("{}:{}:{}", file_, where.begin.line, where.begin.column);
}

std::string TomlTable::place(const std::string& key) const {
  const toml::node* value = key.empty() ? nullptr : table_->get(key);
  return place_of(value != nullptr ? value->source() : table_->source());
}

void TomlTable::fail_at(const toml::source_region& where, const std::string& message) const {
  throw Error(ErrorCode::input, message, place_of(where));
}

void TomlTable::fail(const std::string& key, const std::string& message) const {
  throw Error(ErrorCode::input, key_path(key) + ": " + message, place(key));
}

void TomlTable::unknown(const toml::key& key) const {
  const std::vector<std::string> known(known_.begin(), known_.end());
  const std::string where = label_.empty() ? "" : " in [" + label_ + "]";
  std::string message = fmt::format("unknown key '{}'{}", std::string(key.str()), where);
  const std::string hint = did_you_mean(std::string(key.str()), known);
  if (!hint.empty()) {
    message += hint;
  } else if (!known.empty()) {
    message += fmt::format("; expected one of {}", fmt::join(known, ", "));
  }
  fail_at(key.source(), message);
}

void TomlTable::missing(const std::string& key, const std::string& expected) const {
  // A misspelt key is the likelier fault, and its place is the better one to name.
  for (const auto& [present, value] : *table_) {
    const std::string word(present.str());
    if (known_.count(word) == 0 && text::nearest(word, {key}) == key) unknown(present);
  }
  fail(key, "missing; expected " + expected);
}

const toml::node* TomlTable::node(const std::string& key) {
  known_.insert(key);
  return table_->get(key);
}

bool TomlTable::has(const std::string& key) {
  return node(key) != nullptr;
}

void TomlTable::know(const std::vector<std::string>& keys) {
  known_.insert(keys.begin(), keys.end());
}

double TomlTable::number_of(const toml::node& value, const std::string& key, const Range& range) const {
  const bool bounded = std::isfinite(range.low) || std::isfinite(range.high);
  const std::string expected = bounded ? "a number in " + range_text(range) : "a finite number";
  const std::optional<double> number = value.is_number() ? value.value<double>() : std::optional<double>();
  if (!number || !std::isfinite(*number) || !inside(range, *number)) {
    fail_at(value.source(), fmt::format("{}: expected {}, found {}", key_path(key), expected, found(value)));
  }
  return *number;
}

double TomlTable::number(const std::string& key, const Range& range, std::optional<double> fallback) {
  const toml::node* value = node(key);
  if (value == nullptr && !fallback) missing(key, "a number in " + range_text(range));
  return value == nullptr ? *fallback : number_of(*value, key, range);
}

std::uint64_t TomlTable::whole(const std::string& key, std::uint64_t low, std::uint64_t high) {
  TableKey row;
  row.name = key;
  row.range = fmt::format("[{}..{}]", low, high);
  parse_range(key, &row);
  return row_whole(row);
}

std::uint64_t TomlTable::row_whole(const TableKey& key) {
  std::string expected;
  key_accepts(key, 0.0, &expected);
  const toml::node* value = node(key.name);
  if (value == nullptr) missing(key.name, expected);
  std::optional<std::uint64_t> number;
  if (const auto* i = value->as_integer()) {
    if (i->get() >= 0) number = static_cast<std::uint64_t>(i->get());
  } else if (const auto* d = value->as_floating_point()) {
    if (d->get() >= 0.0 && d->get() < 0x1p63 && d->get() == std::floor(d->get())) {
      number = static_cast<std::uint64_t>(d->get());
    }
  }
  if (!number || !key_accepts(key, static_cast<double>(*number))) {
    fail(key.name, fmt::format("expected {}, found {}", expected, found(*value)));
  }
  return *number;
}

bool TomlTable::boolean(const std::string& key, bool fallback) {
  const toml::node* value = node(key);
  if (value == nullptr) return fallback;
  if (!value->is_boolean()) fail(key, "expected true or false, found " + found(*value));
  return value->as_boolean()->get();
}

std::string TomlTable::text(const std::string& key, std::optional<std::string> fallback) {
  const toml::node* value = node(key);
  if (value == nullptr) {
    if (!fallback) missing(key, "a text");
    return *fallback;
  }
  if (!value->is_string()) fail(key, "expected a text, found " + found(*value));
  return value->as_string()->get();
}

std::string TomlTable::choice(const std::string& key, const std::vector<std::string>& choices,
                              const std::optional<std::string>& fallback) {
  const toml::node* value = node(key);
  if (value == nullptr && !fallback) missing(key, fmt::format("one of {}", fmt::join(choices, ", ")));
  std::string word = text(key, fallback);
  if (value != nullptr && std::find(choices.begin(), choices.end(), word) == choices.end()) {
    fail(key, fmt::format("expected one of {}, found \"{}\"{}", fmt::join(choices, ", "), word,
                          did_you_mean(word, choices)));
  }
  return word;
}

std::string TomlTable::name(const std::string& key, std::optional<std::string> fallback) {
  std::string word = text(key, std::move(fallback));
  if (has(key) && !is_name(word)) fail(key, std::string(kNameExpected) + ", found \"" + word + "\"");
  return word;
}

Vec3 TomlTable::vector(const std::string& key, std::optional<Vec3> fallback) {
  const toml::node* value = node(key);
  if (value == nullptr) {
    if (!fallback) missing(key, "three numbers [x, y, z]");
    return *fallback;
  }
  const toml::array* array = value->as_array();
  if (array == nullptr || array->size() != 3) fail(key, "expected three numbers [x, y, z], found " + found(*value));
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = number_of(*array->get(static_cast<std::size_t>(i)), key, kAny);
  return v;
}

Vec3 TomlTable::direction(const std::string& key, std::optional<Vec3> fallback) {
  if (node(key) == nullptr && fallback) return *fallback;
  const Vec3 v = vector(key);
  if (v == Vec3(0.0)) fail(key, "expected a direction, found the zero vector");
  return unit_vector(v);
}

std::optional<double> TomlTable::row_key(const TableKey& key) {
  const toml::node* value = node(key.name);
  if (value == nullptr) return {};
  std::optional<double> number;
  if (value->is_number()) number = value->value<double>();
  if (key.is_switch && value->is_boolean()) number = value->as_boolean()->get() ? 1.0 : 0.0;
  std::string expected;
  const bool accepted = key_accepts(key, number.value_or(std::nan("")), &expected);
  if (!number || !accepted) fail(key.name, fmt::format("expected {}, found {}", expected, found(*value)));
  return number;
}

std::string TomlTable::file(const std::string& key) {
  const std::string name = text(key);
  if (elsewhere_ != nullptr && elsewhere_->count(name) != 0) {
    const std::string& path = elsewhere_->at(name);
    if (const std::string fault = text::input_file_fault(path); !fault.empty()) fail(key, "\"" + path + "\" " + fault);
    return path;
  }
  fs::path folder = fs::path(file_).parent_path();
  if (folder.empty()) folder = ".";
  std::error_code error;
  const fs::path root = fs::weakly_canonical(folder, error);
  const fs::path path = fs::weakly_canonical(folder / name, error);
  const auto ends = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  if (name.empty() || error || ends.first != root.end()) {
    fail(key, "expected a file inside the scene's folder, found \"" + name + "\"");
  }
  std::string shown = (fs::path(file_).parent_path() / name).string();
  const std::string fault = text::input_file_fault(shown);
  if (fault.empty()) return shown;
  if (fs::exists(path, error)) fail(key, "\"" + name + "\" " + fault);
  std::vector<std::string> neighbours;
  const fs::path inside = fs::path(name).parent_path();
  for (fs::directory_iterator it(folder / inside, error), end; !error && it != end; it.increment(error)) {
    neighbours.push_back((inside / it->path().filename()).string());
  }
  std::sort(neighbours.begin(), neighbours.end());
  fail(key, "there is no file \"" + name + "\"" + did_you_mean(name, neighbours));
}

std::optional<TomlTable> TomlTable::table(const std::string& key) {
  const toml::node* value = node(key);
  if (value == nullptr) return {};
  if (!value->is_table()) fail(key, "expected a table, found " + found(*value));
  return inner(*value->as_table(), key_path(key));
}

std::vector<TomlTable> TomlTable::tables(const std::string& key) {
  const toml::node* value = node(key);
  std::vector<TomlTable> all;
  if (value == nullptr) return all;
  if (const toml::table* one = value->as_table()) {
    all.push_back(inner(*one, key_path(key)));
    return all;
  }
  const toml::array* array = value->as_array();
  if (array == nullptr) fail(key, "expected a table, found " + found(*value));
  for (const toml::node& each : *array) {
    if (!each.is_table()) fail_at(each.source(), key_path(key) + ": expected a table, found " + found(each));
    all.push_back(inner(*each.as_table(), key_path(key)));
  }
  return all;
}

std::vector<std::string> TomlTable::keys() {
  std::vector<const toml::key*> present;
  for (const auto& [key, value] : *table_) present.push_back(&key);
  std::sort(present.begin(), present.end(),
            [](const toml::key* a, const toml::key* b) { return before(a->source(), b->source()); });
  std::vector<std::string> words;
  for (const toml::key* key : present) words.emplace_back(key->str());
  know(words);
  return words;
}

void TomlTable::finish() {
  const toml::key* first = nullptr;
  for (const auto& [key, value] : *table_) {
    const bool unasked = known_.count(std::string(key.str())) == 0;
    if (unasked && (first == nullptr || before(key.source(), first->source()))) first = &key;
  }
  if (first != nullptr) unknown(*first);
}

}  // namespace clray
