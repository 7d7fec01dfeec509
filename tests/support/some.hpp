// SPDX-License-Identifier: Apache-2.0
// Which of many alike cases a test takes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <vector>

#include "support/scenes.hpp"

namespace clray_test {

/// The first `count` of cases that show the same at other numbers; all of them with CLRAY_LONG_TESTS=1.
template <class T>
std::vector<T> some(std::size_t count, std::initializer_list<T> cases) {
  return {cases.begin(), long_tests() ? cases.end() : cases.begin() + std::min(count, cases.size())};
}

}  // namespace clray_test
