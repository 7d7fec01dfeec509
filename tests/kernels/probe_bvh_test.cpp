// SPDX-License-Identifier: Apache-2.0
// What a ray finds in the BVH on the device: every leaf position whose fp64 box the exact ray o + t·d, 0 <= t <= t_max,
// touches must be handed out, once, whatever the rounding of the fp32 walk; and few others. "Touches" is decided box by
// box in 113-bit arithmetic, where differences and products of fp64 numbers are exact.
#include <doctest/doctest.h>

#include "body/bvh.hpp"
#include "kernels/probes/probe.hpp"
#include "shared/abi.h"

namespace {

using namespace probe;

const char* const kWalk = R"(
#include "shared/abi.h"
#include "math/accumulate.cl"
#include "generated/walk_all.inc"
__kernel void probe(const __global ClrayNode *nodes, const __global f64 *rays, f64 cx, f64 cy, f64 cz, f64 scale,
                    __global u32 *counts, volatile __global i64 *counters, u32 stride, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  const __global f64 *r = rays + 7 * i;
  BvhWalk walk;
  u32 first, count;
  bvh_begin(&walk, 0u, v3_load(r), v3_load(r + 3), v3(cx, cy, cz), scale);
  while (bvh_next(&walk, nodes, r[6], &first, &count, counters))
    for (u32 k = first; k < first + count; ++k) counts[(ulong)i * stride + k] += 1u;
})";

struct Ray {
  vec3 o, d;
  double t_max;
};

bool touches(const clray::Box& box, const Ray& ray) {
  const double o[3] = {ray.o.x, ray.o.y, ray.o.z}, d[3] = {ray.d.x, ray.d.y, ray.d.z};
  // Ends of the interval as fractions p/q, q > 0, compared by cross products: no rounding that matters.
  Quad near_p = 0, near_q = 1, far_p = 0, far_q = 1;
  bool bounded = std::isfinite(ray.t_max);
  if (bounded) far_p = ray.t_max;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0.0) {
      if (o[k] < box.low[k] || o[k] > box.high[k]) return false;
      continue;
    }
    const Quad q = d[k] > 0 ? d[k] : -d[k];
    const Quad enter = d[k] > 0 ? Quad(box.low[k]) - o[k] : Quad(o[k]) - box.high[k];
    const Quad leave = d[k] > 0 ? Quad(box.high[k]) - o[k] : Quad(o[k]) - box.low[k];
    if (enter * near_q > near_p * q) {
      near_p = enter;
      near_q = q;
    }
    if (!bounded || leave * far_q < far_p * q) {
      far_p = leave;
      far_q = q;
      bounded = true;
    }
  }
  return !bounded || near_p * far_q <= far_p * near_q;
}

struct Body {
  std::string name;
  std::vector<clray::Box> boxes;
};

clray::Box box_at(const double* centre, double hx, double hy, double hz) {
  const double half[3] = {hx, hy, hz};
  clray::Box box;
  for (int k = 0; k < 3; ++k) {
    box.low[k] = centre[k] - half[k];
    box.high[k] = centre[k] + half[k];
  }
  return box;
}

std::vector<Body> bodies() {
  Random random(1);
  std::vector<Body> all = {{"scattered", {}}, {"flat in z", {}}, {"points", {}}, {"long and tiny", {}},
                           {"far off", {}},   {"huge", {}},      {"one", {}}};
  for (int i = 0; i < 600; ++i) {
    const double c[3] = {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    const double flat[3] = {c[0], c[1], 0.25};
    all[0].boxes.push_back(box_at(c, random.between(0, 0.1), random.between(0, 0.1), random.between(0, 0.1)));
    all[1].boxes.push_back(box_at(flat, 0.05, 0.02, 0.0));
    all[2].boxes.push_back(box_at(c, 0, 0, 0));
    all[3].boxes.push_back(i % 50 ? box_at(c, 1e-3, 1e-3, 1e-3) : box_at(c, 10, 0.01, 0.01));
    const double away[3] = {1e5 + c[0], -3e5 + c[1], 2e6 + c[2]};
    all[4].boxes.push_back(box_at(away, 0.05, 0.05, 0.05));
    const double big[3] = {c[0] * 1e12, c[1] * 1e12, c[2] * 1e12};
    all[5].boxes.push_back(box_at(big, 1e10, 2e10, 1e9));
  }
  const double c[3] = {0.1, 0.2, 0.3};
  all[6].boxes.push_back(box_at(c, 0.5, 0.25, 0.125));
  return all;
}

double corner_of(const clray::Box& box, int axis, bool high) {
  return high ? box.high[axis] : box.low[axis];
}

/// Rays of every kind that can go wrong, about a body of this middle and size.
std::vector<Ray> rays_for(const Body& body, const clray::LinearBvh& tree, std::size_t count) {
  Random random(2);
  const vec3 middle = v3(tree.frame.centre[0], tree.frame.centre[1], tree.frame.centre[2]);
  const double size = 1.0 / tree.frame.scale;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const clray::Box& box = body.boxes[random.word() % body.boxes.size()];
    const auto corner = [&] {
      return v3(corner_of(box, 0, random.word() & 1), corner_of(box, 1, random.word() & 1),
                corner_of(box, 2, random.word() & 1));
    };
    Ray ray{v3_fma(size * std::exp2(random.between(-3, 3)), random.direction(), middle), random.direction(), kInf};
    double* o[3] = {&ray.o.x, &ray.o.y, &ray.o.z};
    double* d[3] = {&ray.d.x, &ray.d.y, &ray.d.z};
    const int axis = static_cast<int>(random.word() % 3);
    switch (i % 9) {
      case 0:  // at a corner, from near
        ray.d = v3_unit(v3_sub(corner(), ray.o));
        break;
      case 1:  // at a corner, from far
        ray.o = v3_fma(size * std::exp2(random.between(3, 20)), random.direction(), middle);
        ray.d = v3_unit(v3_sub(corner(), ray.o));
        break;
      case 2: {  // along an axis, in faces of a box or through it
        const vec3 x = corner();
        ray.o = x;
        for (int k = 0; k < 3; ++k) *d[k] = random.word() & 1 ? 0.0 : -0.0;
        *d[axis] = random.word() & 1 ? 1.0 : -1.0;
        *o[axis] -= *d[axis] * size * std::exp2(random.between(-3, 10));
        if (random.word() % 3 == 0) *o[(axis + 1) % 3] += size * random.between(-0.01, 0.01);
        break;
      }
      case 3:  // in the plane of a face, aslant
        ray.o = corner();
        *d[axis] = random.word() & 1 ? 0.0 : -0.0;
        ray.d = v3_unit(ray.d);
        ray.o = v3(*o[0], *o[1], *o[2]);
        break;
      case 4:  // nearly along an axis: components from 1e-300 to 1e-5, to both sides of the walk's 2^-60
        ray.o = corner();
        for (int k = 0; k < 3; ++k) *d[k] = random.number(i % 2 ? -70 : -1000, -17);
        *d[axis] = random.word() & 1 ? 1.0 : -1.0;
        *o[axis] -= *d[axis] * size * std::exp2(random.between(-3, 3));
        break;
      case 5:  // from within a box
        ray.o = v3(random.between(box.low[0], box.high[0]), random.between(box.low[1], box.high[1]),
                   random.between(box.low[2], box.high[2]));
        break;
      case 6:  // ends exactly at a plane of a box
        ray.d = v3(0, 0, 0);
        *d[axis] = random.word() & 1 ? 1.0 : -1.0;
        ray.o = corner();
        ray.t_max = size * 0.25 * (1 + random.word() % 8);
        *o[axis] -= *d[axis] * ray.t_max;
        break;
      case 7:  // of some length
        ray.t_max = size * random.between(0, 2);
        break;
      default:
        break;
    }
    rays.push_back(ray);
  }
  return rays;
}

struct Walked {
  std::vector<u32> counts;
  i64 overflows;
};

Walked walk(const clray::LinearBvh& tree, const std::vector<Ray>& rays, std::uint32_t stack) {
  clray::ProgramOptions options;
  options.defines["CLRAY_WIDE"] = "0";
  options.defines["CLRAY_STACK"] = std::to_string(stack);
  cl::Kernel kernel = kernel_of(kWalk, options);
  std::vector<double> flat;
  for (const Ray& r : rays) flat.insert(flat.end(), {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.t_max});
  const auto stride = static_cast<cl_uint>(tree.order.size());
  const cl::Buffer counts = out<u32>(rays.size() * stride), counters = out<i64>(CLRAY_COUNTERS);
  const auto& c = tree.frame.centre;
  run(kernel, rays.size(), in(tree.nodes), in(flat), c[0], c[1], c[2], tree.frame.scale, counts, counters, stride);
  return {read<u32>(counts, rays.size() * stride), read<i64>(counters, CLRAY_COUNTERS)[CLRAY_COUNT_STACK]};
}

}  // namespace

TEST_CASE("no box that a ray touches is missed on the device, none is handed out twice, few are in vain") {
  for (const Body& body : bodies()) {
    CAPTURE(body.name);
    const clray::LinearBvh tree = clray::build_bvh(body.boxes);
    const std::vector<Ray> rays = rays_for(body, tree, 5400);
    const Walked walked = walk(tree, rays, tree.stack_needed);
    CHECK(walked.overflows == 0);
    std::size_t missed = 0, twice = 0, touched = 0, vain = 0, near_rays = 0;
    std::size_t kinds[9] = {};
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool near = i % 9 != 1;  // from 2^20 sizes away the widening is as large as the body
      near_rays += near;
      for (std::size_t k = 0; k < tree.order.size(); ++k) {
        const u32 count = walked.counts[i * tree.order.size() + k];
        const bool in = touches(body.boxes[tree.order[k]], rays[i]);
        twice += count > 1;
        touched += in;
        missed += in && count == 0;
        kinds[i % 9] += in && count == 0;
        vain += near && !in && count != 0;
      }
    }
    MESSAGE(body.name << ": " << touched << " touched, " << vain << " others in " << near_rays << " rays");
    for (int kind = 0; kind < 9; ++kind) {
      CAPTURE(kind);
      CHECK(kinds[kind] == 0);
    }
    CHECK(missed == 0);
    CHECK(twice == 0);
    CHECK(touched > rays.size() / 10);
    // A leaf of up to four boxes is handed out whole, and its box is larger than theirs: 0.2 to 2.4 a ray were seen.
    CHECK(vain < 4 * near_rays);
  }
}

TEST_CASE("a tree 2^30 times larger or smaller hands out the same leaves") {
  const Body body = bodies()[0];
  const clray::LinearBvh tree = clray::build_bvh(body.boxes);
  const std::vector<Ray> rays = rays_for(body, tree, 1800);
  const Walked reference = walk(tree, rays, tree.stack_needed);
  for (const double factor : {0x1p30, 0x1p-30}) {
    Body other = body;
    for (clray::Box& box : other.boxes)
      for (int k = 0; k < 3; ++k) {
        box.low[k] *= factor;
        box.high[k] *= factor;
      }
    std::vector<Ray> scaled = rays;
    for (Ray& ray : scaled) {
      ray.o = v3_scale(factor, ray.o);
      ray.t_max *= factor;
    }
    const Walked walked = walk(clray::build_bvh(other.boxes), scaled, tree.stack_needed);
    CHECK(walked.counts == reference.counts);
  }
}

TEST_CASE("too small a stack is counted, never silent") {
  std::vector<clray::Box> boxes;  // all in one place: every child of every node is hit
  const double c[3] = {0, 0, 0};
  for (int i = 0; i < 2000; ++i) boxes.push_back(box_at(c, 1 + 1e-4 * i, 1 + 1e-4 * i, 1 + 1e-4 * i));
  const clray::LinearBvh tree = clray::build_bvh(boxes);
  REQUIRE(tree.stack_needed > 6);
  const std::vector<Ray> rays{{v3(0.1, 0.2, -5), v3(0, 0, 1), kInf}};
  const Walked enough = walk(tree, rays, tree.stack_needed);
  CHECK(enough.overflows == 0);
  CHECK(std::count(enough.counts.begin(), enough.counts.end(), 1u) == 2000);
  const Walked one_less = walk(tree, rays, tree.stack_needed - 1);
  const auto found = std::count(one_less.counts.begin(), one_less.counts.end(), 1u);
  CHECK((one_less.overflows > 0) == (found < 2000));
  const Walked few = walk(tree, rays, 5);
  CHECK(few.overflows > 0);
  CHECK(std::count(few.counts.begin(), few.counts.end(), 1u) < 2000);
}
