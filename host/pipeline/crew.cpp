// SPDX-License-Identifier: Apache-2.0
// See crew.hpp.
#include "pipeline/crew.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "clray/error.hpp"

namespace clray {
namespace {

using std::chrono::microseconds;

constexpr microseconds kShortest(20), kLongest(500);  // between two looks for messages
constexpr std::chrono::milliseconds kAsk(20);         // between two questions whether to go on

}  // namespace

/// The items of a task: large ranges first, and small ones at the end, so that all are ready at the same time.
class Crew::Source : public WorkSource {
 public:
  Source(Crew& crew, std::uint64_t items) : WorkSource(items), crew_(crew) {}

  std::optional<WorkRange> take(std::uint64_t most) override {
    const std::lock_guard<std::mutex> lock(crew_.mutex_);
    return next(most);
  }
  std::optional<WorkRange> next(std::uint64_t most) {
    const std::uint64_t left = items() - next_;
    if (left == 0) return std::nullopt;
    const std::uint64_t fair = std::max<std::uint64_t>(1, left / (2 * std::uint64_t{crew_.count()}));
    const WorkRange range{next_, std::min(most, fair)};
    next_ += range.count;
    return range;
  }

 private:
  Crew& crew_;
  std::uint64_t next_ = 0;
};

Crew::Crew(Ranks& ranks, std::vector<std::uint64_t> fingerprints)
    : ranks_(ranks), fingerprints_(std::move(fingerprints)), members_(ranks.count()) {
  thread_ = std::thread([this] { answer(); });
}

Crew::~Crew() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
    ++task_;
    try {
      tell_all(CrewWord::over);
    } catch (...) {  // whoever cannot be told is no longer there
    }
  }
  thread_.join();
}

void Crew::tell_all(CrewWord word, const std::string& rest) {
  for (std::uint32_t rank = 1; rank < members_.size(); ++rank) {
    if (!members_[rank].gone) ranks_.send(rank, to_bytes(word, task_, rest));
  }
}

template <class Condition>
bool Crew::any(Condition condition) const {
  return std::any_of(members_.begin(), members_.end(), condition);
}

void Crew::rethrow() {
  if (failure_) std::rethrow_exception(failure_);
}

bool Crew::share(const CrewTask& task, const std::function<bool(WorkSource&)>& own,
                 const std::function<bool()>& keep_going) {
  Source source(*this, task.items);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    rethrow();
    ++task_;
    block_ = task.block;
    source_ = &source;
    tell_all(CrewWord::task, to_bytes(task));
  }
  struct End {  // nobody is given a range of a source that is gone
    Crew& crew;
    ~End() {
      const std::lock_guard<std::mutex> lock(crew.mutex_);
      crew.source_ = nullptr;
    }
  } end{*this};
  bool go = own(source);
  std::unique_lock<std::mutex> lock(mutex_);
  while (go && !failure_ && any([](const Member& m) { return m.busy; })) {
    if (changed_.wait_for(lock, kAsk) == std::cv_status::no_timeout) continue;
    lock.unlock();
    go = keep_going();
    lock.lock();
  }
  rethrow();
  return go;
}

std::vector<LostRange> Crew::collect(const SumLayout& layout, Sums* sums) {
  std::unique_lock<std::mutex> lock(mutex_);
  ++task_;
  layout_ = &layout;
  sums_ = sums;
  for (std::uint32_t rank = 1; rank < members_.size(); ++rank) {
    Member& member = members_[rank];
    if (member.not_had.empty()) continue;
    member.asked = true;
    ranks_.send(rank, to_bytes(CrewWord::hand_over, task_));
  }
  changed_.wait(lock, [&] { return failure_ || !any([](const Member& m) { return m.asked; }); });
  sums_ = nullptr;
  rethrow();
  return std::exchange(lost_, {});
}

void Crew::forget() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++task_;
  tell_all(CrewWord::forget);
  lost_.clear();
  for (Member& member : members_) {
    member.busy = false;
    member.not_had.clear();
  }
}

std::vector<std::string> Crew::notes() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return notes_;
}

void Crew::answer() {
  microseconds pause = kShortest;
  for (;;) {
    try {
      const std::optional<RankMessage> message = ranks_.receive();
      const std::lock_guard<std::mutex> lock(mutex_);
      if (over_) return;
      if (message) {
        take(*message);
        pause = kShortest;
        continue;
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      failure_ = std::current_exception();
      changed_.notify_all();
      return;
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, kLongest);
  }
}

void Crew::take(const RankMessage& message) {
  if (message.from == 0 || message.from >= members_.size()) return;
  Member& member = members_[message.from];
  if (member.gone) return;
  try {
    const CrewMessage m = message_of(message.bytes);
    switch (m.word) {
      case CrewWord::present:
        check_scene(message.from, m.rest);
        break;
      case CrewWord::ask:
        give_range(message.from, m);
        break;
      case CrewWord::done:
        if (m.task == task_) member.busy = false;
        break;
      case CrewWord::sums:
        if (m.task == task_ && member.asked && sums_ != nullptr) {
          const Sums more = sums_of(m.rest);
          if (!fits(more, *layout_)) throw Error(ErrorCode::bug, "its sums have other sizes");
          add_views(*layout_, more, sums_);
          member.not_had.clear();
          member.asked = false;
        }
        break;
      case CrewWord::failed:
        leave_out(message.from, m.rest);
        break;
      default:
        break;
    }
  } catch (const Error& error) {
    leave_out(message.from, error.what());
  }
  changed_.notify_all();
}

void Crew::give_range(std::uint32_t rank, const CrewMessage& message) {
  text::BytesReader in(message.rest, "a message between ranks");
  const std::uint64_t most = std::max<std::uint64_t>(in.number(), 1);
  std::optional<WorkRange> range;
  if (source_ != nullptr && message.task == task_) range = source_->next(most);
  if (range) {
    Member& member = members_[rank];
    member.busy = true;
    member.not_had.push_back({block_, *range});
  }
  ranks_.send(rank, to_bytes(CrewWord::range, message.task, to_bytes(range.value_or(WorkRange{}))));
}

void Crew::check_scene(std::uint32_t rank, const std::string& fingerprints) {
  text::BytesReader in(fingerprints, "a message between ranks");
  if (in.numbers<std::uint64_t>() != fingerprints_)
    leave_out(rank, "it has another scene, other options or another version of clray");
}

void Crew::leave_out(std::uint32_t rank, const std::string& why) {
  Member& member = members_[rank];
  member.gone = true;
  member.busy = member.asked = false;
  lost_.insert(lost_.end(), member.not_had.begin(), member.not_had.end());
  member.not_had.clear();
  notes_.push_back("rank " + std::to_string(rank) + " is left out, and the others do its share: " + why);
  ranks_.send(rank, to_bytes(CrewWord::over, task_));
}

}  // namespace clray
