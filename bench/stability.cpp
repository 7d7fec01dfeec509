// SPDX-License-Identifier: Apache-2.0
// clray-bench stability: runs the stiff and extreme cases and writes stability.md, a row a case. Exit 1 if one fails.
// Those of many minutes run if CLRAY_LONG_TESTS is 1 or if --only names them.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>

#include "bench.hpp"
#include "clray/error.hpp"
#include "stability/case.hpp"

namespace clray_bench {

int stability(const Options& options) {
  std::vector<std::vector<std::string>> rows = {
      {"area", "case", "must hold", "measured", "tolerance and its origin", "seconds", ""}};
  int failed = 0, ran = 0;
  for (const clray_test::Case& c : clray_test::stability_cases()) {
    if ((options.quick && !c.quick) || !wanted(options, c.area + " " + c.name)) continue;
    if (c.long_run && !clray_test::long_tests() && (options.only.empty() || !wanted(options, c.name))) continue;
    const auto start = std::chrono::steady_clock::now();
    clray_test::Outcome outcome;
    try {
      outcome = c.run();
    } catch (const std::exception& e) {
      outcome.measured = std::string("error: ") + e.what();
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ++ran;
    failed += !outcome.pass;
    rows.push_back({c.area, c.name, c.must_hold, outcome.measured, c.tolerance, fmt::format("{:.1f}", seconds),
                    outcome.pass ? "pass" : "**FAIL**"});
    fmt::print("{} {}: {}: {}\n", outcome.pass ? "pass" : "FAIL", c.area, c.name, outcome.measured);
    std::fflush(stdout);
  }
  fmt::print("{} of {} stability cases hold\n", ran - failed, ran);
  const std::string text =
      fmt::format("# Stiff and extreme cases\n\nWritten by `clray-bench stability{}` on {}. {} of {} cases hold.\n\n{}",
                  options.quick ? " --short" : "", device_line(), ran - failed, ran, markdown(rows));
  // A short run does not replace the table of the full one.
  write_text(options.out, options.quick || !options.only.empty() ? "stability-short.md" : "stability.md", text);
  return failed == 0 ? 0 : 1;
}

}  // namespace clray_bench
