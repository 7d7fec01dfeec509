// SPDX-License-Identifier: Apache-2.0
// Overlaps in a plane: what is found of rectangles with whole coordinates equals what a comparison of all pairs in
// whole numbers says, and faces in one place are not compared pair by pair. Metres.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "body/plane_overlaps.hpp"

using namespace clray;

namespace {

struct Square {
  int x0, y0, x1, y1;
};

/// In z = 0; the corners turn the other way where the face looks down.
PlaneFace face_of(const Square& s, bool front, std::uint32_t material, double scale = 1.0) {
  const double x0 = s.x0 * scale, y0 = s.y0 * scale, x1 = s.x1 * scale, y1 = s.y1 * scale;
  PlaneFace face;
  face.outline.corners = {{{x0, y0, 0}}, {{x1, y0, 0}}, {{x1, y1, 0}}, {{x0, y1, 0}}};
  if (!front) std::reverse(face.outline.corners.begin(), face.outline.corners.end());
  face.front = front;
  face.material = material;
  return face;
}

PlaneOverlaps find(const std::vector<PlaneFace>& faces) {
  return find_overlaps(faces.data(), faces.size(), {{0, 0, 1}});
}

}  // namespace

TEST_CASE("overlaps are those of all pairs, whatever the sizes, ways and materials") {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const int count = 1 + below(200), places = 4 + below(200), size = 1 + below(places), materials = 1 + below(6);
    std::vector<Square> squares;
    std::vector<PlaneFace> faces;
    for (int i = 0; i < count; ++i) {
      const int x = below(places), y = below(places);
      squares.push_back({x, y, x + 1 + below(size), y + 1 + below(size)});
      if (i > 0 && below(4) == 0) squares.back() = squares[static_cast<std::size_t>(below(i))];  // in one place
      faces.push_back(face_of(squares.back(), below(3) > 0, static_cast<std::uint32_t>(below(materials))));
    }
    const PlaneOverlaps found = find(faces);
    bool right = true;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      bool shared = false, conflicting = false;
      for (std::size_t k = 0; k < faces.size(); ++k) {
        const Square &a = squares[i], &b = squares[k];
        if (i == k || a.x1 <= b.x0 || b.x1 <= a.x0 || a.y1 <= b.y0 || b.y1 <= a.y0) continue;
        shared = true;
        conflicting = conflicting || (faces[i].front == faces[k].front && faces[i].material != faces[k].material);
      }
      right = right && found.shared[i] == shared && found.conflicting[i] == conflicting;
    }
    CHECK_MESSAGE(right, "seed " << seed);
  }
}

TEST_CASE("a hundred thousand faces in one place, or nearly so, take a few comparisons each") {
  constexpr int kFaces = 100000;
  constexpr std::uint64_t kFew = 4 * kFaces;  // of all pairs there are 5e9
  // Materials: one each; one for all; two, of which the second comes late.
  for (const int kind : {0, 1, 2}) {
    for (const bool one_way : {true, false}) {
      std::vector<PlaneFace> same, nested, moved;
      for (int i = 0; i < kFaces; ++i) {
        const auto material = static_cast<std::uint32_t>(kind == 0 ? i : kind == 1 ? 0 : i > kFaces / 2);
        const bool front = one_way || i % 2 == 0;
        same.push_back(face_of({0, 0, 1, 1}, front, material));
        nested.push_back(face_of({-i - 1, -i - 1, i + 1, i + 1}, front, material, 1e-3));
        moved.push_back(face_of({i, 0, i + kFaces, kFaces}, front, material, 1e-3));
      }
      for (const auto* faces : {&same, &nested, &moved}) {
        const PlaneOverlaps found = find(*faces);
        CHECK(found.compared <= kFew);
        CHECK(std::count(found.shared.begin(), found.shared.end(), 1) == kFaces);
        CHECK(std::count(found.conflicting.begin(), found.conflicting.end(), 1) == (kind == 1 ? 0 : kFaces));
      }
    }
  }
}
