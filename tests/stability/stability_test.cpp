// SPDX-License-Identifier: Apache-2.0
// The quick stiff and extreme cases as tests, all with CLRAY_LONG_TESTS=1; clray-bench stability tabulates them.
#include <doctest/doctest.h>

#include "stability/case.hpp"

namespace {

void run_area(const char* area) {
  for (const clray_test::Case& c : clray_test::stability_cases()) {
    if (c.area != area || (!c.quick && !clray_test::long_tests())) continue;
    const clray_test::Outcome outcome = c.run();
    INFO(c.name, ": must hold: ", c.must_hold, "; measured: ", outcome.measured, "; tolerance: ", c.tolerance);
    CHECK(outcome.pass);
  }
}

}  // namespace

TEST_CASE("stability: bitwise") {
  run_area("bitwise");
}
TEST_CASE("stability: geometry") {
  run_area("geometry");
}
TEST_CASE("stability: surfaces") {
  run_area("surfaces");
}
TEST_CASE("stability: bins") {
  run_area("bins");
}
TEST_CASE("stability: statistics") {
  run_area("statistics");
}
TEST_CASE("stability: exact") {
  run_area("exact");
}
