// SPDX-License-Identifier: Apache-2.0
// A run as data: what its passes have found so far, and how far they are. Knows nothing of what the sums mean.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "body/geometry.hpp"
#include "clray/result.hpp"
#include "clray/saved.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/sums.hpp"
#include "text/bytes.hpp"

namespace clray {

/// The error of a view after a step of its course.
struct StepNote {
  std::uint32_t view = 0, epoch = 0;
  std::uint64_t points = 0;
  double error = 0.0;  ///< relative, see Course::took()
};

/// A step that is not finished: which, how far it is, and what that brought.
struct OpenStep {
  std::uint32_t epoch = 0;
  std::uint64_t from = 0, points = 0;
  std::vector<std::uint32_t> views;
  std::uint64_t done = 0;  ///< points, or views where each is found anew
  Sums more;               ///< of what is done; without views: nothing is

  bool is_same(const OpenStep& other) const {
    return epoch == other.epoch && from == other.from && points == other.points && views == other.views;
  }
};

/// What a pass has found.
struct SavedPass {
  std::uint64_t fingerprint = 0;  ///< of its plan; 0: not known yet
  bool complete = false;
  std::vector<std::uint64_t> first;   ///< of each view: the point with which `found` begins; empty: 0
  Sums found, confirmed;              ///< of the first epoch; of the last confirmations
  std::vector<std::uint32_t> epochs;  ///< of each view's confirmation
  std::vector<StepNote> notes;
  std::vector<ErrorPoint> errors;
  double search_s = 0.0, confirm_s = 0.0;  ///< spent
  OpenStep step;
};

/// What a run has found, in the order of its passes; the first bounce of a pass stands before it.
struct SavedSums {
  std::vector<std::string> note;
  Share share;
  std::vector<SavedPass> passes;
};

/// The passes of a run in their order.
std::vector<const PassPlan*> passes_of(const std::vector<PassPlan>& plans);

/// What decides a pass's sums: every number that kernels are given, the layout, and the kernels. Neither the device nor
/// the tree nor when to stop is among it.
std::uint64_t fingerprint_of(const PassPlan& plan, const Geometry& geometry);

/// Sums as bytes, in a file or a message, and back. Throws Error(input) for what cannot be.
void put(text::BytesWriter& out, const Sums& sums);
Sums get_sums(text::BytesReader& in);

/// What a file begins with.
constexpr std::string_view kSavedMagic = "clray sums\n";

/// A file of sums, with a version and a checksum, given to `put` a block at a time: sums may take gigabytes.
void write_sums(const SavedSums& sums, const std::function<void(std::string_view)>& put);
/// Reads a file of sums of `size` bytes, of which `get(where, count)` puts the next ones somewhere. Throws Error(input,
/// name) for bytes of something else, of another version, or damaged ones, and takes no more memory than these ask for.
SavedSums read_sums(std::uint64_t size, const std::function<void(char*, std::size_t)>& get, const std::string& name);

/// The same to and from bytes in memory.
std::string to_bytes(const SavedSums& sums);
SavedSums from_bytes(std::string_view bytes, const std::string& name);

/// The same from a file. Throws Error(input, file).
SavedSums read_sums_file(const std::string& file);

/// Whether sums have the sizes of a layout: what a file claims need not fit.
bool fits(const Sums& sums, const SumLayout& layout);

/// One run of all its shares. `layouts`: of each pass. Throws Error(usage) with a reason where they do not belong
/// together.
SavedSums merged(std::vector<SavedSums> shares, const std::vector<std::string>& names,
                 const std::vector<const SumLayout*>& layouts);

}  // namespace clray
