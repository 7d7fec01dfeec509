// SPDX-License-Identifier: Apache-2.0
// See crew_member.hpp.
#include "pipeline/crew_member.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "clray/error.hpp"
#include "pipeline/crew_messages.hpp"
#include "pipeline/device_team.hpp"
#include "pipeline/exact_pass.hpp"
#include "pipeline/saved_sums.hpp"
#include "pipeline/tiles_runner.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

using std::chrono::microseconds;

/// Waits between two looks for messages, longer and longer.
class Wait {
 public:
  void operator()() {
    std::this_thread::sleep_for(now_);
    now_ = std::min(2 * now_, microseconds(500));
  }

 private:
  microseconds now_{20};
};

/// What rank 0 has said. Any thread may look.
class Inbox {
 public:
  explicit Inbox(Ranks& ranks) : ranks_(ranks) {}

  /// The next thing to do.
  CrewMessage next() {
    for (Wait wait;; wait()) {
      look();
      const std::lock_guard<std::mutex> lock(mutex_);
      if (orders_.empty()) continue;
      CrewMessage order = std::move(orders_.front());
      orders_.pop_front();
      return order;
    }
  }
  /// Whether the task is still wanted.
  bool wants(std::uint64_t task) {
    look();
    return task >= wanted_;
  }
  /// A range of the task; none: nothing is left, or it is not wanted any more.
  std::optional<WorkRange> ask(std::uint64_t task, std::uint64_t most) {
    const std::lock_guard<std::mutex> one_at_a_time(asking_);
    text::BytesWriter number;
    number.number(most);
    ranks_.send(0, to_bytes(CrewWord::ask, task, number.bytes()));
    for (Wait wait; wants(task); wait()) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!range_) continue;
      const WorkRange range = *range_;
      range_.reset();
      if (range.count == 0) return std::nullopt;
      return range;
    }
    return std::nullopt;
  }

 private:
  void look() {
    const std::lock_guard<std::mutex> lock(mutex_);
    while (const std::optional<RankMessage> message = ranks_.receive()) {
      CrewMessage m = message_of(message->bytes);
      if (m.word == CrewWord::range) {
        if (m.task >= wanted_) range_ = range_of(m.rest);
        continue;
      }
      if (m.word == CrewWord::forget) wanted_ = m.task;
      if (m.word == CrewWord::over) wanted_ = ~std::uint64_t{0};
      if (m.word == CrewWord::forget || m.word == CrewWord::over) range_.reset();
      orders_.push_back(std::move(m));
    }
  }

  Ranks& ranks_;
  std::mutex mutex_, asking_;
  std::deque<CrewMessage> orders_;
  std::optional<WorkRange> range_;
  std::atomic<std::uint64_t> wanted_{0};  // older tasks are not
};

/// The items that rank 0 gives.
class GivenWork : public WorkSource {
 public:
  GivenWork(Inbox& inbox, std::uint64_t task, std::uint64_t items) : WorkSource(items), inbox_(inbox), task_(task) {}

  std::optional<WorkRange> take(std::uint64_t most) override { return inbox_.ask(task_, most); }

 private:
  Inbox& inbox_;
  const std::uint64_t task_;
};

class CrewMember {
 public:
  CrewMember(Ranks& ranks, Device& device, const std::vector<const PassPlan*>& passes, const Geometry& geometry,
             const TraceOptions& options)
      : ranks_(ranks), inbox_(ranks), device_(device), passes_(passes), geometry_(geometry), options_(options) {}

  void help() {
    std::vector<std::uint64_t> fingerprints;
    for (const PassPlan* plan : passes_) fingerprints.push_back(fingerprint_of(*plan, geometry_));
    text::BytesWriter out;
    out.numbers(fingerprints);
    ranks_.send(0, to_bytes(CrewWord::present, 0, out.bytes()));
    for (;;) {
      const CrewMessage order = inbox_.next();
      if (order.word == CrewWord::over) return;
      if (failed_) continue;
      try {
        take(order);
      } catch (const Error& error) {
        failed_ = true;
        leave_run(ranks_, error.what());
      }
    }
  }

 private:
  void take(const CrewMessage& order) {
    if (order.word == CrewWord::task && inbox_.wants(order.task)) {
      CrewTask task = task_of(order.rest);
      if (task.pass >= passes_.size()) throw Error(ErrorCode::bug, "there is no such pass");
      if (!plan_ || plan_ != passes_[task.pass]) begin(passes_[task.pass]);
      GivenWork work(inbox_, order.task, task.items);
      if (task.rays) {
        trace(order.task, task, work);
      } else {
        take_views(order.task, task, work);
      }
      ranks_.send(0, to_bytes(CrewWord::done, order.task));
    } else if (order.word == CrewWord::hand_over) {
      ranks_.send(0, to_bytes(CrewWord::sums, order.task, to_bytes(found())));
    } else if (order.word == CrewWord::forget) {
      if (team_) team_->clear();
      views_.reset();
    }
  }

  void begin(const PassPlan* plan) {
    team_.reset();
    runner_.reset();
    plan_ = plan;
  }

  void trace(std::uint64_t number, const CrewTask& task, WorkSource& work) {
    if (!team_) {
      kept_.clear();
      const PassPlan* plan = plan_;
      if (static_cast<std::uint32_t>(plan->program.options.walk) != task.block.walk) {
        as_rank_0_ = *plan;
        set_walk(table("walk").at(task.block.walk).name, &*as_rank_0_);
        plan = &*as_rank_0_;
      }
      team_ = std::make_unique<DeviceTeam>(device_, *plan, geometry_, options_, &kept_);
    }
    team_->set_work(task.step.epoch, task.step.views);
    team_->run(work, task.block, [&](double) { return inbox_.wants(number); });
  }

  void take_views(std::uint64_t number, const CrewTask& task, WorkSource& work) {
    if (!runner_ && plan_->request.exact()) runner_ = std::make_unique<ExactPass>(device_, *plan_, geometry_);
    if (!runner_) runner_ = std::make_unique<TilesRunner>(device_, *plan_, geometry_);
    while (const std::optional<WorkRange> range = work.take(task.items)) {
      OpenStep part = part_of(task.step, *range);
      Sums sums(plan_->layout);
      if (!runner_->run(&sums, &part, [&](double) { return inbox_.wants(number); }, {})) return;
      if (!views_) views_.emplace(plan_->layout);
      add_views(plan_->layout, sums, &*views_);
    }
  }

  /// What was found since it was last asked for.
  Sums found() {
    Sums sums(plan_->layout);
    if (team_) team_->drain(&sums);
    if (views_) sums = std::move(*views_);
    views_.reset();
    return sums;
  }

  Ranks& ranks_;
  Inbox inbox_;
  Device& device_;
  const std::vector<const PassPlan*>& passes_;
  const Geometry& geometry_;
  const TraceOptions& options_;
  const PassPlan* plan_ = nullptr;     // of the pass at work
  std::optional<PassPlan> as_rank_0_;  // where its walk is another: ranges of work-items have one meaning
  KeptPass kept_;
  std::unique_ptr<DeviceTeam> team_;
  std::unique_ptr<PointRunner> runner_;
  std::optional<Sums> views_;
  bool failed_ = false;
};

}  // namespace

void help_with_run(Ranks& ranks, Device& device, const std::vector<const PassPlan*>& passes, const Geometry& geometry,
                   const TraceOptions& options) {
  CrewMember(ranks, device, passes, geometry, options).help();
}

void leave_run(Ranks& ranks, const std::string& why) {
  if (ranks.number() != 0) return ranks.send(0, to_bytes(CrewWord::failed, 0, why));
  for (std::uint32_t rank = 1; rank < ranks.count(); ++rank) ranks.send(rank, to_bytes(CrewWord::over, 0));
}

}  // namespace clray
