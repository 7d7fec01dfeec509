// SPDX-License-Identifier: Apache-2.0
// Triangles on the device: no ray is lost through a shared edge or vertex, distances and weights keep their digits, and
// of equal distances the smaller canonical id wins whatever the order of the leaves.
#include <doctest/doctest.h>

#include <array>
#include <numeric>

#include "body/bvh.hpp"
#include "generated/program_numbers.inc"
#include "kernels/probes/probe.hpp"
#include "shared/abi.h"

namespace host {
#include "shape/shape.h"
#include "shape/triangle.cl"
}  // namespace host

namespace {

using namespace probe;

/// Directly: one ray against one triangle. out: hit, t, weights.
const char* const kTriangle = R"(
#include "shared/abi.h"
#include "shape/shape.h"
#include "shape/triangle.cl"
__kernel void probe(const __global f64 *triangles, const __global f64 *rays, __global f64 *out, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  const __global f64 *r = rays + 7 * i;
  const RayShear shear = triangle_shear(v3_load(r), v3_load(r + 3));
  f64 t = -1.0;
  vec3 w = v3(0.0, 0.0, 0.0);
  out[5 * i] = triangle_intersect(triangles + 9 * i, &shear, r[6], &t, &w);
  out[5 * i + 1] = t;
  out[5 * i + 2] = w.x;
  out[5 * i + 3] = w.y;
  out[5 * i + 4] = w.z;
})";

/// Through the tree, as stage 2 does. out: canonical id (or 0xffffffff) and t.
const char* const kIntersect = R"(
#include "trace.cl"
__kernel void probe(const __global ClrayView *views, const __global ClrayNode *nodes,
                    const __global ClrayPrimitive *primitives, const __global f64 *shapes, const __global f64 *rays,
                    __global u32 *ids, __global f64 *t, volatile __global i64 *counters, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  Buffers g;
  g.views = views;
  g.nodes = nodes;
  g.primitives = primitives;
  g.shapes = shapes;
  g.counters = counters;
  Ray ray;
  ray.o = v3_load(rays + 7 * i);
  ray.d = v3_load(rays + 7 * i + 3);
  ray.skip_primitive = 0xffffffffu;
  ray.skip_instance = 0u;
  ray.skip_plane = 0u;
  Hit hit;
  intersect(&g, &ray, 0u, 0u, &hit);
  ids[i] = hit.id;
  t[i] = hit.t;
})";

clray::ProgramOptions trace_options() {
  clray::ProgramOptions options;
#define CLRAY_NUMBER(name) options.defines[#name] = "0";
  CLRAY_PROGRAM_NUMBERS(CLRAY_NUMBER)
#undef CLRAY_NUMBER
  for (const char* text : {"ANALYTIC", "PACKET"})
    options.defines[std::string("CLRAY_") + text] = "0";  // what is left out
  for (const char* hook : {"hit", "connect", "scatter", "escape", "end", "flush"})
    options.defines[std::string("CLRAY_HOOK_") + hook + "(X)"] = "";
  for (const char* on : {"TRIANGLES", "CONNECT", "SOBOL", "LANES", "CONNECTIONS", "KEPT"})
    options.defines[std::string("CLRAY_") + on] = "1";
  options.defines["CLRAY_STACK"] = "96";
  options.brdfs = {0};
  options.shapes = {0};
  return options;
}

using Triangle = std::array<vec3, 3>;

struct Ray {
  vec3 o, d;
};

/// An octahedron divided `levels` times, its vertices moved at random and put on multiples of 2^-20: sums and
/// differences of a few of them are exact, so rays can be aimed exactly. Closed, about the origin.
struct Ball {
  std::vector<vec3> vertices;
  std::vector<std::array<u32, 3>> faces;
  std::vector<std::array<u32, 2>> edges;

  explicit Ball(int levels) {
    Random random(5);
    for (int axis = 0; axis < 3; ++axis)
      for (double sign : {1.0, -1.0})
        vertices.push_back(v3(axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0));
    for (u32 x : {0u, 1u})
      for (u32 y : {2u, 3u})
        for (u32 z : {4u, 5u}) {
          const bool turned = (x + y + z) % 2 == 1;
          faces.push_back({x, turned ? z : y, turned ? y : z});
        }
    for (int level = 0; level < levels; ++level) divide();
    for (vec3& v : vertices) {
      v = v3_scale((1.0 + random.between(-0.05, 0.05) / (1 << levels)) / v3_length(v), v);
      v = v3_fma(0.2 / (1 << levels), random.direction(), v);
      for (double* x : {&v.x, &v.y, &v.z}) *x = std::rint(*x * 0x1p20) * 0x1p-20;
    }
    for (const auto& f : faces)
      for (int k = 0; k < 3; ++k)
        if (f[k] < f[(k + 1) % 3]) edges.push_back({f[k], f[(k + 1) % 3]});
  }

  void divide() {
    std::vector<std::array<u32, 3>> finer;
    std::vector<std::array<u32, 3>> known;  // low, high, middle
    const auto middle = [&](u32 a, u32 b) {
      for (const auto& k : known)
        if (k[0] == std::min(a, b) && k[1] == std::max(a, b)) return k[2];
      vertices.push_back(v3_unit(v3_add(vertices[a], vertices[b])));
      known.push_back({std::min(a, b), std::max(a, b), static_cast<u32>(vertices.size() - 1)});
      return known.back()[2];
    };
    for (const auto& f : faces) {
      const u32 ab = middle(f[0], f[1]), bc = middle(f[1], f[2]), ca = middle(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], ab, ca}, {f[1], bc, ab}, {f[2], ca, bc}, {ab, bc, ca}});
    }
    faces = finer;
  }
};

/// A packed mesh with the view to trace it in; ids by `rank`, leaves in the order of the faces given.
struct Packed {
  std::vector<ClrayNode> nodes;
  std::vector<ClrayPrimitive> primitives;
  std::vector<double> shapes;
  ClrayView view{};

  Packed(const std::vector<Triangle>& triangles, const std::vector<u32>& rank) {
    std::vector<clray::Box> boxes(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (const vec3& v : triangles[i]) boxes[i].add(std::array<double, 3>{{v.x, v.y, v.z}});
    const clray::LinearBvh tree = clray::build_bvh(boxes);
    nodes = tree.nodes;
    for (const u32 i : tree.order) {
      ClrayPrimitive p{};
      p.data = static_cast<u32>(shapes.size());
      p.id = rank[i];
      primitives.push_back(p);
      for (const vec3& v : triangles[i]) shapes.insert(shapes.end(), {v.x, v.y, v.z});
    }
    std::copy(tree.frame.centre.begin(), tree.frame.centre.end(), view.box_centre);
    view.box_scale = tree.frame.scale;
  }
};

struct Found {
  std::vector<u32> id;
  std::vector<double> t;
};

std::vector<double> flat(const std::vector<Ray>& rays, double t_max = kInf) {
  std::vector<double> out;
  for (const Ray& r : rays) out.insert(out.end(), {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, t_max});
  return out;
}

Found trace(const Packed& mesh, const std::vector<Ray>& rays) {
  static cl::Kernel kernel = kernel_of(kIntersect, trace_options());
  const cl::Buffer ids = out<u32>(rays.size()), t = out<double>(rays.size()), counters = out<i64>(CLRAY_COUNTERS);
  run(kernel, rays.size(), in(std::vector<ClrayView>{mesh.view}), in(mesh.nodes), in(mesh.primitives), in(mesh.shapes),
      in(flat(rays)), ids, t, counters);
  for (const i64 n : read<i64>(counters, CLRAY_COUNTERS)) CHECK(n == 0);
  return {read<u32>(ids, rays.size()), read<double>(t, rays.size())};
}

std::vector<Triangle> triangles_of(const Ball& ball) {
  std::vector<Triangle> all;
  for (const auto& f : ball.faces) all.push_back({ball.vertices[f[0]], ball.vertices[f[1]], ball.vertices[f[2]]});
  return all;
}

std::vector<u32> identity(std::size_t count) {
  std::vector<u32> rank(count);
  std::iota(rank.begin(), rank.end(), 0u);
  return rank;
}

/// A point within the ball's inner half, on multiples of 2^-20.
vec3 inner_point(Random& random) {
  vec3 o = v3_scale(0.5 * random.uniform(), random.direction());
  for (double* x : {&o.x, &o.y, &o.z}) *x = std::rint(*x * 0x1p20) * 0x1p-20;
  return o;
}

/// Exact t and weights (Möller & Trumbore's determinants in 113 bits).
struct Exact {
  Quad t, w[3];
  double cosine, height;
};

Exact exact_hit(const Triangle& tri, const Ray& ray) {
  const auto lift = [](vec3 v) { return std::array<Quad, 3>{v.x, v.y, v.z}; };
  const auto sub = [](auto a, auto b) { return std::array<Quad, 3>{a[0] - b[0], a[1] - b[1], a[2] - b[2]}; };
  const auto cross = [](auto a, auto b) {
    return std::array<Quad, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto dot = [](auto a, auto b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const auto a = lift(tri[0]), b = lift(tri[1]), c = lift(tri[2]), o = lift(ray.o), d = lift(ray.d);
  const auto e1 = sub(b, a), e2 = sub(c, a), s = sub(o, a), p = cross(d, e2), q = cross(s, e1), n = cross(e1, e2);
  const Quad det = dot(e1, p);
  Exact x;
  x.t = dot(e2, q) / det;
  x.w[1] = dot(s, p) / det;
  x.w[2] = dot(d, q) / det;
  x.w[0] = 1 - x.w[1] - x.w[2];
  const auto length = [&](auto v) { return std::sqrt(static_cast<double>(dot(v, v))); };
  x.cosine = std::fabs(static_cast<double>(det)) / (length(n) * length(d));
  x.height = length(n) / std::max({length(e1), length(e2), length(sub(c, b))});
  return x;
}

}  // namespace

TEST_CASE("rays from within a closed mesh, aimed exactly at its edges and vertices, all hit it") {
  const Ball ball(4);
  const Packed mesh(triangles_of(ball), identity(ball.faces.size()));
  Random random(6);
  std::vector<Ray> rays;
  for (int k = 0; k < 400000; ++k) {
    const vec3 o = k % 4 == 0 ? v3(0, 0, 0) : inner_point(random);
    const auto& e = ball.edges[random.word() % ball.edges.size()];
    const vec3 a = v3_sub(ball.vertices[e[0]], o), b = v3_sub(ball.vertices[e[1]], o);
    const double m = random.word() % 1024, n = k % 5 == 0 ? 0.0 : random.word() % 1024;
    vec3 d = v3_add(v3_scale(m + 1, a), v3_scale(n, b));  // integers times multiples of 2^-20: exact
    if (k % 3 == 0) d = v3_unit(d);                       // and off the edge by a rounding
    rays.push_back({o, d});
  }
  const Found found = trace(mesh, rays);
  std::size_t lost = 0, far = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    lost += found.id[i] == 0xffffffffu;
    const double r = v3_length(v3_fma(found.t[i], rays[i].d, rays[i].o));
    far += !(r > 0.8 && r < 1.3);
  }
  CHECK(lost == 0);
  CHECK(far == 0);
}

TEST_CASE("rays from outside through a closed mesh hit it too, however far they come from") {
  const Ball ball(4);
  const Packed mesh(triangles_of(ball), identity(ball.faces.size()));
  Random random(7);
  std::vector<Ray> rays;
  for (int k = 0; k < 200000; ++k) {
    // Through a vertex or an edge and a point deep inside: passes within, whatever the rounding.
    const auto& e = ball.edges[random.word() % ball.edges.size()];
    const double f = k % 3 == 0 ? 0.0 : random.uniform();
    const vec3 x = v3_add(v3_scale(1 - f, ball.vertices[e[0]]), v3_scale(f, ball.vertices[e[1]]));
    const vec3 d = v3_unit(v3_sub(inner_point(random), x));
    rays.push_back({v3_fma(-std::exp2(random.between(-2, 20)), d, x), d});
  }
  const Found found = trace(mesh, rays);
  CHECK(std::count(found.id.begin(), found.id.end(), 0xffffffffu) == 0);
}

TEST_CASE("the nearest hit through the tree is that of brute force, bit for bit, ties to the smaller id") {
  const Ball ball(3);
  std::vector<Triangle> triangles = triangles_of(ball);
  const std::size_t single = triangles.size();
  for (std::size_t i = 0; i < single; i += 2) triangles.push_back(triangles[i]);  // coincident, of another id
  Random random(8);
  std::vector<Ray> rays;
  for (int k = 0; k < 6000; ++k) {
    const auto& e = ball.edges[random.word() % ball.edges.size()];
    const vec3 a = ball.vertices[e[0]], b = ball.vertices[e[1]];
    const vec3 target = k % 3 == 0 ? a : k % 3 == 1 ? v3_scale(0.5, v3_add(a, b)) : random.direction();
    const vec3 o = k % 2 ? inner_point(random) : v3_scale(4.0, random.direction());
    rays.push_back({o, k % 4 < 2 ? v3_sub(target, o) : v3_unit(v3_sub(target, o))});
  }
  Found first;
  for (int round = 0; round < 3; ++round) {
    // Another order of the faces with ids kept: another tree, other leaves, the same answer.
    std::vector<u32> order = identity(triangles.size()), rank;
    for (std::size_t i = order.size(); round > 0 && i > 1; --i) std::swap(order[i - 1], order[random.word() % i]);
    std::vector<Triangle> turned;
    for (const u32 i : order) {
      turned.push_back(triangles[i]);
      rank.push_back(i < single ? i + 1000 : i - static_cast<u32>(single));  // copies come first
    }
    const Found found = trace(Packed(turned, rank), rays);
    if (round == 0) first = found;
    CHECK(found.id == first.id);
    CHECK(std::memcmp(found.t.data(), first.t.data(), found.t.size() * sizeof(double)) == 0);
  }
  std::size_t wrong = 0, ties = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const host::RayShear shear = host::triangle_shear(rays[i].o, rays[i].d);
    double best = kInf;
    u32 id = 0xffffffffu;
    int equal = 0;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      double p[9], t;
      vec3 w;
      for (int v = 0; v < 3; ++v) {
        p[3 * v] = triangles[k][v].x;
        p[3 * v + 1] = triangles[k][v].y;
        p[3 * v + 2] = triangles[k][v].z;
      }
      if (!host::triangle_intersect(p, &shear, kInf, &t, &w)) continue;
      const u32 mine = static_cast<u32>(k < single ? k + 1000 : k - single);
      equal = t < best ? 1 : equal + (t == best);
      if (t < best || (t == best && mine < id)) {
        best = t;
        id = mine;
      }
    }
    ties += equal > 1;
    wrong += first.id[i] != id || (id != 0xffffffffu && first.t[i] != best);
  }
  MESSAGE(ties << " ties among " << rays.size() << " rays");
  CHECK(wrong == 0);
  CHECK(ties > rays.size() / 4);
}

TEST_CASE("distance and weights on the device against 113-bit arithmetic; the host's bits; the limit t_max counts") {
  Random random(9);
  std::vector<Triangle> triangles;
  std::vector<Ray> rays;
  std::vector<double> numbers;
  const std::size_t count = 200000;
  for (std::size_t i = 0; i < count; ++i) {
    Triangle t;
    for (vec3& v : t) v = v3_fma(i % 2 ? 1.0 : 0.01, random.direction(), v3(0.3, -0.2, 0.1));
    const double u = random.between(-0.3, 1), v = random.between(-0.3, 1);
    const vec3 target = v3_add(t[0], v3_add(v3_scale(u, v3_sub(t[1], t[0])), v3_scale(v, v3_sub(t[2], t[0]))));
    const vec3 o = v3_fma(std::exp2(random.between(-1, 6)), random.direction(), target);
    triangles.push_back(t);
    rays.push_back({o, i % 64 == 0 ? v3_neg(v3_unit(v3_sub(target, o))) : v3_unit(v3_sub(target, o))});
    for (const vec3& x : t) numbers.insert(numbers.end(), {x.x, x.y, x.z});
  }
  cl::Kernel kernel = kernel_of(kTriangle);
  const cl::Buffer result = out<double>(5 * count);
  run(kernel, count, in(numbers), in(flat(rays)), result);
  std::vector<double> found = read<double>(result, 5 * count);
  std::size_t differ = 0, wrong = 0, near_edge = 0, hits = 0;
  double worst_t = 0.0, worst_w = 0.0, worst_sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double* f = found.data() + 5 * i;
    double t = -1.0;
    vec3 w = v3(0, 0, 0);
    const host::RayShear shear = host::triangle_shear(rays[i].o, rays[i].d);
    const int hit = host::triangle_intersect(numbers.data() + 9 * i, &shear, kInf, &t, &w);
    differ +=
        f[0] != hit || !same_bits(f[1], t) || !same_bits(f[2], w.x) || !same_bits(f[3], w.y) || !same_bits(f[4], w.z);
    const Exact x = exact_hit(triangles[i], rays[i]);
    // Unit of error: one rounding at the distance of the vertices, seen along the slanted plane.
    const double unit = kHalfUlp * (v3_length(v3_sub(triangles[i][0], rays[i].o)) + 2.0) / x.cosine;
    const Quad smallest = std::min({x.w[0], x.w[1], x.w[2]});
    if (!(x.cosine > 1e-3) || std::fabs(static_cast<double>(smallest)) < 100 * unit / x.height) {
      ++near_edge;
      continue;
    }
    wrong += (f[0] != 0) != (smallest > 0 && x.t > 0);
    if (f[0] == 0) continue;
    ++hits;
    worst_t = std::max(worst_t, std::fabs(static_cast<double>(f[1] - x.t)) / unit);
    for (int k = 0; k < 3; ++k)
      worst_w = std::max(worst_w, std::fabs(static_cast<double>(f[2 + k] - x.w[k])) * x.height / unit);
    worst_sum = std::max(worst_sum, std::fabs(f[2] + f[3] + f[4] - 1.0));
  }
  MESSAGE(hits << " hits, " << near_edge << " left out; in roundings: t " << worst_t << ", weights " << worst_w);
  CHECK(differ == 0);
  CHECK(wrong == 0);
  CHECK(hits > count / 4);
  CHECK(near_edge < count / 100);
  CHECK(worst_t < 8);  // shear, three vertices and the quotient, a few roundings each: 3.3 seen
  CHECK(worst_w < 4);  // 0.7 seen
  CHECK(worst_sum < 8 * kHalfUlp);
  // Limits at, just below and just above the distance itself.
  for (const int side : {-1, 0, 1}) {
    std::vector<double> limited = flat(rays);
    for (std::size_t i = 0; i < count; ++i)
      limited[7 * i + 6] = side == 0 ? found[5 * i + 1] : std::nextafter(found[5 * i + 1], side * kInf);
    run(kernel, count, in(numbers), in(limited), result);
    const std::vector<double> again = read<double>(result, 5 * count);
    std::size_t unlike = 0;
    for (std::size_t i = 0; i < count; ++i)
      if (found[5 * i] != 0) unlike += (again[5 * i] != 0) != (side >= 0);
    CHECK(unlike == 0);
  }
}
