// SPDX-License-Identifier: Apache-2.0
// Direction numbers of the Sobol sequence for kernels/math/sobol.cl.
#pragma once

#include <cstdint>
#include <vector>

namespace clray {

/// 64 dimensions × 32 direction numbers, each with its bits reversed (Joe & Kuo 2008, new-joe-kuo-6.21201).
std::vector<std::uint32_t> sobol_directions_reversed();

}  // namespace clray
