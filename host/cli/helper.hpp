// SPDX-License-Identifier: Apache-2.0
// The program as a rank of an MPI job that is not rank 0: it helps with the run, writes nothing and says nothing. What
// fails here is told to rank 0, which says it.
#pragma once

#include "cluster/job.hpp"
#include "kernel_folder.hpp"

namespace clray::cli {

/// Helps rank 0 with what the arguments ask for, until that is over. Never throws: rank 0 has the exit status.
void help_rank_0(int argc, char** argv, cluster::Job& job, KernelFolder& kernels) noexcept;

}  // namespace clray::cli
