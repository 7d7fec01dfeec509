// SPDX-License-Identifier: Apache-2.0
// The processes that mpirun started together, as the ranks of one run. Only this folder knows MPI, and only where clray
// is built with it (CLRAY_WITH_MPI).
#pragma once

#include <cstdint>
#include <memory>

#include "clray/ranks.hpp"

namespace clray::cluster {

/// The ranks of a job, from its beginning to its end. The last to go is told by rank 0: its destructor ends the
/// others'.
class Job : public Ranks {
 public:
  virtual std::uint32_t on_node() const = 0;  ///< 0 … of_node() - 1: the place among the ranks of this node
  virtual std::uint32_t of_node() const = 0;  ///< ranks of this node
  virtual std::uint64_t bytes() const = 0;    ///< that other ranks have sent to this one
};

/// The job of this process; null: it is alone. Called once, when signals are blocked and before threads ask. Throws
/// Error(usage) where mpirun started several processes and clray was built without MPI.
std::unique_ptr<Job> join_job();

/// How many ranks mpirun has started on this node, as the environment says, before anybody has joined.
std::uint32_t ranks_of_node();

#ifdef CLRAY_WITH_MPI
std::unique_ptr<Job> join_mpi_job();
#endif

}  // namespace clray::cluster
