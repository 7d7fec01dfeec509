// SPDX-License-Identifier: Apache-2.0
// See shared_views.hpp. A step goes in rounds, behind each of which its sums can be saved.
#include "pipeline/shared_views.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/clock.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kFirstRound = 4;  // views of each process

}  // namespace

SharedViews::SharedViews(std::unique_ptr<PointRunner> own, const PassPlan& plan, const SharedPass& shared)
    : own_(std::move(own)), plan_(plan), shared_(shared), round_(kFirstRound * shared.crew->count()) {
  compile_seconds_ = own_->compile_seconds();
}

bool SharedViews::run(Sums* sums, OpenStep* step, const std::function<bool(double)>& keep_going,
                      const Checkpoint& checkpoint) {
  const std::uint64_t all = views_of(*step);
  if (step->more.points.empty()) step->more = Sums(plan_.layout);
  while (step->done < all) {
    const std::uint64_t most = checkpoint.every_s > 0.0 ? round_ : all;
    const WorkRange range{step->done, std::min(most, all - step->done)};
    CrewTask task;
    task.pass = shared_.number;
    task.rays = false;
    task.step = part_of(*step, range);
    task.items = range.count;
    const double start = now();
    Sums found(plan_.layout);
    const auto ask = [&](double share) {
      return keep_going((static_cast<double>(range.first) + share * static_cast<double>(range.count)) /
                        static_cast<double>(all));
    };
    if (!run_round(task, &found, ask)) {
      shared_.crew->forget();
      return false;
    }
    add_views(plan_.layout, found, &step->more);
    step->done += range.count;
    if (now() - start < checkpoint.every_s / 8) round_ *= 2;
    if (now() - start > checkpoint.every_s / 2) round_ = std::max<std::uint64_t>(round_ / 2, shared_.crew->count());
    if (step->done < all && checkpoint.due && checkpoint.due()) checkpoint.save();
  }
  if (step->views.empty()) {
    *sums = std::move(step->more);
  } else {
    for (const std::uint32_t v : step->views) sums->set_view(plan_.layout, v, &step->more);
  }
  return true;
}

bool SharedViews::run_round(const CrewTask& task, Sums* found, const std::function<bool(double)>& keep_going) {
  const auto own = [&](WorkSource& work) {
    while (const std::optional<WorkRange> range = work.take(task.items)) {
      OpenStep part = part_of(task.step, *range);
      Sums sums(plan_.layout);
      const double done = static_cast<double>(range->first) / static_cast<double>(task.items);
      if (!own_->run(&sums, &part, [&](double) { return keep_going(done); }, {})) return false;
      add_views(plan_.layout, sums, found);
    }
    return true;
  };
  if (!shared_.crew->share(task, own, [&] { return keep_going(1.0); })) return false;
  for (auto lost = shared_.crew->collect(plan_.layout, found); !lost.empty();
       lost = shared_.crew->collect(plan_.layout, found)) {
    for (const LostRange& one : lost) {
      OwnWork work(one.range.first + one.range.count, one.range.first);
      if (!own(work)) return false;
    }
  }
  return true;
}

}  // namespace clray
