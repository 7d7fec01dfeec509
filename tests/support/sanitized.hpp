// SPDX-License-Identifier: Apache-2.0
// Whether sanitizers watch this program: it then takes several times the time and memory.
#pragma once

namespace clray_test {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif
#else
constexpr bool kSanitized = false;
#endif

}  // namespace clray_test
