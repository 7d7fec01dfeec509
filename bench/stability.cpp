// SPDX-License-Identifier: Apache-2.0
// clray-bench stability: runs the stiff and extreme cases and writes stability.md, a row a case. Exit 1 if one fails.
// With --only, the rows of what ran take the place of theirs in the stability.md of the folder, if there is one. Cases
// of many minutes run if CLRAY_LONG_TESTS is 1 or if --only names them.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <regex>

#include "bench.hpp"
#include "clray/error.hpp"
#include "stability/case.hpp"

namespace clray_bench {

namespace {

using Row = std::vector<std::string>;
const Row kHeading = {"area", "case", "must hold", "measured", "tolerance and its origin", "seconds", ""};
const char* const kFail = "**FAIL**";

Row run_case(const clray_test::Case& c) {
  const auto start = std::chrono::steady_clock::now();
  clray_test::Outcome outcome;
  try {
    outcome = c.run();
  } catch (const std::exception& e) {
    outcome.measured = std::string("error: ") + e.what();
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{} {}: {}: {}\n", outcome.pass ? "pass" : "FAIL", c.area, c.name, outcome.measured);
  std::fflush(stdout);
  return {c.area,
          c.name,
          c.must_hold,
          outcome.measured,
          c.tolerance,
          fmt::format("{:.1f}", seconds),
          outcome.pass ? "pass" : kFail};
}

/// A document that clray-bench wrote: what stands above the table, and its rows by area and case.
struct Document {
  std::string head;
  std::map<std::string, Row> rows;
};

std::string key_of(const Row& row) {
  return row.at(0) + " " + row.at(1);
}

Document read_document(const std::string& path) {
  Document d;
  std::ifstream file(path);
  bool table = false;
  for (std::string line; std::getline(file, line);) {
    table = table || line.rfind("| ", 0) == 0;
    if (!table) {
      d.head += line + "\n";
      continue;
    }
    Row row;
    for (std::size_t at = 2, end; (end = line.find(" | ", at)) != std::string::npos; at = end + 3)
      row.push_back(line.substr(at, end - at));
    row.push_back(line.size() > 4 && line.find("pass |", line.size() - 6) != std::string::npos ? "pass" : kFail);
    if (row.size() == kHeading.size() && row[0] != kHeading[0]) d.rows[key_of(row)] = row;
  }
  return d;
}

/// The document with the rows that ran, in the order of the cases. Rows of cases that are no more are left out.
std::string refreshed(Document old, const std::vector<Row>& ran) {
  for (const Row& row : ran) old.rows[key_of(row)] = row;
  std::vector<Row> rows = {kHeading};
  for (const clray_test::Case& c : clray_test::stability_cases()) {
    const auto found = old.rows.find(c.area + " " + c.name);
    if (found != old.rows.end()) rows.push_back(found->second);
  }
  const auto fail = [](const Row& row) { return row.back() == kFail; };
  const auto failed = std::count_if(rows.begin(), rows.end(), fail);
  const auto count = static_cast<std::ptrdiff_t>(rows.size()) - 1;
  const std::string holds = fmt::format("{} of {} cases hold", count - failed, count);
  return std::regex_replace(old.head, std::regex("[0-9]+ of [0-9]+ cases hold"), holds) + markdown(rows);
}

}  // namespace

int stability(const Options& options) {
  std::vector<Row> rows;
  int failed = 0;
  for (const clray_test::Case& c : clray_test::stability_cases()) {
    if ((options.quick && !c.quick) || !wanted(options, c.area + " " + c.name)) continue;
    if (c.long_run && !clray_test::long_tests() && (options.only.empty() || !wanted(options, c.name))) continue;
    rows.push_back(run_case(c));
    failed += rows.back().back() == kFail;
  }
  const std::size_t ran = rows.size();
  fmt::print("{} of {} stability cases hold\n", ran - static_cast<std::size_t>(failed), ran);
  Document document;
  if (!options.quick && !options.only.empty()) document = read_document(options.out + "/stability.md");
  if (document.head.empty())
    document.head =
        fmt::format("# Stiff and extreme cases\n\nWritten by `clray-bench stability{}` on {}. 0 of 0 cases hold.\n\n",
                    options.quick ? " --short" : "", device_line());
  // A short run does not replace the table of the full one.
  write_text(options.out, options.quick ? "stability-short.md" : "stability.md", refreshed(std::move(document), rows));
  return failed == 0 ? 0 : 1;
}

}  // namespace clray_bench
