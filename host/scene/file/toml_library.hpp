// SPDX-License-Identifier: Apache-2.0
// toml++, compiled once (in toml_library.cpp) and only declared elsewhere. Its parser asserts what its own error paths
// then report (version 3.3: "[=" asserts that a key begins with a letter, and then says that it does not). So bad input
// would end a debug build. Without assertions and assumptions every build reports it.
#pragma once

#define TOML_HEADER_ONLY 0
#define TOML_ENABLE_FORMATTERS 0
#define TOML_MAX_NESTED_VALUES 16
#pragma push_macro("NDEBUG")
#undef NDEBUG  // else TOML_ASSERT is replaced, and some compilers take the conditions for granted
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")
