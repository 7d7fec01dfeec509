// SPDX-License-Identifier: Apache-2.0
// PoCL's variables; see environment.hpp.
#include "environment.hpp"

#include <sched.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "cluster/job.hpp"

namespace clray::cli {

namespace {

/// The cores that mpirun has bound this process to, or its share of all.
std::uint32_t cores_of_rank(std::uint32_t ranks) {
  cpu_set_t bound;
  const auto all = static_cast<std::uint32_t>(std::max(1l, ::sysconf(_SC_NPROCESSORS_ONLN)));
  if (::sched_getaffinity(0, sizeof bound, &bound) == 0) {
    const auto own = static_cast<std::uint32_t>(CPU_COUNT(&bound));
    if (own < all) return own;
  }
  return std::max(1u, all / ranks);
}

}  // namespace

Environment::Environment() {
  ::setenv("POCL_SIGFPE_HANDLER", "0", 1);
  ::setenv("POCL_CACHE_DIR", kernels_.path().c_str(), 1);
  if (const std::uint32_t ranks = cluster::ranks_of_node(); ranks > 1)
    ::setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(cores_of_rank(ranks)).c_str(), 0);
}

}  // namespace clray::cli
