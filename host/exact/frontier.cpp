// SPDX-License-Identifier: Apache-2.0
// See frontier.hpp.
#include "exact/frontier.hpp"

#include <algorithm>
#include <numeric>

namespace clray {
namespace {

constexpr std::uint32_t kMostLevels = 41;  // the whole is the first: smaller tiles are within the rounding of corners

}  // namespace

Frontier::Frontier(const BeamFaces& beam, const Shadows* shadows, std::function<bool(std::uint32_t)> shines)
    : seen_(beam), shadows_(shadows), shines_(std::move(shines)) {
  Tile all;
  all.faces.resize(beam.faces.size());
  std::iota(all.faces.begin(), all.faces.end(), 0u);
  if (shadows != nullptr) all.blockers = shadows->blockers();
  if (!all.faces.empty()) add({beam.x0, beam.x1, beam.y0, beam.y1}, all, &mixed_);
}

/// Adds a part of a tile, where anything that shines may be seen in it.
void Frontier::add(const Rectangle& at, const Tile& whole, std::vector<Tile>* mixed) {
  Tile tile{at, {}, {}, whole.level + 1};
  seen_.keep(at, whole.faces, &tile.faces);
  std::vector<std::uint32_t> shining;
  std::copy_if(tile.faces.begin(), tile.faces.end(), std::back_inserter(shining), shines_);
  if (shining.empty()) return;
  if (shadows_ != nullptr && !shadows_->keep(at, shining, whole.blockers, &tile.blockers)) return;
  const bool covered = tile.faces.size() == 1 && tile.blockers.empty() && seen_.covers(tile.faces.front(), at);
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
    for (const Rectangle& quarter : tile.at.quarters()) add(quarter, tile, &parts);
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
