// SPDX-License-Identifier: Apache-2.0
// Results of many orientations: small files, nothing lost, and references that read them.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "clray/write.hpp"
#include "unit/io_support.hpp"

using namespace clray;
using io_test::Scratch;
using io_test::slurp;

TEST_CASE("many orientations: a short summary, tables for the rest, and a reference that follows them") {
  Result result = io_test::result();
  result.orientations.assign(1001, result.orientations.front());
  for (std::size_t i = 0; i < 1001; ++i) {
    result.orientations[i].time_s = 0.25 * static_cast<double>(i);
    result.delay.push_back(io_test::delay(8, i));
  }
  Scratch scratch;
  WriteOptions options;
  options.plots = false;
  const auto files = write_result(result, io_test::scene(), scratch / "out", options);
  CHECK(std::filesystem::file_size(scratch / "out/summary.json") < 20000);
  const auto summary = nlohmann::json::parse(slurp(scratch / "out/summary.json"));
  CHECK(summary["totals"]["file"] == "totals.csv");
  CHECK(summary["totals"]["count"] == 1001);
  CHECK(summary["orientations"]["count"] == 1001);
  CHECK(summary["detectors"]["delay"]["orientations"] == 1001);
  CHECK_FALSE(std::filesystem::exists(scratch / "out/delay.csv"));  // delay.fits has it
  CHECK(std::filesystem::exists(scratch / "out/delay.fits"));
  const Reference same = load_reference(scratch / "out/summary.json");
  CHECK(same.totals.size() == 1001);
  CHECK(relative_true_error(result, same) == 0.0);
  result.delay[1000].intensity_m2_per_sr.value *= 1.5;
  CHECK(relative_true_error(result, same) == doctest::Approx(0.5).epsilon(1e-14));
}
