// SPDX-License-Identifier: Apache-2.0
// Processes that trace one run together, such as the ranks of an MPI job. The library asks for messages and knows
// nothing of what carries them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "clray/export.hpp"
#include "clray/saved.hpp"
#include "clray/trace.hpp"

CLRAY_API_BEGIN
namespace clray {

/// What one process tells another.
struct RankMessage {
  std::uint32_t from = 0;  ///< the rank that sent it
  std::string bytes;       ///< as they were sent
};

/// The processes of a run, as one of them sees them. Any thread may call any member, and none of them waits. Messages
/// from one rank to another arrive in the order in which they were sent.
class Ranks {
 public:
  virtual ~Ranks() = default;

  /// Of this process: 0 … count() - 1. Rank 0 has the result.
  virtual std::uint32_t number() const = 0;
  /// How many processes there are.
  virtual std::uint32_t count() const = 0;
  /// Sends a message to rank `to`.
  virtual void send(std::uint32_t to, const std::string& bytes) = 0;
  /// The next message to this process; none: none is here yet.
  virtual std::optional<RankMessage> receive() = 0;
};

/// Traces as trace() with a Saving does, with the same bits: every rank calls it with the same scene and devices of its
/// own. Rank 0 has the result, the files of sums and the callbacks; of the others `saving` is not read, the result is
/// empty, and the call returns when rank 0 has its own. A rank that fails, or has another scene, is left out with a
/// warning. Throws what trace() throws.
Result trace(const Scene& scene, Device& device, const TraceHooks& hooks, const Saving& saving, Ranks& ranks);

/// Tells rank 0, which may be tracing, that this rank cannot take part, and why.
void leave_run(Ranks& ranks, const std::string& why);

}  // namespace clray
CLRAY_API_END
