// SPDX-License-Identifier: Apache-2.0
// Packets of rays against rays alone: the same digests on bodies that try what packets cull by. Slivers and needles at
// every angle, triangles smaller than fp32 sees, edges that rays meet exactly, bodies far from the origin, very small
// or very large, faces in one plane, analytic shapes among meshes, beams along axes; few and many points, slices of odd
// sizes, with and without strata, bounces and shadows.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "clray/trace.hpp"
#include "support/scenes.hpp"
#include "support/some.hpp"

using namespace clray_test;
using clray::Scene;

namespace {

/// Triangles in a cube of that size about a centre: a third slivers, a third tiny, a third of any form.
MeshPtr soup(int count, double size, clray::Vec3 centre, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto next = [&] { return 2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0; };
  auto mesh = std::make_shared<clray::Mesh>();
  mesh->material_slots = {""};
  for (int t = 0; t < count; ++t) {
    const double at[3] = {next(), next(), next()};
    double corner[3][3];
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        const double reach = t % 3 == 0 ? (k == 0 ? 0.0 : 0.5) : t % 3 == 1 ? 1e-7 : 0.2;
        corner[k][axis] = at[axis] + reach * next();
      }
    }
    // A sliver's third corner lies within 1e-6 of its long edge.
    for (int axis = 0; t % 3 == 0 && axis < 3; ++axis)
      corner[2][axis] = 0.3 * corner[0][axis] + 0.7 * corner[1][axis] + 1e-6 * next();
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    for (const auto& c : corner)
      mesh->vertices.push_back({centre.x + size * c[0], centre.y + size * c[1], centre.z + size * c[2]});
    mesh->triangles.push_back({first, first + 1, first + 2});
    mesh->triangle_slot.push_back(0);
  }
  return mesh;
}

void check_same(const std::string& what, Scene scene) {
  CAPTURE(what);
  scene.trace.walk = "plain";
  const std::uint64_t alone = run(scene).digest;
  for (const char* walk : {"packet", "placed"}) {
    scene.trace.walk = walk;
    CHECK(run(scene).digest == alone);
  }
}

Scene seen(Scene scene, clray::Vec3 from, int log2_rays) {
  monostatic(scene, from);
  many_rays(scene, log2_rays);
  return scene;
}

}  // namespace

TEST_CASE("packets give the digests of rays alone: soups of slivers and tiny triangles, any size and place") {
  const clray::Vec3 tilted = toward(0.6, -1.0);
  for (const unsigned seed : some(1, {1u, 2u, 3u}))
    check_same("soup", seen(scene_of(soup(60, 1.0, {0, 0, 0}, seed), lambert(0.5)), tilted, 15));
  check_same("far away", seen(scene_of(soup(60, 1.0, {3e5, -2e5, 1e5}, 4), lambert(0.5)), tilted, 14));
  check_same("small", seen(scene_of(soup(60, 1e-6, {0, 0, 0}, 5), lambert(0.5)), tilted, 14));
  check_same("large", seen(scene_of(soup(60, 1e6, {0, 0, 0}, 6), lambert(0.5)), tilted, 14));
  check_same("dense", seen(scene_of(soup(3000, 1.0, {0, 0, 0}, 7), lambert(0.5)), tilted, 15));
  for (const clray::Vec3 axis : some<clray::Vec3>(1, {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}))
    check_same("along an axis", seen(scene_of(soup(60, 1.0, {0, 0, 0}, 8), lambert(0.5)), axis, 14));
}

TEST_CASE("packets give the digests of rays alone: shared planes, shapes, bounces, shadows, points of any number") {
  Scene scene = scene_of(sphere_mesh(24, 12, 1.0), lambert(0.5));
  add(scene, moved(plate_mesh(3, 1), {0, 0, 1.1}), lambert(0.4));
  add(scene, moved(plate_mesh(2, 2), {0.5, 0, 1.1}), lambert(0.7));  // in the plane of the other
  add(scene, "cylinder", {{"radius", 0.3}, {"height", 2.0}}, lambert(0.8)).transform.translate = {1.5, 0.3, 0.2};
  const clray::Vec3 from = toward(0.7, 0.4);
  for (const int log2_rays : {4, 7, 12, 15}) check_same("rays", seen(scene, from, log2_rays));
  Scene even = seen(scene, from, 13);
  even.trace.sampler = clray::SamplerKind::sobol;
  check_same("without strata", even);
  Scene slices = seen(scene, from, 14);
  slices.trace.slice_points = 100;
  check_same("slices of 100 points", slices);
  Scene bounces = seen(scene, from, 13);
  bounces.trace.max_bounces = 3;
  check_same("three bounces", bounces);
  bistatic(bounces, from, toward(1.2, -0.3));
  check_same("shadows", bounces);
}

TEST_CASE("pictures have one digest under every walk") {
  Scene scene = seen(scene_of(sphere_mesh(24, 12, 1.0), lambert(0.5)), toward(0.7, 0.4), 16);
  scene.detectors = {{"rgb", "", {{"width", 30}, {"height", 20}}}};
  check_same("one bounce", scene);
  scene.trace.max_bounces = 3;
  add(scene, moved(plate_mesh(3, 1), {0, 0, 1.1}), lambert(0.4));
  check_same("three bounces", scene);
}

TEST_CASE("shadow rays in packets give the digests of rays alone: soups, any size and place, several observers") {
  const clray::Vec3 from = toward(0.6, -1.0), along_x = {1, 0, 0};
  const auto aside = [](Scene scene, clray::Vec3 light, clray::Vec3 observer, int log2_rays) {
    bistatic(scene, light, observer);
    scene.observers[0].name = "one";
    scene.observers.push_back(scene.observers[0]);
    scene.observers[1].name = "other";
    scene.observers[1].direction = toward(0.9, -0.2);
    return rays(scene, log2_rays);
  };
  for (const unsigned seed : some(1, {11u, 12u, 13u}))
    check_same("soup", aside(scene_of(soup(60, 1.0, {0, 0, 0}, seed), lambert(0.5)), from, toward(1.1, 0.4), 15));
  check_same("far away", aside(scene_of(soup(60, 1.0, {3e5, -2e5, 1e5}, 14), lambert(0.5)), from, along_x, 14));
  check_same("small", aside(scene_of(soup(60, 1e-6, {0, 0, 0}, 15), lambert(0.5)), from, toward(2.0, 1.0), 14));
  check_same("large", aside(scene_of(soup(60, 1e6, {0, 0, 0}, 16), lambert(0.5)), from, toward(0.7, -1.1), 14));
  check_same("dense", aside(scene_of(soup(3000, 1.0, {0, 0, 0}, 17), lambert(0.5)), from, toward(1.4, 0.2), 15));
  // A bumpy floor seen at a grazing angle: packets are long along their direction, and much is hidden.
  check_same("grazing", aside(scene_of(sphere_mesh(48, 24, 1.0), lambert(0.5)), {0, 0, 1}, toward(1.55, 0.3), 15));
}

TEST_CASE("shadow rays in packets from first hits of which some are solved and some not") {
  // The ball and what it may shade are sampled, toward the source or either observer; the rest is solved.
  Scene scene = scene_of(plate_mesh(1.0, 1.0), lambert(0.8));
  scene.components[0].transform.translate = {0.5, 0.0, 0.0};
  clray::Component& wall = add(scene, plate_mesh(1.0, 1.0), lambert(0.3));
  wall.transform.translate = {-0.5, 0.0, 0.0};
  wall.transform.axis = {0.0, 1.0, 0.0};
  wall.transform.angle_rad = radians(50.0);
  add(scene, "sphere", {{"radius", 0.2}}, lambert(0.8)).transform.translate = {0.5, 0.1, 1.5};
  for (const int bounces : {1, 3}) {
    bistatic(scene, toward(0.63, 0.54), toward(1.27, -0.42));
    scene.observers[0].name = "aside";
    scene.observers.push_back(scene.observers[0]);
    scene.observers[1].name = "at the source";
    scene.observers[1].monostatic = true;
    rays(scene, 15);
    scene.trace.max_bounces = bounces;
    scene.trace.method = clray::Method::points;
    check_same("sampled", scene);
    scene.trace.method = clray::Method::exact;
    check_same("solved where no ball is", scene);
  }
}

TEST_CASE("packets are taken where they may be and pay, or where they are asked for") {
  const auto in_packets = [](const Scene& scene) {
    const clray::Result result = run(scene);
    const auto says = [](const std::vector<std::string>& lines, const std::string& text) {
      return std::any_of(lines.begin(), lines.end(), [&](const std::string& l) { return l.find(text) == 0; });
    };
    const bool packets = says(result.kept, "walk packet: ");
    CHECK(packets != (says(result.kept, "walk plain: ") || says(result.kept, "walk placed: ")));
    CHECK(packets != says(result.left_out, "packets of rays: "));
    return packets;
  };
  const Scene many = seen(scene_of(sphere_mesh(8, 4, 1.0), lambert(0.5)), {0, 0, 1}, 20);
  const bool cpu = device().info().type == "cpu";  // elsewhere they are never taken
  CHECK(in_packets(many) == cpu);
  Scene scene = seen(many, {0, 0, 1}, 12);
  CHECK_FALSE(in_packets(scene));  // few rays
  scene.trace.walk = "packet";
  CHECK(in_packets(scene) == cpu);
  scene = many;
  scene.trace.walk = "plain";
  CHECK_FALSE(in_packets(scene));
  scene = seen(many, {0, 0, 1}, 12);
  scene.trace.walk = "packet";  // what they cannot do goes alone all the same
  scene.trace.sampler = clray::SamplerKind::random;
  CHECK_FALSE(in_packets(scene));
}
