// SPDX-License-Identifier: Apache-2.0
// Time limits of tests are for optimised programs. Under the address sanitizer (scripts/check asan) they are longer.
#pragma once

namespace clray::test {

#ifndef __has_feature
#define __has_feature(x) 0
#endif
#if __has_feature(address_sanitizer)
constexpr double kPatience = 20.0;
#else
constexpr double kPatience = 1.0;
#endif

}  // namespace clray::test
