// SPDX-License-Identifier: Apache-2.0
// The rows of brdf.def, shape.def, detector.def and walk.def as data: names, keys, defaults and ranges.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace clray {

/// One key of a row, e.g. "rho 0.5 [0,1] diffuse reflectance".
struct TableKey {
  std::string name;
  double default_value = 0.0;    ///< NaN: not given
  std::string default_key;       ///< not empty: the default is the value of this earlier key
  double low = 0.0, high = 0.0;  ///< infinite where open
  bool low_included = true, high_included = true;
  bool is_switch = false;  ///< range written {0,1}
  bool is_whole = false;   ///< range written [a..b]: whole numbers
  std::string range;       ///< as written, for messages
  std::string meaning;
};

/// What the rows of a detector's sum belong to.
enum class SumRows { view, lane, connection };
/// How the numbers of a sum are scaled and merged: `greatest` keeps the greater, the others add up.
enum class SumScale { weight, unit, count, greatest };
/// What a work-item keeps of a sum: nothing, a row, a row if it has few numbers, or the one number of its pixel.
enum class SumKeep { nothing, row, small_row, number };

/// One of a detector's sums, e.g. "bins connection bins+2 weight".
struct TableSum {
  std::string name;
  SumRows rows = SumRows::connection;
  std::string width;  ///< numbers a row: products and sums of numbers and names
  SumScale scale = SumScale::weight;
  SumKeep keep = SumKeep::nothing;
  std::string unit;  ///< not empty: its numbers are results, in this unit
};

struct TableRow {
  std::string id;    ///< identifier: the kernel file's stem
  std::string name;  ///< scene-file name; empty: an inner detector
  // Detectors, see the head of detector.def.
  bool beam = false, pixel = false;         ///< where rays may start
  bool connects = false, scatters = false;  ///< what it needs of paths
  bool inner = false;                       ///< no scene names it
  bool mirrors = false;                     ///< alone in passes of light that meets a mirror first
  bool whole = false;                       ///< without bands it measures all the light of a sun
  std::vector<std::string> hooks;
  std::vector<TableSum> sums;
  // Traits, see the heads of the .def files.
  bool delta = false;    ///< models: an ideal reflection
  bool even = false;     ///< models: f is the same in all directions
  bool bounded = false;  ///< models: no weight exceeds the bound of a first bounce
  bool flat = false;     ///< shapes: every face lies in a plane
  bool faces = false;    ///< shapes: made of triangles
  bool file = false;     ///< models and shapes: read from a file
  std::vector<TableKey> keys;
  std::string meaning;
};

/// Rows in the order of the file; kernels know a row by its place. kind: "brdf", "shape", "detector", "walk".
const std::vector<TableRow>& table(const std::string& kind);

/// The moments at which a detector may look (kernels/stage/record.cl).
const std::vector<std::string>& detector_hooks();

/// The value of a sum's width where `value_of` knows its names. Throws Error(bug) for an unknown one.
double sum_width(const TableSum& sum, const std::function<double(const std::string&)>& value_of);

/// The row of this scene-file name, which must be there.
const TableRow& table_row(const std::string& kind, const std::string& name);

/// The row's key of this name, or null.
const TableKey* find_key(const TableRow& row, const std::string& name);

/// One row from its texts, as written in a .def file; `traits` are words. Throws Error(bug)
/// where it is malformed.
TableRow parse_row(const std::string& id, const std::string& name, const std::string& traits, const std::string& keys,
                   const std::string& meaning);

/// Fills the key's bounds and kinds of number from its `range` as written; `row` names it in Error(bug).
void parse_range(const std::string& row, TableKey* key);

/// The range for a person: "(0,inf)", "1 to 64", "true or false".
std::string range_words(const TableKey& key);

/// Whether `value` may be given for `key`; if not, `expected` says what may ("a whole number in [1..1e7]").
bool key_accepts(const TableKey& key, double value, std::string* expected = nullptr);

/// Scene-file names of the rows, in order; inner detectors have none.
std::vector<std::string> row_names(const std::string& kind);

/// Row number by scene-file name, or -1.
int table_index(const std::string& kind, const std::string& name);

/// The row's keys in order, with defaults filled in.
std::vector<double> row_values(const TableRow& row, const std::map<std::string, double>& parameters);

}  // namespace clray
