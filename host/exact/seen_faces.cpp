// SPDX-License-Identifier: Apache-2.0
// See seen_faces.hpp.
#include "exact/seen_faces.hpp"

#include <algorithm>
#include <cmath>

#include "exact/portable_faces.hpp"

namespace clray {
namespace {

constexpr double kRounding = 1e-15;  // of sides and depths, relative

}  // namespace

std::array<Rectangle, 4> Rectangle::quarters() const {
  const double mx = 0.5 * (x0 + x1), my = 0.5 * (y0 + y1);
  return {{{x0, mx, y0, my}, {mx, x1, y0, my}, {x0, mx, my, y1}, {mx, x1, my, y1}}};
}

SeenFaces::SeenFaces(const BeamFaces& beam) : beam_(beam) {
  edges_.reserve(beam.faces.size());
  for (const ClrayFace& f : beam.faces) {
    Edges e;
    for (int k = 0; k < 3; ++k) {
      const int next = k == 2 ? 0 : k + 1;
      e.dx[k] = f.x[next] - f.x[k];
      e.dy[k] = f.y[next] - f.y[k];
      e.tiny[k] = kRounding * beam.size * (std::fabs(e.dx[k]) + std::fabs(e.dy[k]));
    }
    e.depth_error = kRounding * beam.size * (1.0 + std::fabs(f.slope_x) + std::fabs(f.slope_y));
    edges_.push_back(e);
  }
}

SeenFaces::Place SeenFaces::place(std::uint32_t face, const Rectangle& r) const {
  const ClrayFace& f = beam_.faces[face];
  if (f.box[0] >= r.x1 || f.box[1] <= r.x0 || f.box[2] >= r.y1 || f.box[3] <= r.y0) return outside;
  const Edges& e = edges_[face];
  bool covered = true;
  for (int k = 0; k < 3; ++k) {
    const double dx = e.dx[k], dy = e.dy[k];
    const double high = dx * ((dx > 0.0 ? r.y1 : r.y0) - f.y[k]) - dy * ((dy > 0.0 ? r.x0 : r.x1) - f.x[k]);
    if (high <= -e.tiny[k]) return outside;
    const double low = dx * ((dx > 0.0 ? r.y0 : r.y1) - f.y[k]) - dy * ((dy > 0.0 ? r.x1 : r.x0) - f.x[k]);
    covered = covered && low >= e.tiny[k];
  }
  return covered ? covering : meeting;
}

double SeenFaces::depth_at(std::uint32_t face, double x, double y) const {
  const ClrayFace& f = beam_.faces[face];
  return f.depth0 + f.slope_x * (x - f.x[0]) + f.slope_y * (y - f.y[0]);
}

double SeenFaces::least_depth(std::uint32_t face, const Rectangle& r) const {
  const ClrayFace& f = beam_.faces[face];
  return depth_at(face, f.slope_x > 0.0 ? r.x0 : r.x1, f.slope_y > 0.0 ? r.y0 : r.y1) - edges_[face].depth_error;
}

double SeenFaces::greatest_depth(std::uint32_t face, const Rectangle& r) const {
  const ClrayFace& f = beam_.faces[face];
  const double there = depth_at(face, f.slope_x > 0.0 ? r.x1 : r.x0, f.slope_y > 0.0 ? r.y1 : r.y0);
  return std::min(f.nearest, there + edges_[face].depth_error);
}

/// Whether a face that covers the rectangle hides another in all of it.
bool SeenFaces::hidden(std::uint32_t face, std::uint32_t cover, const Rectangle& r) const {
  const ClrayFace &f = beam_.faces[face], &c = beam_.faces[cover];
  const double a = f.slope_x - c.slope_x, b = f.slope_y - c.slope_y;
  const double x = a > 0.0 ? r.x1 : r.x0, y = b > 0.0 ? r.y1 : r.y0;
  const double gap = depth_at(face, x, y) - depth_at(cover, x, y);
  if (gap < -(f.margin + c.margin + edges_[face].depth_error + edges_[cover].depth_error)) return true;
  return face_hides(c, f, beam_.margin);
}

void SeenFaces::keep(const Rectangle& r, const std::vector<std::uint32_t>& faces,
                     std::vector<std::uint32_t>* kept) const {
  double covered = -HUGE_VAL;  // nothing farther is seen
  std::int64_t cover = -1;
  for (const std::uint32_t face : faces) {
    const ClrayFace& f = beam_.faces[face];
    if (f.nearest + f.margin < covered) continue;
    const Place where = place(face, r);
    if (where == outside || greatest_depth(face, r) + f.margin < covered) continue;
    if (where == covering) {
      const double least = least_depth(face, r);
      if (least > covered) {
        covered = least;
        cover = face;
      }
    }
    kept->push_back(face);
  }
  if (cover < 0) return;
  const auto last = std::remove_if(kept->begin(), kept->end(), [&](std::uint32_t face) {
    return face != cover && hidden(face, static_cast<std::uint32_t>(cover), r);
  });
  kept->erase(last, kept->end());
}

}  // namespace clray
