// SPDX-License-Identifier: Apache-2.0
// Ear clipping, which remembers what blocks an ear and looks corners up in a tree, against ear clipping that looks at
// every corner each time: the triangles must be the same, in the same order. Then its time for many corners.
#include <doctest/doctest.h>

#include <cmath>
#include <ctime>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "scene/mesh/corner_tree.hpp"
#include "scene/mesh/mesh_triangulate.hpp"
#include "unit/patience.hpp"

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Outline = std::vector<clray::PlanePoint>;
using clray::plane_turn;

// The textbook's loops over a shrinking list of corners, with the rules of mesh_triangulate.cpp for corners that touch.
class PlainClipper {
 public:
  explicit PlainClipper(const Outline& points) : p_(points) {
    for (std::uint32_t i = 0; i < points.size(); ++i) ring_.push_back(i);
  }

  Triangles clip() {
    Triangles triangles;
    std::size_t at = 0;
    while (ring_.size() > 3) {
      at = find(at);
      triangles.push_back({corner(at, -1), corner(at, 0), corner(at, 1)});
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(at));
      at = (at + 1) % ring_.size();
    }
    triangles.push_back({corner(at, -1), corner(at, 0), corner(at, 1)});
    return triangles;
  }

 private:
  std::uint32_t corner(std::size_t at, int step) const {
    return ring_[(at + ring_.size() + static_cast<std::size_t>(step)) % ring_.size()];
  }

  std::size_t find(std::size_t start) const {
    for (int round = 0; round < 3; ++round) {
      for (std::size_t k = 0; k < ring_.size(); ++k) {
        if (ear((start + k) % ring_.size(), round)) return (start + k) % ring_.size();
      }
    }
    return start;
  }

  bool ear(std::size_t at, int round) const {
    const clray::PlanePoint t[3] = {p_[corner(at, -1)], p_[corner(at, 0)], p_[corner(at, 1)]};
    const double area = plane_turn(t[0], t[1], t[2]);
    if (round == 2) return area == 0.0;
    if (!(area > 0.0)) return false;
    for (std::size_t other = 0; other < ring_.size(); ++other) {
      const std::uint32_t j = ring_[other];
      if (j == corner(at, -1) || j == corner(at, 0) || j == corner(at, 1)) continue;
      bool touches = false, inside = true;
      for (int k = 0; k < 3 && !touches; ++k) {
        if (p_[j].x != t[k].x || p_[j].y != t[k].y) continue;
        touches = true;
        for (const int step : {-1, 1}) {
          const clray::PlanePoint r = p_[corner(other, step)];
          if (plane_turn(p_[j], t[(k + 1) % 3], r) > 0.0 && plane_turn(p_[j], t[(k + 2) % 3], r) < 0.0) return false;
        }
      }
      for (int k = 0; k < 3; ++k) {
        const double side = plane_turn(t[k], t[(k + 1) % 3], p_[j]);
        inside = inside && (round == 0 ? side >= 0.0 : side > 0.0);
      }
      if (!touches && inside) return false;
    }
    return true;
  }

  const Outline& p_;
  std::vector<std::uint32_t> ring_;
};

Triangles triangles_of(const Outline& outline, clray::Triangulation* kind) {
  std::vector<clray::Vec3> corners;
  for (const auto& p : outline) corners.push_back({p.x, p.y, 0.0});
  Triangles triangles;
  *kind = clray::triangulate(corners, triangles);
  return triangles;
}

// Outlines by name: simple ones, ones with many corners on lines, and ones that cross themselves.
struct Family {
  std::string name;
  bool simple;
  std::function<Outline(int, std::mt19937&)> make;
};

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) * 0x1p-32;
}

Outline star(int n, const std::function<double(int)>& radius) {
  Outline outline;
  const double step = 2 * std::acos(-1.0) / n;
  for (int i = 0; i < n; ++i) {
    const double r = radius(i);
    outline.push_back({r * std::cos(i * step), r * std::sin(i * step)});
  }
  return outline;
}

std::vector<Family> families() {
  return {
      {"random star", true, [](int n, auto& r) { return star(n, [&](int) { return uniform(r, 0.1, 1.0); }); }},
      {"star", true, [](int n, auto&) { return star(n, [](int i) { return i % 2 ? 1.0 : 0.3; }); }},
      {"slanted comb", true,
       [](int n, auto&) {
         Outline outline{{0.0, -1.0}, {1.0, -1.0}};
         for (int i = n - 3; i >= 0; --i) outline.push_back({double(i) / n + (i % 2) * 10.0, (i % 2) * 10.0});
         return outline;
       }},
      {"strip of corners in a line", true,
       [](int n, auto&) {
         Outline outline;
         for (int i = 0; i < n / 2; ++i) outline.push_back({double(i), 0.0});
         for (int i = n / 2 - 1; i >= 0; --i) outline.push_back({double(i), 1.0});
         outline.push_back({0.25, 0.5});
         return outline;
       }},
      {"spiral", true,
       [](int n, auto&) {
         Outline outline;
         for (int i = 0; i < n; ++i) {
           const int k = i < n / 2 ? i : n - 1 - i;
           const double angle = k * 30.0 / n, radius = 1.0 + 4.0 * k / n - (i < n / 2 ? 0.0 : 0.1);
           outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
         }
         return outline;
       }},
      {"random points", false,
       [](int n, auto& r) {
         Outline outline;
         for (int i = 0; i < n; ++i) outline.push_back({uniform(r, 0.0, 1.0), uniform(r, 0.0, 1.0)});
         return outline;
       }},
      {"points of a lattice, many the same", false,
       [](int n, auto& r) {
         Outline outline;
         for (int i = 0; i < n; ++i) outline.push_back({double(r() % 8), double(r() % 8)});
         return outline;
       }},
      {"random walk", false,
       [](int n, auto& r) {
         Outline outline{{0.0, 0.0}};
         while (static_cast<int>(outline.size()) < n) {
           const auto& last = outline.back();
           outline.push_back({last.x + uniform(r, -1.0, 1.0), last.y + uniform(r, -1.0, 1.0)});
         }
         return outline;
       }},
  };
}

}  // namespace

TEST_CASE("ears are cut as if every corner were looked at each time") {
  std::mt19937 random(7);
  for (const Family& family : families()) {
    CAPTURE(family.name);
    for (const int n : {4, 5, 6, 7, 9, 12, 17, 30, 61, 150}) {
      for (int repeat = 0; repeat < (n < 20 ? 60 : 6); ++repeat) {
        Outline outline = family.make(n, random);
        double twice = 0.0;
        for (std::size_t i = 0; i < outline.size(); ++i) {
          twice += plane_turn({0.0, 0.0}, outline[i], outline[(i + 1) % outline.size()]);
        }
        if (!(twice > 0.0)) continue;  // the clipper sees it from behind
        clray::Triangulation kind{};
        const Triangles found = triangles_of(outline, &kind);
        if (kind == clray::Triangulation::crossing) {
          CHECK_FALSE(family.simple);
          continue;
        }
        bool convex = true;  // a fan, which is not clipped
        for (std::size_t i = 0; i < outline.size() && convex; ++i) {
          convex = plane_turn(outline[i], outline[(i + 1) % outline.size()], outline[(i + 2) % outline.size()]) > 0.0;
        }
        if (convex) continue;
        CHECK(found == PlainClipper(outline).clip());
      }
    }
  }
}

TEST_CASE("20,000 corners take under a second, crossing or not") {
  std::mt19937 random(7);
  for (const Family& family : families()) {
    CAPTURE(family.name);
    const Outline outline = family.make(20000, random);
    const std::clock_t start = std::clock();  // of this process: other work beside it does not count
    clray::Triangulation kind{};
    const Triangles found = triangles_of(outline, &kind);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    CHECK(found.size() == outline.size() - 2);
    CHECK((kind == clray::Triangulation::exact) == family.simple);
    CHECK(seconds < clray::test::kPatience);  // 0.01 to 0.3 s when optimised
  }
}
