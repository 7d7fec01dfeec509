// SPDX-License-Identifier: Apache-2.0
// Sample points and sums as the device makes them. Points against an Owen-scrambled Sobol sequence of its own
// (tests/reference/sobol.cpp); fixed point against exact integer arithmetic; both kinds of 64-bit atomics.
#include <doctest/doctest.h>

#include <set>

#include "beam/sobol.hpp"
#include "kernels/probes/probe.hpp"
#include "reference/sobol.hpp"
#include "shared/abi.h"

namespace {

using namespace probe;
__extension__ typedef __int128 Wide;

struct Draw {
  u32 key0, key1, epoch, replicate, stream, index, group, skip, count;
};

std::vector<Draw> draws() {
  Random random(1);
  std::vector<Draw> all;
  for (u32 i = 0; i < 60000; ++i) {
    const u32 group = i % 20, skip = group == 0 ? 2 : random.word() % 4;
    const u32 index = i % 3 == 0 ? i : random.word();
    all.push_back({random.word(), random.word(), i % 2, random.word() % 64, i % 5 ? 0 : random.word(), index, group,
                   skip, 1 + random.word() % (4 - skip)});
  }
  return all;
}

/// The coordinate by definition: word (d + 2) mod 4 of Philox group (d + 2)/4 scrambles dimension d, or is the sample.
double coordinate(const Draw& d, u32 k, bool sobol, const std::vector<u32>& directions) {
  const u32 dimension = 4 * d.group + d.skip - 2 + k;
  const bool last_inside = 4 * d.group + d.skip - 2 + d.count <= 64;
  const bool scrambled = sobol && last_inside;
  const auto words = clray_reference::philox(
      {d.key0, d.key1}, {d.replicate, d.group | d.epoch << 24, scrambled ? 0xffffffffu : d.index, d.stream});
  u32 bits = words[d.skip + k];
  if (scrambled) {
    u32 x = 0;
    for (u32 j = 0; j < 32; ++j)
      if (d.index >> j & 1u) x ^= directions[32 * dimension + j];
    u32 mirrored = 0;  // directions are stored with their bits reversed
    for (int j = 0; j < 32; ++j) mirrored |= (x >> j & 1u) << (31 - j);
    if (dimension < 2) REQUIRE(mirrored == clray_reference::sobol_bits(d.index, static_cast<int>(dimension)));
    bits = clray_reference::owen_scramble(mirrored, bits);
  }
  return (bits + 0.5) / 4294967296.0;
}

const char* const kDraw = R"(
#include "shared/abi.h"
#include "math/accumulate.cl"
#include "math/sobol.cl"
__kernel void probe(const __global u32 *in, const __global u32 *directions, __global f64 *out, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  const __global u32 *d = in + 9 * i;
  const Sampler s = {d[0], d[1], d[2], d[3], d[4], d[5]};
  f64 u[4] = {-1.0, -1.0, -1.0, -1.0};
  sampler_draw(&s, directions, d[6], d[7], d[8], u);
  for (u32 k = 0; k < 4; ++k) out[4 * i + k] = u[k];
})";

const char* const kFixed = R"(
#include "shared/abi.h"
#include "math/accumulate.cl"
__kernel void probe(const __global f64 *value, __global i64 *out, volatile __global i64 *counters, f64 scale, f64 limit,
                    u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  i64 wide;
  out[2 * i] = to_fixed(value[i], scale, limit, &wide, counters);
  out[2 * i + 1] = wide;
})";

const char* const kSum = R"(
#include "shared/abi.h"
#include "math/accumulate.cl"
__kernel void probe(const __global f64 *value, const __global u32 *at, volatile __global i64 *sums,
                    volatile __global i64 *wide, volatile __global i64 *counters, f64 scale, f64 limit, u32 items) {
  const u32 i = get_global_id(0);
  if (i < items) accumulate(sums, wide, at[i], value[i], scale, limit, counters);
})";

struct Fixed {
  std::int64_t narrow = 0, wide = 0;
  bool overflow = false, non_finite = false;
};

/// By the definition (math/accumulate.cl), in long double: products with powers of two are exact, rintl rounds half to
/// even.
Fixed fixed_by_definition(double value, double scale, double limit, bool wide) {
  Fixed f;
  if (std::isnan(value) || std::isinf(value)) {
    f.non_finite = true;
  } else if (std::fabs(value) <= limit) {
    f.narrow = static_cast<std::int64_t>(std::rint(static_cast<long double>(value) * scale));
  } else {
    const long double q = static_cast<long double>(value) * scale / 4294967296.0L;
    f.overflow = !wide || std::fabs(q) > 274877906944.0L;
    if (!f.overflow) {
      f.wide = static_cast<std::int64_t>(std::rint(q));
      const long double rest =
          static_cast<long double>(value) * scale - static_cast<long double>(f.wide) * 4294967296.0L;
      f.narrow = static_cast<std::int64_t>(std::rint(rest));  // exact in the 64 bits of long double
    }
  }
  return f;
}

clray::ProgramOptions wide_options(bool wide) {
  clray::ProgramOptions options;
  options.defines["CLRAY_WIDE"] = wide ? "1" : "0";
  return options;
}

/// Values about a limit of 2^e: all that a weight can be, and what it must not be.
std::vector<double> values(double limit) {
  std::vector<double> v = {0.0,   -0.0, limit, -limit, std::nextafter(limit, kInf), std::nextafter(limit, 0.0), kNan,
                           -kNan, kInf, -kInf, 5e-324, 1.7976931348623157e308,      -1.7976931348623157e308};
  Random random(4);
  for (int i = 0; i < 40000; ++i) v.push_back(limit * random.between(-1, 1));
  for (int i = 0; i < 4000; ++i) {
    v.push_back(limit * 0x1p-38 * (i - 2000 + 0.5));  // halves: to even
    v.push_back(limit * random.number(-60, -20));
    v.push_back(limit * random.number(0, 40));
    v.push_back(limit * 0x1p-6 * (random.word() + 0.5));  // halves of the wide unit
  }
  return v;
}

}  // namespace

TEST_CASE("sample points on the device are those of the definition, in every dimension") {
  const std::vector<u32> directions = clray::sobol_directions_reversed();
  const std::vector<Draw> all = draws();
  std::vector<u32> flat;
  for (const Draw& d : all)
    flat.insert(flat.end(), {d.key0, d.key1, d.epoch, d.replicate, d.stream, d.index, d.group, d.skip, d.count});
  for (const bool sobol : {true, false}) {
    clray::ProgramOptions options = wide_options(false);
    options.defines["CLRAY_SOBOL"] = sobol ? "1" : "0";
    cl::Kernel kernel = kernel_of(kDraw, options);
    const cl::Buffer result = out<double>(4 * all.size());
    run(kernel, all.size(), in(flat), in(directions), result);
    const std::vector<double> found = read<double>(result, 4 * all.size());
    std::size_t wrong = 0, touched = 0, outside = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      for (u32 k = 0; k < 4; ++k) {
        const double u = found[4 * i + k];
        if (k >= all[i].count) {
          touched += u != -1.0;
          continue;
        }
        wrong += u != coordinate(all[i], k, sobol, directions);
        outside += !(u > 0.0 && u < 1.0);
      }
    CHECK(wrong == 0);
    CHECK(touched == 0);
    CHECK(outside == 0);
  }
}

TEST_CASE("the device's scramble is a nested one: equal leading bits stay equal, cells are filled once") {
  clray::ProgramOptions options = wide_options(false);
  options.defines["CLRAY_SOBOL"] = "1";
  cl::Kernel kernel = kernel_of(kDraw, options);
  const std::size_t points = 4096;
  for (const u32 group : {0u, 1u, 7u, 15u}) {
    std::vector<u32> flat;
    const u32 skip = group == 0 ? 2 : 0, count = 4 - skip;
    for (u32 i = 0; i < points; ++i) flat.insert(flat.end(), {5u, 6u, 0u, 3u, 0u, i, group, skip, count});
    const cl::Buffer result = out<double>(4 * points);
    run(kernel, points, in(flat), in(clray::sobol_directions_reversed()), result);
    const std::vector<double> found = read<double>(result, 4 * points);
    for (u32 k = 0; k < count; ++k)
      for (std::size_t cells : {std::size_t{2}, std::size_t{64}, points}) {
        std::set<std::size_t> seen;
        for (std::size_t i = 0; i < cells; ++i) seen.insert(static_cast<std::size_t>(found[4 * i + k] * cells));
        CHECK(seen.size() == cells);
      }
  }
}

TEST_CASE("fixed point on the device: rounding to even, both scales, and what is counted") {
  for (const bool wide : {true, false})
    for (const int exponent : {-20, -2, 0, 3, 17}) {
      CAPTURE(wide);
      CAPTURE(exponent);
      const double limit = std::ldexp(1.0, exponent), scale = std::ldexp(1.0, 62 - 24 - exponent);
      const std::vector<double> v = values(limit);
      cl::Kernel kernel = kernel_of(kFixed, wide_options(wide));
      const cl::Buffer result = out<i64>(2 * v.size()), counters = out<i64>(CLRAY_COUNTERS);
      run(kernel, v.size(), in(v), result, counters, scale, limit);
      const std::vector<i64> found = read<i64>(result, 2 * v.size()), counted = read<i64>(counters, CLRAY_COUNTERS);
      std::size_t wrong = 0, in_wide = 0;
      i64 overflow = 0, non_finite = 0;
      for (std::size_t i = 0; i < v.size(); ++i) {
        const Fixed f = fixed_by_definition(v[i], scale, limit, wide);
        wrong += found[2 * i] != f.narrow || found[2 * i + 1] != f.wide;
        in_wide += f.wide != 0;
        overflow += f.overflow;
        non_finite += f.non_finite;
      }
      CHECK(wrong == 0);
      CHECK(counted[CLRAY_COUNT_OVERFLOW] == overflow);
      CHECK(counted[CLRAY_COUNT_NON_FINITE] == non_finite);
      CHECK(non_finite == 4);
      CHECK(overflow > 0);
      CHECK((in_wide > 1000) == wide);
    }
}

TEST_CASE("sums on the device are exact, with 64-bit atomics and with pairs of 32-bit ones") {
  const std::size_t slots = 5;
  const double limit = 1.0, scale = 0x1p38;
  std::vector<double> v = values(limit);
  Random random(6);
  for (int i = 0; i < 200000; ++i) v.push_back(random.between(-1, 1) * std::exp2(random.between(-40, 3)));
  std::vector<u32> at;
  std::vector<Wide> narrow(slots, 0), wide(slots, 0);
  for (const double x : v) {
    const Fixed f = fixed_by_definition(x, scale, limit, true);
    at.push_back(random.word() % slots);
    narrow[at.back()] += f.narrow;
    wide[at.back()] += f.wide;
  }
  for (const bool pairs : {false, true}) {
    if (!pairs && !device().int64_atomics) continue;
    CAPTURE(pairs);
    clray::ProgramOptions options = wide_options(true);
    if (pairs) options.defines["CLRAY_NO_INT64_ATOMICS"] = "1";
    cl::Kernel kernel = kernel_of(kSum, options);
    const cl::Buffer sums = out<i64>(slots), wides = out<i64>(slots), counters = out<i64>(CLRAY_COUNTERS);
    run(kernel, v.size(), in(v), in(at), sums, wides, counters, scale, limit);
    const std::vector<i64> found = read<i64>(sums, slots), found_wide = read<i64>(wides, slots);
    for (std::size_t k = 0; k < slots; ++k) {
      CHECK(found[k] == static_cast<i64>(narrow[k]));
      CHECK(found_wide[k] == static_cast<i64>(wide[k]));
    }
  }
}

TEST_CASE("pairs of 32-bit atomics carry and borrow between their words") {
  // Steps of 2^31 and ±1 about multiples of 2^32: the low word overflows at about every other addition.
  std::vector<i64> steps;
  Random random(7);
  i64 sum = 0;
  for (int i = 0; i < 100000; ++i) {
    i64 step = static_cast<i64>(random.word()) << (random.word() % 24);
    if (i % 4 == 0) step = i % 8 ? 1 : -1;
    if (i % 4 == 1) step = -step;
    if (i % 4 == 2) step = 0x80000000ll;
    steps.push_back(step);
    sum += step;
  }
  for (const bool pairs : {false, true}) {
    if (!pairs && !device().int64_atomics) continue;
    CAPTURE(pairs);
    clray::ProgramOptions options;
    if (pairs) options.defines["CLRAY_NO_INT64_ATOMICS"] = "1";
    cl::Kernel kernel = kernel_of(R"(
#include "math/atomic64.cl"
__kernel void probe(const __global i64 *step, volatile __global i64 *sum, u32 items) {
  const u32 i = get_global_id(0);
  if (i < items) atomic_add_i64(sum + (i & 1u), step[i]);
})",
                                  options);
    const cl::Buffer sums = out<i64>(2);
    run(kernel, steps.size(), in(steps), sums);
    const std::vector<i64> found = read<i64>(sums, 2);
    CHECK(found[0] + found[1] == sum);
    i64 even = 0;
    for (std::size_t i = 0; i < steps.size(); i += 2) even += steps[i];
    CHECK(found[0] == even);
  }
}
