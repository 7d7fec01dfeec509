// SPDX-License-Identifier: Apache-2.0
// Faces that share a plane: which overlap, which only touch, which way they look, and that neither their order nor the
// corner at which they start matters. Expected values follow from the outlines by hand.
#include <doctest/doctest.h>

#include <algorithm>

#include "body/shared_planes.hpp"

using namespace clray;

namespace {

using Corners = std::vector<std::array<double, 3>>;

struct Faces : FaceSource {
  std::vector<Corners> outlines;
  std::vector<FlatFace> faces;

  void add(const Corners& corners, std::uint32_t material = 0, std::uint32_t frame = 0) {
    faces.push_back({static_cast<std::uint32_t>(faces.size()), 0, frame, material});
    outlines.push_back(corners);
  }
  void outline(const FlatFace& face, FaceOutline* out) const override {
    out->corners = outlines[face.primitive];
    out->hole_radius = 0.0;
  }
  SharedPlanes find() const { return find_shared_planes(faces, *this); }
};

const Corners kFront{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}};
const Corners kBack{{{0, 1, 0}}, {{1, 0, 0}}, {{0, 0, 0}}};
const Corners kBeside{{{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}};  // shares an edge with kFront

}  // namespace

TEST_CASE("two sheets back to back have one plane, equal to the bit, and look opposite ways") {
  Faces f;
  f.add(kFront, 1);
  f.add(kBack, 2);
  const SharedPlanes found = f.find();
  REQUIRE(found.faces.size() == 2);
  for (int k = 0; k <= CLRAY_PLANE_NUMBER; ++k) CHECK(found.faces[0].record[k] == found.faces[1].record[k]);
  CHECK(found.faces[0].record[CLRAY_PLANE_FACING] == -found.faces[1].record[CLRAY_PLANE_FACING]);
  CHECK(found.faces[0].record[2] == 1.0);
  CHECK(found.conflicts == 0);  // of two materials, but they look opposite ways
}

TEST_CASE("faces that share an edge only touch, and faces of other planes or frames are not compared") {
  Faces f;
  f.add(kFront);
  f.add(kBeside);
  f.add({{{0, 0, 1e-9}}, {{1, 0, 1e-9}}, {{0, 1, 1e-9}}});
  f.add(kFront, 0, 1);
  CHECK(f.find().faces.empty());
}

TEST_CASE("rounding of a turned face does not part it from its plane, and conflicts are counted") {
  Faces f;
  f.add(kFront, 1);
  f.add({{{0.2, 0.2, 1e-16}}, {{2, 0.2, -1e-16}}, {{0.2, 2, 0}}}, 2);
  const SharedPlanes found = f.find();
  CHECK(found.faces.size() == 2);
  CHECK(found.conflicts == 2);  // both faces
}

TEST_CASE("the corner at which a face starts changes no bit of its plane") {
  Corners tilted{{{0.1, 0.7, 0.3}}, {{1.3, 0.2, 0.9}}, {{0.4, 1.9, 2.1}}};
  Faces one;
  one.add(tilted);
  one.add(tilted);
  std::rotate(tilted.begin(), tilted.begin() + 1, tilted.end());
  Faces other;
  other.add(tilted);
  other.add(tilted);
  const SharedPlanes a = one.find(), b = other.find();
  REQUIRE(a.faces.size() == 2);
  REQUIRE(b.faces.size() == 2);
  CHECK(a.faces[0].record == b.faces[0].record);
}
