// SPDX-License-Identifier: Apache-2.0
// Reads the rows of brdf.def, shape.def, detector.def and walk.def, compiled in, into data that the scene reader, the
// checks, the listings and the packer share. A row that cannot be read is a fault of clray, not of a scene.
#include "scene/tables.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "clray/error.hpp"

namespace clray {
namespace {

struct RawRow {
  const char* id;
  const char* name;
  const char* traits;
  const char* keys;
  const char* meaning;
  const char* hooks = "";
  const char* sums = "";
};

const RawRow kBrdfRows[] = {
#define BRDF(id, name, traits, keys, meaning) {#id, name, traits, keys, meaning},
#include "brdf/brdf.def"
#undef BRDF
};
const RawRow kShapeRows[] = {
#define SHAPE(id, name, traits, keys, meaning) {#id, name, traits, keys, meaning},
#include "shape/shape.def"
#undef SHAPE
};
const RawRow kDetectorRows[] = {
#define DETECTOR(id, name, traits, hooks, sums, keys, meaning) {#id, name, traits, keys, meaning, hooks, sums},
#include "detector/detector.def"
#undef DETECTOR
};

const RawRow kWalkRows[] = {
#define WALK(id, name, meaning) {#id, name, "", "", meaning},
#include "walk/walk.def"
#undef WALK
};

[[noreturn]] void malformed(const std::string& row, const std::string& what) {
  throw Error(ErrorCode::bug, "malformed table row: " + what, row);
}

bool to_number(const std::string& text, double* value) {
  const bool negative = !text.empty() && text[0] == '-';
  const std::string size = negative ? text.substr(1) : text;
  if (size == "inf") {
    *value = negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    return true;
  }
  if (text.rfind("2^", 0) == 0) {
    double power = 0.0;
    if (!to_number(text.substr(2), &power)) return false;
    *value = std::exp2(power);
    return true;
  }
  const auto end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, *value);
  return read.ec == std::errc() && read.ptr == end && std::isfinite(*value);
}

/// The next word of `text` from `at` on; moves `at` behind it.
std::string next_word(const std::string& text, std::size_t* at) {
  const std::size_t begin = text.find_first_not_of(' ', *at);
  if (begin == std::string::npos) {
    *at = text.size();
    return {};
  }
  const std::size_t end = std::min(text.find(' ', begin), text.size());
  *at = end;
  return text.substr(begin, end - begin);
}

void parse_traits(const std::string& traits, TableRow* row) {
  const std::pair<const char*, bool TableRow::*> known[] = {
      {"delta", &TableRow::delta},       {"even", &TableRow::even},   {"bounded", &TableRow::bounded},
      {"flat", &TableRow::flat},         {"faces", &TableRow::faces}, {"file", &TableRow::file},
      {"beam", &TableRow::beam},         {"pixel", &TableRow::pixel}, {"connects", &TableRow::connects},
      {"scatters", &TableRow::scatters}, {"inner", &TableRow::inner}, {"whole", &TableRow::whole},
      {"mirrors", &TableRow::mirrors}};
  std::size_t at = 0;
  for (std::string word = next_word(traits, &at); !word.empty(); word = next_word(traits, &at)) {
    const auto trait = std::find_if(std::begin(known), std::end(known), [&](const auto& k) { return k.first == word; });
    if (trait == std::end(known)) malformed(row->id, "unknown trait '" + word + "'");
    row->*trait->second = true;
  }
}

TableKey parse_key(const TableRow& row, const std::string& text) {
  std::size_t at = 0;
  TableKey key;
  key.name = next_word(text, &at);
  const std::string default_word = next_word(text, &at);
  key.range = next_word(text, &at);
  const std::size_t rest = text.find_first_not_of(' ', at);
  if (rest == std::string::npos) malformed(row.id, "key '" + text + "' needs a name, default, range and meaning");
  key.meaning = text.substr(rest);
  parse_range(row.id, &key);
  for (const TableKey& other : row.keys) {
    if (other.name == key.name) malformed(row.id, "key '" + key.name + "' occurs twice");
    if (other.name == default_word) key.default_key = default_word;
  }
  if (!key.default_key.empty()) return key;
  if (default_word == "nan") {
    key.default_value = std::numeric_limits<double>::quiet_NaN();
  } else if (!to_number(default_word, &key.default_value)) {
    malformed(row.id, "default '" + default_word + "' of key '" + key.name + "' is no number and no earlier key");
  } else if (!key_accepts(key, key.default_value)) {
    malformed(row.id, "default of key '" + key.name + "' is outside " + key.range);
  }
  return key;
}

template <class Value, std::size_t N>
Value parse_word(const TableRow& row, const std::string& word, const std::pair<const char*, Value> (&known)[N]) {
  for (const auto& [name, value] : known) {
    if (word == name) return value;
  }
  malformed(row.id, "unknown word '" + word + "' in a sum");
}

TableSum parse_sum(const TableRow& row, const std::string& text) {
  static const std::pair<const char*, SumRows> kRows[] = {
      {"view", SumRows::view}, {"lane", SumRows::lane}, {"connection", SumRows::connection}};
  static const std::pair<const char*, SumScale> kScales[] = {{"weight", SumScale::weight},
                                                             {"unit", SumScale::unit},
                                                             {"count", SumScale::count},
                                                             {"greatest", SumScale::greatest}};
  static const std::pair<const char*, SumKeep> kKeeps[] = {
      {"kept", SumKeep::row}, {"small", SumKeep::small_row}, {"item", SumKeep::number}};
  std::size_t at = 0;
  TableSum sum;
  sum.name = next_word(text, &at);
  sum.rows = parse_word(row, next_word(text, &at), kRows);
  sum.width = next_word(text, &at);
  std::string scale = next_word(text, &at);
  if (const std::size_t split = scale.find('_'); split != std::string::npos) {
    sum.keep = parse_word(row, scale.substr(0, split), kKeeps);
    scale = scale.substr(split + 1);
  }
  sum.scale = parse_word(row, scale, kScales);
  sum.unit = next_word(text, &at);
  if (!next_word(text, &at).empty()) malformed(row.id, "a sum has a name, rows, a width, a scale and perhaps a unit");
  const bool has_error = sum.rows != SumRows::view && (sum.scale == SumScale::weight || sum.scale == SumScale::unit);
  if (!sum.unit.empty() && !has_error)
    malformed(row.id, "sum '" + sum.name + "' has a unit, but no replicates of a weight or a share");
  return sum;
}

void parse_detector(const RawRow& raw, TableRow* row) {
  const std::string hooks = raw.hooks, sums = raw.sums;
  std::size_t at = 0;
  for (std::string word = next_word(hooks, &at); !word.empty(); word = next_word(hooks, &at)) {
    const std::vector<std::string>& known = detector_hooks();
    if (std::find(known.begin(), known.end(), word) == known.end()) malformed(row->id, "unknown hook '" + word + "'");
    row->hooks.push_back(word);
  }
  for (at = 0; at < sums.size();) {
    const std::size_t end = std::min(sums.find(';', at), sums.size());
    row->sums.push_back(parse_sum(*row, sums.substr(at, end - at)));
    at = end + 1;
  }
}

template <std::size_t N>
std::vector<TableRow> parse_rows(const RawRow (&raw)[N]) {
  std::vector<TableRow> rows;
  for (const RawRow& r : raw) {
    rows.push_back(parse_row(r.id, r.name, r.traits, r.keys, r.meaning));
    parse_detector(r, &rows.back());
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
      if (rows[i].id == rows.back().id || (rows[i].name == rows.back().name && !rows[i].inner))
        malformed(r.id, "row occurs twice");
    }
  }
  return rows;
}

}  // namespace

TableRow parse_row(const std::string& id, const std::string& name, const std::string& traits, const std::string& keys,
                   const std::string& meaning) {
  TableRow row;
  row.id = id;
  row.name = name;
  row.meaning = meaning;
  parse_traits(traits, &row);
  if (id.empty() || name.empty() != row.inner || meaning.empty()) malformed(id, "needs an id, a name and a meaning");
  for (std::size_t at = 0; at < keys.size();) {
    const std::size_t end = std::min(keys.find(';', at), keys.size());
    row.keys.push_back(parse_key(row, keys.substr(at, end - at)));
    at = end + 1;
    if (at == keys.size()) malformed(id, "ends in ';'");
  }
  return row;
}

void parse_range(const std::string& row, TableKey* key) {
  const std::string& range = key->range;
  if (range == "{0,1}") {
    key->is_switch = true;
    key->low = 0.0;
    key->high = 1.0;
    return;
  }
  if (range.size() < 5) malformed(row, "range '" + range + "' of key '" + key->name + "'");
  const std::size_t dots = range.find("..");
  const std::size_t middle = dots != std::string::npos ? dots : range.find(',');
  const char open = range.front(), close = range.back();
  const bool brackets = (open == '[' || open == '(') && (close == ']' || close == ')');
  if (middle == std::string::npos || !brackets) malformed(row, "range '" + range + "' of key '" + key->name + "'");
  const std::size_t after = middle + (dots != std::string::npos ? 2 : 1);
  if (!to_number(range.substr(1, middle - 1), &key->low) ||
      !to_number(range.substr(after, range.size() - after - 1), &key->high) || !(key->low < key->high)) {
    malformed(row, "range '" + range + "' of key '" + key->name + "'");
  }
  key->is_whole = dots != std::string::npos;
  key->low_included = open == '[';
  key->high_included = close == ']';
}

std::string range_words(const TableKey& key) {
  if (key.is_switch) return "true or false";
  if (!key.is_whole) return key.range;
  const std::size_t dots = key.range.find("..");
  return key.range.substr(1, dots - 1) + " to " + key.range.substr(dots + 2, key.range.size() - dots - 3);
}

bool key_accepts(const TableKey& key, double value, std::string* expected) {
  if (expected != nullptr) {
    *expected = key.is_switch ? "true or false" : (key.is_whole ? "a whole number in " : "a number in ") + key.range;
  }
  if (!std::isfinite(value)) return false;
  if (key.is_switch) return value == 0.0 || value == 1.0;
  if (key.is_whole && value != std::floor(value)) return false;
  const bool above = key.low_included ? value >= key.low : value > key.low;
  const bool below = key.high_included ? value <= key.high : value < key.high;
  return above && below;
}

const std::vector<std::string>& detector_hooks() {
  static const std::vector<std::string> hooks{"hit", "connect", "scatter", "escape", "end", "flush"};
  return hooks;
}

const std::vector<TableRow>& table(const std::string& kind) {
  static const std::vector<TableRow> brdf = parse_rows(kBrdfRows);
  static const std::vector<TableRow> shape = parse_rows(kShapeRows);
  static const std::vector<TableRow> detector = parse_rows(kDetectorRows);
  static const std::vector<TableRow> walk = parse_rows(kWalkRows);
  if (kind == "brdf") return brdf;
  if (kind == "shape") return shape;
  if (kind == "detector") return detector;
  if (kind == "walk") return walk;
  throw Error(ErrorCode::bug, "there is no table '" + kind + "'");
}

std::vector<std::string> row_names(const std::string& kind) {
  std::vector<std::string> names;
  for (const TableRow& row : table(kind)) {
    if (!row.inner) names.push_back(row.name);
  }
  return names;
}

int table_index(const std::string& kind, const std::string& name) {
  const std::vector<TableRow>& rows = table(kind);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].name == name && !rows[i].inner) return static_cast<int>(i);
  }
  return -1;
}

double sum_width(const TableSum& sum, const std::function<double(const std::string&)>& value_of) {
  double total = 0.0, product = 1.0;
  for (std::size_t at = 0; at <= sum.width.size();) {
    const std::size_t end = std::min(sum.width.find_first_of("*+", at), sum.width.size());
    const std::string word = sum.width.substr(at, end - at);
    double number;
    product *= to_number(word, &number) ? number : value_of(word);
    if (end == sum.width.size() || sum.width[end] == '+') {
      total += product;
      product = 1.0;
    }
    at = end + 1;
  }
  return total;
}

const TableRow& table_row(const std::string& kind, const std::string& name) {
  const int index = table_index(kind, name);
  if (index < 0) throw Error(ErrorCode::bug, "there is no row '" + name + "' in the table '" + kind + "'");
  return table(kind)[static_cast<std::size_t>(index)];
}

const TableKey* find_key(const TableRow& row, const std::string& name) {
  const auto key = std::find_if(row.keys.begin(), row.keys.end(), [&](const TableKey& k) { return k.name == name; });
  return key == row.keys.end() ? nullptr : &*key;
}

std::vector<double> row_values(const TableRow& row, const std::map<std::string, double>& parameters) {
  std::vector<double> values;
  for (const TableKey& key : row.keys) {
    const auto given = parameters.find(key.name);
    if (given != parameters.end()) {
      values.push_back(given->second);
      continue;
    }
    double value = key.default_value;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (row.keys[i].name == key.default_key) value = values[i];
    }
    values.push_back(value);
  }
  return values;
}

}  // namespace clray
