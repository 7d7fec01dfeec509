// SPDX-License-Identifier: Apache-2.0
// See frontier.hpp.
#include "exact/frontier.hpp"

#include <algorithm>
#include <numeric>

namespace clray {
namespace {

constexpr std::uint32_t kMostLevels = 40;  // of cuts: smaller tiles are within the rounding of corners

}  // namespace

Frontier::Frontier(const BeamFaces& beam, std::function<bool(std::uint32_t)> shines)
    : seen_(beam), shines_(std::move(shines)) {
  std::vector<std::uint32_t> all(beam.faces.size());
  std::iota(all.begin(), all.end(), 0u);
  if (!all.empty()) add({beam.x0, beam.x1, beam.y0, beam.y1}, all, 0, &mixed_);
}

void Frontier::add(const Rectangle& at, const std::vector<std::uint32_t>& faces, std::uint32_t level,
                   std::vector<Tile>* mixed) {
  Tile tile{at, {}, level};
  seen_.keep(at, faces, &tile.faces);
  if (std::none_of(tile.faces.begin(), tile.faces.end(), shines_)) return;
  const bool covered = tile.faces.size() == 1 && seen_.covers(tile.faces.front(), at);
  (covered ? &covered_ : mixed)->push_back(std::move(tile));
}

bool Frontier::cut(const std::vector<double>& spread, std::size_t count) {
  std::vector<std::uint32_t> order(mixed_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t i, std::uint32_t k) { return spread[i] != spread[k] ? spread[i] > spread[k] : i < k; });
  std::vector<Tile> parts;
  std::vector<bool> gone(mixed_.size(), false);
  std::size_t left = mixed_.size();
  for (const std::uint32_t k : order) {
    if (left + parts.size() >= count) break;
    const Tile& tile = mixed_[k];
    if (tile.level == kMostLevels) continue;
    for (const Rectangle& quarter : tile.at.quarters()) add(quarter, tile.faces, tile.level + 1, &parts);
    gone[k] = true;
    --left;
  }
  if (left == mixed_.size()) return false;
  std::vector<Tile> next;
  next.reserve(left + parts.size());
  for (std::size_t k = 0; k < mixed_.size(); ++k) {
    if (!gone[k]) next.push_back(std::move(mixed_[k]));
  }
  std::move(parts.begin(), parts.end(), std::back_inserter(next));
  mixed_ = std::move(next);
  return true;
}

}  // namespace clray
