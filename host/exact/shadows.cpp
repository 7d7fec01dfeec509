// SPDX-License-Identifier: Apache-2.0
// See shadows.hpp.
#include "exact/shadows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "exact/portable_faces.hpp"

namespace clray {
namespace {

constexpr double kRounding = 1e-15;       // of sides and depths, relative
constexpr std::size_t kFewFaces = 4;      // of a tile: it is asked whether all of them are in shadow
constexpr std::size_t kMostPairs = 4096;  // of faces and blockers that are held against each other

/// A side of a face's edge on which a place lies: positive inside, times the edge's length; and what rounding may do.
struct Side {
  double at, tiny;
};

Side side_of(const ClrayFace& f, int edge, double x, double y, double off) {
  const int next = edge == 2 ? 0 : edge + 1;
  const double dx = f.x[next] - f.x[edge], dy = f.y[next] - f.y[edge];
  return {dx * (y - f.y[edge]) - dy * (x - f.x[edge]), off * (std::fabs(dx) + std::fabs(dy))};
}

double depth_at(const ClrayFace& f, double x, double y) {
  return f.depth0 + f.slope_x * (x - f.x[0]) + f.slope_y * (y - f.y[0]);
}

double depth_error(const ClrayFace& f, double off) {
  return off * (1.0 + std::fabs(f.slope_x) + std::fabs(f.slope_y));
}

}  // namespace

Shadows::Shadows(const BeamFaces& seen, const BeamFaces& lit) : seen_(seen), lit_(lit) {
  const Carrier carrier(seen, lit);
  carried_.reserve(seen.faces.size());
  for (std::uint32_t k = 0; k < seen.faces.size(); ++k) carried_.push_back(carrier.steps(k));
}

std::vector<std::uint32_t> Shadows::blockers() const {
  std::vector<std::uint32_t> all(lit_.faces.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

Shadows::Patch Shadows::patch(std::uint32_t face, const Rectangle& r) const {
  const ClrayCarried& c = carried_[face];
  const ClrayFace &f = seen_.faces[face], &own = lit_.faces[c.there];
  const double x[2] = {std::max(r.x0, f.box[0]) - f.x[0], std::min(r.x1, f.box[1]) - f.x[0]};
  const double y[2] = {std::max(r.y0, f.box[2]) - f.y[0], std::min(r.y1, f.box[3]) - f.y[0]};
  Patch p;
  p.own = c.there;
  p.error = kRounding * lit_.size + carried_error(c, lit_.size);
  for (int k = 0; k < 4; ++k) {
    const double dx = x[k & 1], dy = y[k >> 1];
    p.x[k] = own.x[0] + c.xx * dx + c.xy * dy;
    p.y[k] = own.y[0] + c.yx * dx + c.yy * dy;
    p.depth[k] = depth_at(own, p.x[k], p.y[k]);
  }
  // The face itself ends where its box does.
  p.x0 = std::max(*std::min_element(p.x, p.x + 4) - p.error, own.box[0]);
  p.x1 = std::min(*std::max_element(p.x, p.x + 4) + p.error, own.box[1]);
  p.y0 = std::max(*std::min_element(p.y, p.y + 4) - p.error, own.box[2]);
  p.y1 = std::min(*std::max_element(p.y, p.y + 4) + p.error, own.box[3]);
  p.farthest = *std::min_element(p.depth, p.depth + 4) - depth_error(own, p.error) - own.margin;
  return p;
}

bool Shadows::may_shade(std::uint32_t blocker, const Patch& p) const {
  const ClrayFace &b = lit_.faces[blocker], &own = lit_.faces[p.own];
  if (blocker == p.own || b.box[0] > p.x1 || b.box[1] < p.x0 || b.box[2] > p.y1 || b.box[3] < p.y0 ||
      b.nearest + b.margin < p.farthest)
    return false;
  for (int edge = 0; edge < 3; ++edge) {
    int outside = 0;
    for (int k = 0; k < 4; ++k) {
      const Side side = side_of(b, edge, p.x[k], p.y[k], p.error);
      outside += side.at < -side.tiny ? 1 : 0;
    }
    if (outside == 4) return false;
  }
  const double margin = b.margin + own.margin + depth_error(b, p.error) + depth_error(own, p.error);
  double gap = -HUGE_VAL;  // planes are linear, so the corners decide
  for (int k = 0; k < 4; ++k) gap = std::max(gap, depth_at(b, p.x[k], p.y[k]) - p.depth[k]);
  return gap > -margin && face_may_hide(b, own, lit_.margin);
}

bool Shadows::shades_all(std::uint32_t blocker, const Patch& p) const {
  const ClrayFace &b = lit_.faces[blocker], &own = lit_.faces[p.own];
  const double margin = b.margin + own.margin + depth_error(b, p.error) + depth_error(own, p.error);
  double gap = HUGE_VAL;
  for (int k = 0; k < 4; ++k) {
    for (int edge = 0; edge < 3; ++edge) {
      const Side side = side_of(b, edge, p.x[k], p.y[k], p.error);
      if (side.at < side.tiny) return false;
    }
    gap = std::min(gap, depth_at(b, p.x[k], p.y[k]) - p.depth[k]);
  }
  return gap > margin || face_hides(b, own, lit_.margin);
}

/// Gives *kept those blockers that meet a rectangle around some patches, and reach before the farthest of them.
void Shadows::near(const std::vector<Patch>& patches, const std::vector<std::uint32_t>& blockers,
                   std::vector<std::uint32_t>* kept) const {
  Patch all = patches.front();
  for (const Patch& p : patches) {
    all.x0 = std::min(all.x0, p.x0);
    all.x1 = std::max(all.x1, p.x1);
    all.y0 = std::min(all.y0, p.y0);
    all.y1 = std::max(all.y1, p.y1);
    all.farthest = std::min(all.farthest, p.farthest);
  }
  std::copy_if(blockers.begin(), blockers.end(), std::back_inserter(*kept), [&](std::uint32_t blocker) {
    const ClrayFace& b = lit_.faces[blocker];
    return b.box[0] <= all.x1 && b.box[1] >= all.x0 && b.box[2] <= all.y1 && b.box[3] >= all.y0 &&
           b.nearest + b.margin >= all.farthest;
  });
}

bool Shadows::keep(const Rectangle& r, const std::vector<std::uint32_t>& faces,
                   const std::vector<std::uint32_t>& blockers, std::vector<std::uint32_t>* kept) const {
  kept->clear();
  std::vector<Patch> patches;
  patches.reserve(faces.size());
  for (const std::uint32_t face : faces) patches.push_back(patch(face, r));
  if (patches.empty()) return false;
  if (patches.size() > kFewFaces) {
    near(patches, blockers, kept);
    if (patches.size() * kept->size() > kMostPairs) return true;
    const auto idle = [&](std::uint32_t blocker) {
      return std::none_of(patches.begin(), patches.end(), [&](const Patch& p) { return may_shade(blocker, p); });
    };
    kept->erase(std::remove_if(kept->begin(), kept->end(), idle), kept->end());
    return true;
  }
  for (const std::uint32_t blocker : blockers) {
    bool may = false;
    for (std::size_t k = 0; k < patches.size();) {
      const bool shades = may_shade(blocker, patches[k]);
      may = may || shades;
      if (shades && shades_all(blocker, patches[k])) {
        patches[k] = patches.back();  // dark: other blockers are of no matter to it
        patches.pop_back();
        continue;
      }
      ++k;
    }
    if (patches.empty()) return false;
    if (may) kept->push_back(blocker);
  }
  return true;
}

}  // namespace clray
