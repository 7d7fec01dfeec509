// SPDX-License-Identifier: Apache-2.0
// Every row of shape.def and brdf.def on the device gives the bits that the same file gives on the host, alone in its
// program and among all rows: a compiler that fuses, reorders or approximates shows here. Parameters and rays come
// from the tables, so a new row is tested with no new test code.
#include <doctest/doctest.h>

#include <set>

#include "kernels/brdf_models.hpp"
#include "kernels/probes/probe.hpp"
#include "scene/tables.hpp"

namespace shapes_on_host {
// The shapes come before what chooses among them.
// clang-format off
#include "shape/shape.h"
#include "generated/shape_all.inc"
#include "shape/dispatch.cl"
// clang-format on
}  // namespace shapes_on_host

namespace {

using namespace probe;
using shapes_on_host::ShapeSurface;

constexpr std::size_t kKeys = 8;       // numbers of a shape's record here
constexpr std::size_t kShapeOut = 14;  // found t part, point normal error, support area traits, spare
constexpr std::size_t kBrdfOut = 12;

const char* const kShape = R"(
#include "shared/abi.h"
#include "shared/elementary.h"
#include "shape/shape.h"
#include "generated/shape_all.inc"
#include "shape/dispatch.cl"
__kernel void probe(const __global f64 *keys, const __global u32 *rows, const __global f64 *rays, __global f64 *out,
                    u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  const __global f64 *p = keys + 8 * i, *r = rays + 7 * i;
  const vec3 o = v3_load(r), d = v3_load(r + 3);
  f64 t = -1.0;
  u32 part = 0u;
  __global f64 *q = out + 14 * i;
  q[0] = shape_intersect(rows[i], p, o, d, r[6], &t, &part);
  q[1] = t;
  q[2] = part;
  if (q[0] != 0.0) {
    const ShapeSurface s = shape_surface(rows[i], p, o, d, t, part);
    q[3] = s.point.x;
    q[4] = s.point.y;
    q[5] = s.point.z;
    q[6] = s.normal.x;
    q[7] = s.normal.y;
    q[8] = s.normal.z;
    q[9] = s.error;
  }
  q[10] = shape_support(rows[i], p, d);
  q[11] = shape_area(rows[i], p);
  q[12] = shape_traits(rows[i], p);
})";

const char* const kBrdf = R"(
#include "shared/abi.h"
#include "shared/elementary.h"
#include "brdf/brdf.h"
#include "generated/brdf_all.inc"
#include "brdf/dispatch.cl"
__kernel void probe(const __global ClrayMaterial *materials, const __global f64 *tables, const __global u32 *which,
                    const __global f64 *in, __global f64 *out, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  const __global ClrayMaterial *m = materials + which[i];
  const __global f64 *x = in + 12 * i;
  const BrdfAngles a = brdf_angles(v3_load(x), v3_load(x + 3), v3_load(x + 6));
  __global f64 *q = out + 12 * i;
  q[0] = brdf_eval(m, tables, a);
  q[1] = brdf_pdf(m, tables, a);
  const BrdfSample s = brdf_sample(m, tables, v3_load(x + 3), x[9], x[10], x[11]);
  q[2] = s.wo.x;
  q[3] = s.wo.y;
  q[4] = s.wo.z;
  q[5] = s.ok ? s.weight : 0.0;
  q[6] = s.ok ? s.pdf : 0.0;
  q[7] = s.ok;
  q[8] = s.delta;
  q[9] = a.cos_half;
  q[10] = a.sin2_half;
  q[11] = a.half_length;
})";

/// Values a length or switch may take about its default.
std::vector<double> shape_values(const clray::TableKey& key) {
  if (key.is_switch) return {0.0, 1.0};
  if (key.default_value == 0.0) return {0.0, 0.3};
  return {key.default_value, 0.4 * key.default_value, 3.7 * key.default_value};
}

std::vector<std::vector<double>> shape_sets(const clray::TableRow& row) {
  std::vector<std::vector<double>> sets = {{}};
  for (const auto& key : row.keys) {
    std::vector<std::vector<double>> longer;
    for (const auto& set : sets)
      for (double value : shape_values(key)) {
        longer.push_back(set);
        longer.back().push_back(value);
      }
    sets = longer;
  }
  return sets;
}

struct ShapeInput {
  std::vector<double> keys, rays;
  std::vector<u32> rows;
  void add(u32 row, const std::vector<double>& set, vec3 o, vec3 d, double t_max) {
    rows.push_back(row);
    keys.insert(keys.end(), set.begin(), set.end());
    keys.resize(rows.size() * kKeys, 0.0);
    rays.insert(rays.end(), {o.x, o.y, o.z, d.x, d.y, d.z, t_max});
  }
};

ShapeInput shape_input(u32 row, std::size_t rays_per_set) {
  Random random(row + 1);
  ShapeInput input;
  for (const auto& set : shape_sets(clray::table("shape")[row])) {
    double size = 0.0;  // from the supports along the axes
    for (int k = 0; k < 6; ++k)
      size = std::max(size, shapes_on_host::shape_support(row, set.data(),
                                                          v3(k == 0   ? 1
                                                             : k == 1 ? -1
                                                                      : 0,
                                                             k == 2   ? 1
                                                             : k == 3 ? -1
                                                                      : 0,
                                                             k == 4   ? 1
                                                             : k == 5 ? -1
                                                                      : 0)));
    for (std::size_t k = 0; k < rays_per_set; ++k) {
      const vec3 target = v3_scale(size * random.uniform(), random.direction());
      vec3 o = v3_scale(size * std::exp2(random.between(-2, 8)), random.direction());
      vec3 d = v3_unit(v3_sub(target, o));
      if (k % 8 == 0) {  // along an axis
        const double sign = random.word() & 1 ? 1.0 : -1.0;
        const unsigned axis = random.word() % 3;
        d = v3(axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0);
        o = v3_fma(-4.0 * size, d, target);
      }
      input.add(row, set, o, d, k % 10 == 9 ? size * std::exp2(random.between(-3, 3)) : 1e300);
    }
  }
  return input;
}

std::vector<double> shapes_by_host(const ShapeInput& input) {
  std::vector<double> out(input.rows.size() * kShapeOut, 0.0);
  for (std::size_t i = 0; i < input.rows.size(); ++i) {
    const double *p = input.keys.data() + kKeys * i, *r = input.rays.data() + 7 * i;
    const vec3 o = v3_load(r), d = v3_load(r + 3);
    const u32 row = input.rows[i];
    double t = -1.0, *q = out.data() + kShapeOut * i;
    u32 part = 0;
    q[0] = shapes_on_host::shape_intersect(row, p, o, d, r[6], &t, &part);
    q[1] = t;
    q[2] = part;
    if (q[0] != 0.0) {
      const ShapeSurface s = shapes_on_host::shape_surface(row, p, o, d, t, part);
      const double numbers[7] = {s.point.x, s.point.y, s.point.z, s.normal.x, s.normal.y, s.normal.z, s.error};
      std::copy(numbers, numbers + 7, q + 3);
    }
    q[10] = shapes_on_host::shape_support(row, p, d);
    q[11] = shapes_on_host::shape_area(row, p);
    q[12] = shapes_on_host::shape_traits(row, p);
  }
  return out;
}

std::vector<double> shapes_by_device(const ShapeInput& input, const std::vector<int>& rows) {
  clray::ProgramOptions options;
  options.shapes = rows;
  cl::Kernel kernel = kernel_of(kShape, options);
  const std::size_t count = input.rows.size();
  const cl::Buffer result = out<double>(kShapeOut * count);
  run(kernel, count, in(input.keys), in(input.rows), in(input.rays), result);
  return read<double>(result, kShapeOut * count);
}

struct Difference {
  std::size_t count = 0, first = 0;
};

Difference differences(const std::vector<double>& a, const std::vector<double>& b) {
  Difference d;
  REQUIRE(a.size() == b.size());
  for (std::size_t i = a.size(); i-- > 0;)
    if (!same_bits(a[i], b[i])) {
      ++d.count;
      d.first = i;
    }
  return d;
}

void check_same(const std::vector<double>& device, const std::vector<double>& host, std::size_t stride) {
  const Difference d = differences(device, host);
  CHECK_MESSAGE(d.count == 0, d.count << " numbers differ, the first in column " << d.first % stride << " of item "
                                      << d.first / stride << ": " << device[d.first] << " and " << host[d.first]);
}

struct BrdfInput {
  std::vector<ClrayMaterial> materials;
  std::vector<u32> which;
  std::vector<double> in;
};

/// Sets with all bits in use: products with round numbers are often exact and would hide a rounding.
std::vector<brdf_test::Model> random_models() {
  Random random(41);
  std::vector<brdf_test::Model> all;
  const auto& rows = clray::table("brdf");
  for (int row = 0; row < static_cast<int>(rows.size()); ++row)
    for (int k = 0; k < 8; ++k) {
      std::vector<double> set;
      for (const auto& key : rows[row].keys) {
        const double share = k % 2 ? random.between(0.001, 0.999) : std::exp2(random.between(-12.0, -0.01));
        set.push_back(key.low + share * (key.high - key.low));
      }
      all.push_back(brdf_test::make_model(row, set));
    }
  return all;
}

/// Every parameter set of `row` (all rows if negative) with directions from head-on to grazing, mirrored and back.
BrdfInput brdf_input(int row, std::size_t pairs) {
  Random random(31);
  BrdfInput input;
  std::vector<brdf_test::Model> models = brdf_test::models(false);
  for (const brdf_test::Model& model : random_models()) models.push_back(model);
  for (const brdf_test::Model& model : models) {
    if (row >= 0 && model.material.model != static_cast<u32>(row)) continue;
    input.materials.push_back(model.material);
    for (std::size_t k = 0; k < pairs; ++k) {
      const auto direction = [&] {
        const double z = k % 4 == 0 ? std::exp2(random.between(-40, 0)) : random.between(1e-3, 1.0);
        const double phi = random.between(0.0, 6.3), s = std::sqrt((1.0 - z) * (1.0 + z));
        return v3(s * std::cos(phi), s * std::sin(phi), z);
      };
      const vec3 wi = direction();
      vec3 wo = direction();
      if (k % 5 == 1)
        wo = v3_unit(v3_fma(std::exp2(random.between(-40, -1)), random.direction(), v3(-wi.x, -wi.y, wi.z)));
      if (k % 5 == 2) wo = wi;
      if (k % 5 == 3) wo = v3_unit(v3_fma(std::exp2(random.between(-40, -1)), random.direction(), wi));
      input.which.push_back(static_cast<u32>(input.materials.size() - 1));
      input.in.insert(input.in.end(), {0, 0, 1, wi.x, wi.y, wi.z, wo.x, wo.y, wo.z, random.uniform() * 0.999 + 5e-4,
                                       (random.word() + 0.5) * 0x1p-32, (random.word() + 0.5) * 0x1p-32});
    }
  }
  return input;
}

std::vector<double> brdfs_by_host(const BrdfInput& input) {
  std::vector<double> out(input.which.size() * kBrdfOut);
  const double* tables = brdf_test::sample_table().data();
  for (std::size_t i = 0; i < input.which.size(); ++i) {
    const ClrayMaterial* m = &input.materials[input.which[i]];
    const double* x = input.in.data() + 12 * i;
    const auto a = brdf_test::brdf_angles(v3_load(x), v3_load(x + 3), v3_load(x + 6));
    const auto s = brdf_test::brdf_sample(m, tables, v3_load(x + 3), x[9], x[10], x[11]);
    const double numbers[kBrdfOut] = {brdf_test::brdf_eval(m, tables, a),
                                      brdf_test::brdf_pdf(m, tables, a),
                                      s.wo.x,
                                      s.wo.y,
                                      s.wo.z,
                                      s.ok ? s.weight : 0.0,
                                      s.ok ? s.pdf : 0.0,
                                      double(s.ok),
                                      double(s.delta),
                                      a.cos_half,
                                      a.sin2_half,
                                      a.half_length};
    std::copy(numbers, numbers + kBrdfOut, out.begin() + static_cast<std::ptrdiff_t>(kBrdfOut * i));
  }
  return out;
}

std::vector<double> brdfs_by_device(const BrdfInput& input, const std::vector<int>& rows) {
  clray::ProgramOptions options;
  options.brdfs = rows;
  cl::Kernel kernel = kernel_of(kBrdf, options);
  const std::size_t count = input.which.size();
  const cl::Buffer result = out<double>(kBrdfOut * count);
  run(kernel, count, in(input.materials), in(brdf_test::sample_table()), in(input.which), in(input.in), result);
  return read<double>(result, kBrdfOut * count);
}

}  // namespace

TEST_CASE("every shape on the device has the host's bits, alone and among all") {
  const auto& rows = clray::table("shape");
  std::vector<int> all;
  ShapeInput together;
  for (int row = 0; row < static_cast<int>(rows.size()); ++row) {
    all.push_back(row);
    if (rows[row].id == "triangle") continue;  // tests/kernels/probe_triangle_test.cpp
    CAPTURE(rows[row].id);
    REQUIRE(rows[row].keys.size() <= kKeys);
    const ShapeInput input = shape_input(static_cast<u32>(row), 4000);
    const std::vector<double> host = shapes_by_host(input);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < input.rows.size(); ++i) hits += host[kShapeOut * i] != 0.0;
    CHECK(hits > input.rows.size() / 20);
    check_same(shapes_by_device(input, {row}), host, kShapeOut);
    const ShapeInput few = shape_input(static_cast<u32>(row), 300);
    together.keys.insert(together.keys.end(), few.keys.begin(), few.keys.end());
    together.rays.insert(together.rays.end(), few.rays.begin(), few.rays.end());
    together.rows.insert(together.rows.end(), few.rows.begin(), few.rows.end());
  }
  check_same(shapes_by_device(together, all), shapes_by_host(together), kShapeOut);
}

TEST_CASE("every surface model on the device has the host's bits, alone and among all") {
  const auto& rows = clray::table("brdf");
  std::vector<int> all;
  for (int row = 0; row < static_cast<int>(rows.size()); ++row) {
    all.push_back(row);
    CAPTURE(rows[row].id);
    const BrdfInput input = brdf_input(row, 3000);
    const std::vector<double> host = brdfs_by_host(input);
    std::set<double> distinct;
    for (std::size_t i = 0; i < input.which.size(); ++i) {
      distinct.insert(host[kBrdfOut * i]);
      distinct.insert(host[kBrdfOut * i + 5]);
    }
    CHECK(distinct.size() > 3);
    check_same(brdfs_by_device(input, {row}), host, kBrdfOut);
  }
  const BrdfInput together = brdf_input(-1, 300);
  check_same(brdfs_by_device(together, all), brdfs_by_host(together), kBrdfOut);
}
