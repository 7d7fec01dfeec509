// SPDX-License-Identifier: Apache-2.0
// See shares.hpp.
#include "pipeline/shares.hpp"

#include "pipeline/pass_buffers.hpp"

namespace clray {
namespace {

/// How many of `all` belong to the first `shares` of `of` shares.
std::uint64_t part(std::uint64_t all, std::uint32_t shares, std::uint32_t of) {
  return static_cast<std::uint64_t>(static_cast<unsigned __int128>(all) * shares / of);
}

OpenStep range(std::uint64_t all, const Share& share) {
  OpenStep step;
  step.from = part(all, share.number - 1, share.of);
  step.points = part(all, share.number, share.of);
  return step;
}

}  // namespace

OpenStep views_of_share(const PassPlan& plan, const Share& share) {
  return range(plan.beams.views.size(), share);
}

OpenStep share_of(const PassPlan& plan, const Share& share, std::uint64_t points) {
  if (!plan.request.tiles()) {
    OpenStep step = range(points, share);
    if (step.from < step.points) step.views = all_views(plan);
    return step;
  }
  const OpenStep views = views_of_share(plan, share);
  OpenStep step;
  step.points = points;
  for (std::uint64_t v = views.from; v < views.points; ++v) step.views.push_back(static_cast<std::uint32_t>(v));
  return step;
}

}  // namespace clray
