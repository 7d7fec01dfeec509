// SPDX-License-Identifier: Apache-2.0
// The laws of all groups on random scenes (laws.hpp, harness.hpp), every other one of flat faces, solved as far as they
// can be: wholly, or in their first bounce of what no curved shape shades, with the rest from rays. 2 scenes a group,
// 334 with CLRAY_LONG_TESTS=1.
#include <doctest/doctest.h>

#include <cstdlib>

#include "laws/harness.hpp"
#include "support/scenes.hpp"

using clray_test::LawGroup;

TEST_CASE("laws: what can be solved is") {
  std::array<int, 3> methods{};
  for (const LawGroup group : {LawGroup::alone, LawGroup::order, LawGroup::symmetry}) {
    const bool all = clray_test::long_tests() || std::getenv("CLRAY_LAWS_SCENES") != nullptr;
    clray_test::LawHarness harness(group, all ? clray_test::law_scenes() : 2, clray_test::law_frames(), true);
    for (const std::string& failure : harness.run()) FAIL_CHECK(failure);
    for (const std::string& claim : harness.small_claims()) FAIL_CHECK(claim);
    MESSAGE(harness.summary());
    for (std::size_t k = 0; k < methods.size(); ++k) methods[k] += harness.methods()[k];
  }
  MESSAGE("totals from rays: ", methods[0], ", of an exact first bounce: ", methods[1], ", exact: ", methods[2]);
  CHECK(methods[1] > 10);
  CHECK(methods[2] > 10);
}
