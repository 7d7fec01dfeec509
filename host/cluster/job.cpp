// SPDX-License-Identifier: Apache-2.0
// See job.hpp. Whether mpirun (or srun) has started this process stands in its environment: to start MPI in a process
// alone would take a tenth of a second.
#include "cluster/job.hpp"

#include <cstdlib>

#include "clray/error.hpp"

namespace clray::cluster {
namespace {

/// A number of the environment; 0: none.
std::uint32_t number_of(const char* variable) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10)) : 0;
}

}  // namespace

std::uint32_t ranks_of_node() {
  const std::uint32_t ranks = number_of("OMPI_COMM_WORLD_LOCAL_SIZE");
  return ranks > 0 ? ranks : 1;
}

std::unique_ptr<Job> join_job() {
#ifdef CLRAY_WITH_MPI
  if (std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr && std::getenv("PMIX_RANK") == nullptr) return nullptr;
  std::unique_ptr<Job> job = join_mpi_job();
  if (job->count() == 1) return nullptr;
  return job;
#else
  if (number_of("OMPI_COMM_WORLD_SIZE") > 1)
    throw Error(ErrorCode::usage,
                "mpirun started several processes, but this clray was built without MPI: each would do the whole run; "
                "build it with -DCLRAY_WITH_MPI=ON, or give each a share with --shard and no mpirun");
  return nullptr;
#endif
}

}  // namespace clray::cluster
