// SPDX-License-Identifier: Apache-2.0
// toml++, compiled once (in toml_library.cpp) and only declared elsewhere.
#pragma once

#define TOML_HEADER_ONLY 0
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>
