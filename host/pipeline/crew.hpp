// SPDX-License-Identifier: Apache-2.0
// The processes of a run (clray/ranks.hpp), as rank 0 sees them. It alone follows the courses; the others are given
// ranges of its steps and hand over their sums when a step ends or is saved. A thread answers them, so that nobody
// waits while rank 0 traces. Sums are integers: nobody can tell who did what. crew_member.hpp is the other side.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "clray/ranks.hpp"
#include "pipeline/crew_messages.hpp"

namespace clray {

/// A range whose sums are lost with the process that had it.
struct LostRange {
  PointBlock block;
  WorkRange range;
};

class Crew {
 public:
  /// `fingerprints`: of the passes, by their numbers; a rank that has others is left out.
  Crew(Ranks& ranks, std::vector<std::uint64_t> fingerprints);
  /// Tells all that the run is over.
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  std::uint32_t count() const { return ranks_.count(); }
  /// Shares a task: `own` does this process's part of it, `keep_going` is asked while others are not ready. False where
  /// one of the two says no.
  bool share(const CrewTask& task, const std::function<bool(WorkSource&)>& own,
             const std::function<bool()>& keep_going);
  /// Adds what the others have found since the last time to *sums (points of views, too). Returns what must be done
  /// again, since its process is left out.
  std::vector<LostRange> collect(const SumLayout& layout, Sums* sums);
  /// All forget what they have found since the last time.
  void forget();
  /// A sentence for each rank that was left out.
  std::vector<std::string> notes();

 private:
  class Source;
  struct Member {
    bool gone = false;               // left out
    bool busy = false;               // with a range of this task
    bool asked = false;              // for its sums
    std::vector<LostRange> not_had;  // ranges whose sums are not here yet
  };

  void answer();
  void take(const RankMessage& message);
  void give_range(std::uint32_t rank, const CrewMessage& message);
  void check_scene(std::uint32_t rank, const std::string& fingerprints);
  void leave_out(std::uint32_t rank, const std::string& why);
  void tell_all(CrewWord word, const std::string& rest = {});
  template <class Condition>
  bool any(Condition condition) const;
  void rethrow();

  Ranks& ranks_;
  const std::vector<std::uint64_t> fingerprints_;
  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::vector<Member> members_;  // by rank; that of this process is unused
  std::vector<LostRange> lost_;
  std::vector<std::string> notes_;
  std::uint64_t task_ = 0;    // number of the last one
  Source* source_ = nullptr;  // of the task, while it is shared
  PointBlock block_;          // of the task
  const SumLayout* layout_ = nullptr;
  Sums* sums_ = nullptr;  // what is handed over is added here
  std::exception_ptr failure_;
  bool over_ = false;
  std::thread thread_;  // last: it needs all others
};

/// How a pass is shared: with whom, and its number; without a crew it is not.
struct SharedPass {
  Crew* crew = nullptr;
  std::uint32_t number = 0;
};

}  // namespace clray
