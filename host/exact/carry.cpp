// SPDX-License-Identifier: Apache-2.0
// See carry.hpp.
#include "exact/carry.hpp"

#include <algorithm>
#include <cmath>

namespace clray {
namespace {

constexpr double kRounding = 8.9e-16;  // of lengths: what a carried corner may be off

}  // namespace

Carrier::Carrier(const BeamFaces& lit, const BeamFaces& seen) : from_(lit), to_(seen), seen_(lit.faces.size(), -1) {
  std::uint32_t most = 0;
  for (const FaceOrigin& origin : seen.origins) most = std::max(most, origin.number);
  std::vector<std::int64_t> by_number(seen.origins.empty() ? 0 : most + std::size_t{1}, -1);
  for (std::size_t k = 0; k < seen.origins.size(); ++k)
    by_number[seen.origins[k].number] = static_cast<std::int64_t>(k);
  for (std::size_t k = 0; k < lit.faces.size(); ++k) {
    const std::uint32_t number = lit.origins[k].number;
    const std::int64_t there = number < by_number.size() ? by_number[number] : -1;
    if (there < 0) continue;
    // Normals look at where the beam comes from: on the same side they are the same.
    const double side =
        v3_dot(v3_load(lit.faces[k].normal), v3_load(seen.faces[static_cast<std::size_t>(there)].normal));
    if (side > 0.0) seen_[k] = there;
  }
}

ClrayCarried Carrier::steps(std::uint32_t face) const {
  const ClrayFace& f = from_.faces[face];
  // A step across the first beam is a step over the face, and that is one across the other beam.
  const vec3 step_x = v3_fma(f.slope_x, from_.toward, from_.axis_x),
             step_y = v3_fma(f.slope_y, from_.toward, from_.axis_y);
  ClrayCarried c{};
  c.xx = v3_dot(step_x, to_.axis_x);
  c.xy = v3_dot(step_y, to_.axis_x);
  c.yx = v3_dot(step_x, to_.axis_y);
  c.yy = v3_dot(step_y, to_.axis_y);
  c.there = seen_[face] < 0 ? CLRAY_NOT_THERE : static_cast<std::uint32_t>(seen_[face]);
  return c;
}

double carried_error(const ClrayCarried& c, double size) {
  return kRounding * size * (1.0 + std::max(std::fabs(c.xx) + std::fabs(c.xy), std::fabs(c.yx) + std::fabs(c.yy)));
}

ClrayPiece Carrier::carry(const ClrayPiece& piece) const {
  const ClrayCarried c = steps(piece.face);
  const ClrayFace &f = from_.faces[piece.face], &t = to_.faces[c.there];
  ClrayPiece out = piece;
  out.face = c.there;
  for (std::uint32_t k = 0; k < piece.corners; ++k) {
    const double dx = piece.x[k] - f.x[0], dy = piece.y[k] - f.y[0];
    out.x[k] = std::fma(c.xx, dx, std::fma(c.xy, dy, t.x[0]));
    out.y[k] = std::fma(c.yx, dx, std::fma(c.yy, dy, t.y[0]));
  }
  out.off = carried_error(c, from_.size);
  return out;
}

}  // namespace clray
