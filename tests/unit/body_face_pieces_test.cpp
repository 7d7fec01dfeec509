// SPDX-License-Identifier: Apache-2.0
// Pieces of faces for the tree: every point of a face lies in the box of one of its pieces, whatever its form, place
// and size; boxes shrink; what is not worth it is not cut; the same with any number of threads. What rays find through
// pieces is tested in unit/pipeline_pieces_test.cpp.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <random>

#include "body/face_pieces.hpp"

using namespace clray;

namespace {

using Triangle = std::array<double, 9>;

class Random {
 public:
  explicit Random(unsigned seed) : bits_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 bits_;
};

/// Slivers that lie askew through a cube, some of them along an axis, among small faces.
std::vector<Triangle> slivers(int count, double size, double place, unsigned seed) {
  Random random(seed);
  std::vector<Triangle> all;
  for (int t = 0; t < count; ++t) {
    Triangle d;
    for (int axis = 0; axis < 3; ++axis) {
      const bool small = t % 4 == 3, flat = t % 5 == 2 && axis == t % 3;
      d[axis] = random.between(-1, 1);
      d[3 + axis] = flat ? d[axis] : small ? d[axis] + random.between(0, 1e-3) : random.between(-1, 1);
      d[6 + axis] = 0.3 * d[axis] + 0.7 * d[3 + axis] + (t % 7 == 0 ? 0.0 : random.between(0, 1e-2));
    }
    for (double& x : d) x = place + size * x;
    all.push_back(d);
  }
  return all;
}

Box box_of(const Triangle& d) {
  Box box;
  for (int k = 0; k < 3; ++k) box.add(std::array<double, 3>{{d[3 * k], d[3 * k + 1], d[3 * k + 2]}});
  return box;
}

double half_area(const Box& b) {
  const double x = b.high[0] - b.low[0], y = b.high[1] - b.low[1], z = b.high[2] - b.low[2];
  return x * y + y * z + z * x;
}

FacePieces pieces_of(const std::vector<Triangle>& faces, bool may_cut = true, unsigned threads = 0) {
  Box body;
  for (const Triangle& d : faces) body.add(box_of(d));
  return FacePieces(
      {faces.size(), [&](std::size_t i) { return box_of(faces[i]); }, [&](std::size_t i) { return faces[i].data(); }},
      body, may_cut, threads);
}

}  // namespace

TEST_CASE("every point of a face lies in the box of one of its pieces, and each box within the face's own") {
  for (const auto& where : {std::pair(1.0, 0.0), {1e-9, 0.0}, {1e7, -3.0}, {1.0, 1e6}, {3.0, 0.1}}) {
    const double size = where.first, place = where.second;
    CAPTURE(size);
    CAPTURE(place);
    const std::vector<Triangle> faces = slivers(600, size, place, 7);
    const FacePieces pieces = pieces_of(faces);
    REQUIRE(pieces.count() > faces.size() + 100);
    CHECK(pieces.count() <= static_cast<std::size_t>((1.0 + FacePieces::kFurther) * 600.0));
    std::vector<std::vector<Box>> boxes(faces.size());
    double before = 0.0, after = 0.0;
    for (std::size_t k = 0; k < pieces.count(); ++k) {
      boxes[pieces.face(k)].push_back(pieces.box(k));
      after += half_area(pieces.box(k));
    }
    Random random(8);
    int outside = 0, too_large = 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const Triangle& d = faces[i];
      const Box whole = box_of(d);
      before += half_area(whole);
      for (const Box& box : boxes[i]) {
        for (int axis = 0; axis < 3; ++axis)
          too_large += box.low[axis] < whole.low[axis] || box.high[axis] > whole.high[axis];
      }
      for (int n = 0; n < 300; ++n) {
        // Corners, edges and inside. The point's own rounding is a part of what a box has room for.
        double u = n < 3 ? (n == 0) : random.between(0, 1), v = n < 3 ? (n == 1) : n < 60 ? 0.0 : random.between(0, 1);
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        bool held = false;
        for (const Box& box : boxes[i]) {
          bool in = true;
          for (int axis = 0; axis < 3; ++axis) {
            const double x = u * d[axis] + v * d[3 + axis] + (1.0 - u - v) * d[6 + axis];
            const double rounding = 4e-16 * (std::abs(place) + size);
            in = in && x >= box.low[axis] - rounding && x <= box.high[axis] + rounding;
          }
          held = held || in;
        }
        outside += !held;
      }
    }
    CHECK(outside == 0);
    CHECK(too_large == 0);
    CHECK(after < (1.0 - FacePieces::kLeastGain) * before);
  }
}

TEST_CASE("where little is gained, nothing is cut: grids, single faces, faces of no size, analytic shapes") {
  std::vector<Triangle> grid;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const double x = i, y = j;
      grid.push_back({x, y, 0, x + 1, y, 0, x, y + 1, 0});
      grid.push_back({x + 1, y + 1, 0, x, y + 1, 0, x + 1, y, 0});
    }
  }
  CHECK(pieces_of(grid).count() == grid.size());
  CHECK(pieces_of({{0, 0, 0, 1, 2, 3, 1, 2, 3.5}}).count() == 1);
  CHECK(pieces_of({5, {1, 1, 1, 1, 1, 1, 1, 1, 1}}).count() == 5);
  const std::vector<Triangle> faces = slivers(100, 1.0, 0.0, 3);
  CHECK(pieces_of(faces, false).count() == 100);
  Box body;
  for (const Triangle& d : faces) body.add(box_of(d));
  const FacePieces shapes(
      {100, [&](std::size_t i) { return box_of(faces[i]); }, [](std::size_t) -> const double* { return nullptr; }},
      body, true);
  CHECK(shapes.count() == 100);
}

TEST_CASE("bodies of extreme size, or far from the origin, have pieces that hold their faces, or none") {
  for (const auto& where : {std::pair(1e-9, 1e6), {1e-200, 0.0}, {1e-310, 0.0}, {1e200, 0.0}, {1e-15, 1.0}}) {
    CAPTURE(where.first);
    const std::vector<Triangle> faces = slivers(100, where.first, where.second, 4);
    const FacePieces pieces = pieces_of(faces);
    std::vector<Box> all(faces.size());
    for (std::size_t k = 0; k < pieces.count(); ++k) all[pieces.face(k)].add(pieces.box(k));
    bool same = true;
    for (std::size_t i = 0; i < faces.size(); ++i)
      same = same && all[i].low == box_of(faces[i]).low && all[i].high == box_of(faces[i]).high;
    CHECK(same);  // together a face's pieces have its box
  }
}

TEST_CASE("pieces do not depend on the number of threads") {
  const std::vector<Triangle> faces = slivers(60000, 1.0, 0.0, 9);
  const FacePieces one = pieces_of(faces, true, 1);
  REQUIRE(one.count() > faces.size());
  for (const unsigned threads : {2u, 3u}) {
    const FacePieces more = pieces_of(faces, true, threads);
    REQUIRE(more.count() == one.count());
    bool same = true;
    for (std::size_t k = 0; k < one.count(); ++k) {
      same = same && one.face(k) == more.face(k) && one.box(k).low == more.box(k).low &&
             one.box(k).high == more.box(k).high;
    }
    CHECK(same);
  }
}
