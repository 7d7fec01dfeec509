// SPDX-License-Identifier: Apache-2.0
// The sums of a run as a file: to go on from after a crash or with a sharper target, to share a run among machines, and
// to check it elsewhere. Sums are integers, so parts add up to the bits of one run, whoever found them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clray/export.hpp"
#include "clray/trace.hpp"

CLRAY_API_BEGIN
namespace clray {

/// One of several shares of a run, numbered from 1.
struct Share {
  std::uint32_t number = 1;  ///< 1 to `of`
  std::uint32_t of = 1;      ///< how many there are
};

/// What trace() saves and goes on from.
struct Saving {
  std::string file;                    ///< where the sums are kept; it is replaced whole, or not at all
  double every_s = 30.0;               ///< while the run goes on; 0: only where it ends early
  bool keep = false;                   ///< also at the end of a whole run
  std::vector<std::string> note = {};  ///< kept in the file for whoever goes on, such as the command's words
  std::vector<std::string> from = {};  ///< files to go on from: one of the same run, or all shares of it
  Share share = {};                    ///< what to trace; the result of one of several shares has no records
};

/// What trace() says beside its result.
struct SavedRun {
  std::vector<std::string> note;  ///< that Saving gave it
  Share share;                    ///< that it holds
  bool complete = false;          ///< nothing is left to trace
};

/// Traces as trace() does, with the same bits, saving the sums. Throws Error(usage) for shares of a run whose end is
/// not known beforehand, and for files that do not belong together or to this scene; Error(input) for files that are
/// damaged, Error(output) where the sums cannot be written.
Result trace(const Scene& scene, Device& device, const TraceHooks& hooks, const Saving& saving);

/// What a file of sums says of itself. Throws Error(input).
SavedRun read_saved(const std::string& file);

/// Whether `file` holds sums of clray, by its first bytes.
bool is_saved(const std::string& file);

/// What verify() compared.
struct Verified {
  std::uint64_t ranges = 0;            ///< of a view's replicate, or of a view, in all
  std::uint64_t recomputed = 0;        ///< how many of them were computed again
  std::uint64_t numbers = 0;           ///< sums that were compared
  std::vector<std::string> different;  ///< what differs, in words; empty: nothing
};

/// Computes a random share (at least one of each pass) of a run's ranges again and compares their sums bit for bit.
Verified verify(const Scene& scene, Device& device, const std::string& file, double share, std::uint64_t seed,
                const TraceHooks& hooks = {});

}  // namespace clray
CLRAY_API_END
