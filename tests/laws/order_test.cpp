// SPDX-License-Identifier: Apache-2.0
// The laws of the group "order" on random scenes (laws.hpp, harness.hpp): 2 of them, 334 with CLRAY_LONG_TESTS=1.
#include <doctest/doctest.h>

#include "laws/harness.hpp"

TEST_CASE("laws: order") {
  clray_test::LawHarness harness(clray_test::LawGroup::order, clray_test::law_scenes(), clray_test::law_frames());
  for (const std::string& failure : harness.run()) FAIL_CHECK(failure);
  for (const std::string& claim : harness.small_claims()) FAIL_CHECK(claim);
  MESSAGE(harness.summary());
}
