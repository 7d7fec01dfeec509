// SPDX-License-Identifier: Apache-2.0
// Results as files and as text for a person; references that results are compared with. Numbers have the units of
// their column names in files.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "clray/export.hpp"
#include "clray/result.hpp"

CLRAY_API_BEGIN
namespace clray {

/// Files that another part adds to a result, and its entry in the summary.
struct MoreFiles {
  std::vector<std::string> names;  ///< written into the folder given
  std::string summary_key;         ///< name of an entry for summary.json; empty for none
  std::string summary_json;        ///< that entry as JSON text
  std::string text = {};           ///< shown to a person at the end of a run; may be empty
};

/// How to write results.
struct WriteOptions {
  bool plots = true;                             ///< also draw pictures
  bool netcdf = false;                           ///< also NetCDF files, beside the tables and cubes that have one
  std::string command;                           ///< as typed, for the summary
  std::string reference_file;                    ///< a summary.json or delay.csv to measure the true error against
  std::vector<std::string>* warnings = nullptr;  ///< receives what went wrong without harm (no gnuplot, …)
  const std::atomic<bool>* stop = nullptr;       ///< once set, no more plots are drawn
  /// Called with the unfinished folder; what it writes there appears with the rest, or not at all.
  std::vector<std::function<MoreFiles(const std::string& folder)>> more;
};

/// Checks that the parts of a result fit each other and the scene (sizes, orientations), as those of trace() do.
/// What writes results calls it. Throws Error(usage) with the member's path.
void check_result(const Result& result, const Scene& scene);

/// Writes summary.json, tables and pictures into `folder`, which appears (or is replaced) only whole.
/// Returns the file names written. Throws Error(output); Error(input, usage) for a scene or result that cannot be.
std::vector<std::string> write_result(const Result& result, const Scene& scene, const std::string& folder,
                                      const WriteOptions& options = {});

/// Whether write_result() could put a result at `folder`: throws Error(output) where it could not, because something
/// that is not a clray result stands there or the place cannot be written. Leaves nothing behind.
void check_output(const std::string& folder);

/// Where a result belongs that was meant for `folder`: there, unless an interrupt ended it and a result stands there
/// that is complete or has more rays. Then it is the folder's name with ".partial".
std::string result_folder(const Result& result, const std::string& folder);

/// Totals to measure the true error against, by "detector/observer/variant/band/orientation"; behind it "/sum/number"
/// for sums that are results by themselves. In the units of the totals in summary.json.
struct Reference {
  std::string file;                      ///< that was read
  std::map<std::string, double> totals;  ///< by that key
};

/// Reads a summary.json or a delay.csv. Throws Error(input).
Reference load_reference(const std::string& file);

/// Refuses a reference that can have none of the totals of a scene: no detector, observer and variant of these names
/// or, for a delay.csv, no detector of the kind delay. Throws Error(input).
void check_reference(const Reference& reference, const Scene& scene);

/// The largest |total − reference| / |reference| over the totals that both have; NaN where they share none.
double relative_true_error(const Result& result, const Reference& reference);

/// What a person wants to see of a result first, as UTF-8 text.
struct ResultText {
  std::vector<std::pair<std::string, std::string>>
      rows;            ///< of a single record: what, and its value with error and unit
  std::string tables;  ///< of all others, each behind an empty line
  std::string totals;  ///< a line for each record or number
};
/// Words of a result. Throws Error(usage) for one that check_result() refuses.
ResultText describe_result(const Result& result);

/// "1.2345 ± 0.0012": a number rounded to two digits of its error, in powers of ten where that reads better.
std::string format_with_error(double value, double error);

}  // namespace clray
CLRAY_API_END
