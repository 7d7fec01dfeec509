// SPDX-License-Identifier: Apache-2.0
// See device_team.hpp.
#include "pipeline/device_team.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>

#include "clray/error.hpp"
#include "pipeline/clock.hpp"
#include "pipeline/traced_self_test.hpp"

namespace clray {
namespace {

constexpr double kSliceSeconds = 0.15;  // of a launch: an interrupt waits no longer
constexpr std::uint64_t kShares = 8;    // of each device in a block, at least: small runs are shared, too

/// Work-items of the first launch. They must be many enough to keep a GPU at work.
std::uint64_t first_slice(const OpenedDevice& opened, const PassPlan& plan) {
  if (in_packets(plan)) return 4;
  return opened.is_cpu()
             ? 4096
             : std::clamp<std::uint64_t>(16384 * std::uint64_t{opened.info.compute_units}, 4096, opened.most_items);
}

}  // namespace

void leave_out(Device::Impl* impl, OpenedDevice* opened, const Error& error) {
  opened->left_out = true;
  impl->notes.push_back(
      fmt::format("{} failed and is left out; the other devices do its share: {}", opened->info.name, error.message()));
}

/// Slices that lost members left come before those of the block.
struct DeviceTeam::Task {
  WorkSource& source;
  PointBlock block;
  const std::function<bool(double)>& keep_going;
  std::atomic<bool> go{true};
  std::exception_ptr failure{};
};

DeviceTeam::DeviceTeam(Device& device, const PassPlan& plan, const Geometry& geometry, const TraceOptions& options,
                       KeptPass* kept)
    : impl_(device.impl()), plan_(plan), options_(options) {
  const std::string name = "traced\n" + program_name("trace.cl", plan.program.options);
  KeptPass before = std::move(*kept);
  before.resize(impl_.devices.size());
  members_ = on_each_device(&impl_, [&](OpenedDevice& opened) {
    opened.test_once(name, [&] { run_traced_self_test(opened, plan, options.specialise); });
    std::shared_ptr<DevicePass>& pass = before[static_cast<std::size_t>(&opened - impl_.devices.data())];
    if (pass == nullptr || !pass->refill(plan, geometry)) {
      pass = std::make_shared<DevicePass>(opened, plan, geometry);
      pass->slice_items = first_slice(opened, plan);
    }
    return Member{&opened, pass, {}};
  });
  kept->assign(impl_.devices.size(), nullptr);
  for (const Member& m : members_) (*kept)[static_cast<std::size_t>(m.opened - impl_.devices.data())] = m.pass;
}

std::size_t DeviceTeam::alive() const {
  return static_cast<std::size_t>(
      std::count_if(members_.begin(), members_.end(), [](const Member& m) { return m.pass != nullptr; }));
}

bool DeviceTeam::others_take_over(Member* member, const Error& error) {
  if (error.code() != ErrorCode::device || alive() == 1) return false;
  leave_out(&impl_, member->opened, error);
  member->pass.reset();
  orphans_.insert(orphans_.end(), member->undrained.begin(), member->undrained.end());
  member->undrained.clear();
  return true;
}

template <class Act>
void DeviceTeam::each(const Act& act) {
  for (Member& member : members_) {
    if (member.pass == nullptr) continue;
    try {
      act(&member);
    } catch (const Error& error) {
      if (!others_take_over(&member, error)) throw;
    }
  }
}

void DeviceTeam::set_work(std::uint32_t epoch, const std::vector<std::uint32_t>& views) {
  each([&](Member* m) { m->pass->set_work(epoch, views); });
}

void DeviceTeam::clear() {
  orphans_.clear();
  for (Member& m : members_) m.undrained.clear();
  each([&](Member* m) { m->pass->clear(); });
}

bool DeviceTeam::run(WorkSource& work, const PointBlock& block, const std::function<bool(double)>& keep_going) {
  Task task{work, block, keep_going};
  return run(&task);
}

bool DeviceTeam::run(Task* task) {
  // A thread ends when nothing is left to take; what is lost after that is taken by the next ones.
  do {
    if (members_.size() == 1) {
      work(&members_.front(), task);
    } else {
      std::vector<std::thread> threads;
      for (Member& m : members_) {
        if (m.pass != nullptr) threads.emplace_back([this, &m, task] { work(&m, task); });
      }
      for (std::thread& thread : threads) thread.join();
    }
    if (task->failure) std::rethrow_exception(task->failure);
  } while (task->go && !orphans_.empty());
  return task->go;
}

void DeviceTeam::work(Member* member, Task* task) {
  const std::uint64_t fair = std::max<std::uint64_t>(1, task->source.items() / (kShares * members_.size()));
  try {
    while (task->go) {
      std::optional<Slice> slice;
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!orphans_.empty()) {
          slice = orphans_.back();
          orphans_.pop_back();
        }
      }
      const std::uint64_t most =
          members_.size() == 1 ? member->pass->slice_items : std::min(member->pass->slice_items, fair);
      if (!slice) {
        const std::optional<WorkRange> range = task->source.take(most);
        if (range) slice = Slice{*range, task->block};
      }
      if (!slice) return;
      trace(member, *slice);
      const std::lock_guard<std::mutex> lock(mutex_);
      const auto end = static_cast<double>(slice->range.first + slice->range.count);
      if (!task->keep_going(std::min(1.0, end / static_cast<double>(std::max<std::uint64_t>(task->source.items(), 1)))))
        task->go = false;
    }
  } catch (const Error& error) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (others_take_over(member, error)) return;
    task->failure = std::current_exception();
    task->go = false;
  } catch (...) {
    const std::lock_guard<std::mutex> lock(mutex_);
    task->failure = std::current_exception();
    task->go = false;
  }
}

void DeviceTeam::trace(Member* member, const Slice& slice) {
  const bool packets = in_packets(plan_);
  DevicePass& pass = *member->pass;
  if (members_.size() > 1) member->undrained.push_back(slice);
  const auto count = static_cast<std::uint32_t>(slice.range.count);
  const double start = now();
  pass.launch_items(slice.range.first, count, slice.block, packets ? 1 : options_.work_group_size);
  const double seconds = now() - start;
  const double factor = std::clamp(kSliceSeconds / std::max(seconds, 1e-6), 0.25, 4.0);
  if (count == pass.slice_items || factor < 1.0)
    pass.slice_items =
        std::clamp<std::uint64_t>(static_cast<std::uint64_t>(factor * count), packets ? 4 : 256, pass.most_items());
}

void DeviceTeam::drain(Sums* sums) {
  if (members_.size() == 1) {
    members_.front().pass->drain(sums);
    return;
  }
  const std::function<bool(double)> always = [](double) { return true; };
  for (;;) {
    each([&](Member* m) {
      if (m->undrained.empty()) return;
      Sums own(plan_.layout);  // a device may fail half-way
      m->pass->drain(&own);
      sums->add(plan_.layout, own);
      m->undrained.clear();
    });
    if (orphans_.empty()) return;
    OwnWork nothing(0);
    Task task{nothing, {}, always};
    run(&task);
  }
}

}  // namespace clray
