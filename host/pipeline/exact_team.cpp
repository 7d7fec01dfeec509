// SPDX-License-Identifier: Apache-2.0
// See exact_team.hpp.
#include "pipeline/exact_team.hpp"

#include "clray/error.hpp"
#include "pipeline/device_team.hpp"
#include "pipeline/exact_sights.hpp"

namespace clray {

ExactTeam::ExactTeam(Device& device, const PassPlan& plan, std::uint64_t bins) : impl_(device.impl()), bins_(bins) {
  members_ = on_each_device(&impl_, [&](OpenedDevice& opened) {
    return Member{&opened, std::make_unique<ExactDevice>(opened, plan.program.options, exact_numbers(plan), bins)};
  });
}

template <class Act>
void ExactTeam::with(std::size_t member, const Act& act) {
  try {
    act(*members_[member].device);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::device || members_.size() == 1) throw;
    leave_out(&impl_, members_[member].opened, error);
    members_.erase(members_.begin() + static_cast<std::ptrdiff_t>(member));
    next_ = 0;
    throw Lost();
  }
}

void ExactTeam::begin(const FaceGroup& group, const std::vector<BinRow>& rows) {
  for (std::size_t m = 0; m < members_.size(); ++m)
    with(m, [&](ExactDevice& device) { device.begin_group(group, rows); });
}

void ExactTeam::launch(ItemBatch* batch) {
  with(next_, [&](ExactDevice& device) { device.launch_batch(batch); });
  next_ = (next_ + 1) % members_.size();
}

void ExactTeam::end(const FaceGroup& group, const std::vector<BinRow>& rows, Found* found) {
  Found all;
  all.sums.resize(group.faces.size() * CLRAY_FACE_SUMS);
  std::vector<std::vector<i64>> bins;
  for (const BinRow& row : rows) bins.emplace_back(row.count);
  for (std::size_t m = 0; m < members_.size(); ++m)
    with(m, [&](ExactDevice& device) { device.end_group(&all.sums, &all.lit, &bins); });
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t k = 0; k < rows[r].count; ++k) bins_[rows[r].first + k] += bins[r][k];
  }
  *found = std::move(all);
}

}  // namespace clray
