// SPDX-License-Identifier: Apache-2.0
// Elementary functions, vectors and Philox as the device computes them: in ulp of long double or 113-bit arithmetic,
// and bit for bit as the host's. Limits in ulp of elementary functions are those stated in shared/elementary.h.
#include <doctest/doctest.h>

#include <array>
#include <functional>

#include "kernels/probes/probe.hpp"
#include "reference/sobol.hpp"
#include "shared/elementary.h"
#include "shared/philox.h"

namespace {

using namespace probe;
using Long = long double;

const char* const kElementary = R"(
#include "shared/elementary.h"
__kernel void probe(const __global f64 *a, const __global f64 *b, __global f64 *out, u32 which, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  const f64 x = a[i];
  f64 s = 0.0, c = 0.0;
  switch (which) {
    case 0: s = el_exp(x); break;
    case 1: s = el_expm1(x); break;
    case 2: s = el_log(x); break;
    case 3: s = el_log1p(x); break;
    case 4: el_sincos(x, &s, &c); break;
    case 5: el_sincos(x, &c, &s); break;
    case 6: s = el_acos(x); break;
    case 7: s = el_pow(x, b[i]); break;
    default: s = el_atan2(x, b[i]); break;
  }
  out[i] = s;
})";

double host_sin(double x) {
  double s, c;
  el_sincos(x, &s, &c);
  return s;
}
double host_cos(double x) {
  double s, c;
  el_sincos(x, &s, &c);
  return c;
}

struct Function {
  std::string name;
  double low, high;  // of the argument
  double ulp;        // shared/elementary.h
  std::function<double(double, double)> host;
  std::function<Long(Long, Long)> exact;
};

/// In the order of the kernel's cases.
const std::vector<Function>& functions() {
  static const std::vector<Function> all = {
      {"exp", -746, 710, 1, [](double x, double) { return el_exp(x); }, [](Long x, Long) { return std::exp(x); }},
      {"expm1", -746, 710, 2, [](double x, double) { return el_expm1(x); }, [](Long x, Long) { return std::expm1(x); }},
      {"log", 0, 1e308, 1, [](double x, double) { return el_log(x); }, [](Long x, Long) { return std::log(x); }},
      {"log1p", -1, 1e308, 2, [](double x, double) { return el_log1p(x); }, [](Long x, Long) { return std::log1p(x); }},
      {"sin", -1048576, 1048576, 1, [](double x, double) { return host_sin(x); },
       [](Long x, Long) { return std::sin(x); }},
      {"cos", -1048576, 1048576, 1, [](double x, double) { return host_cos(x); },
       [](Long x, Long) { return std::cos(x); }},
      {"acos", -1, 1, 3, [](double x, double) { return el_acos(x); }, [](Long x, Long) { return std::acos(x); }},
      {"pow", 0, 1e6, 2, [](double x, double y) { return el_pow(x, y); },
       [](Long x, Long y) { return std::pow(x, y); }},
      {"atan2", -1e6, 1e6, 2, [](double y, double x) { return el_atan2(y, x); },
       [](Long y, Long x) { return std::atan2(y, x); }}};
  return all;
}

std::vector<double> arguments(const Function& f, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> x;
  for (int i = 0; i < 60000; ++i) {
    x.push_back(random.between(f.low, f.high));
    x.push_back(random.between(std::max(f.low, -2.0), std::min(f.high, 2.0)));
    const double tiny = random.number(-1074, 10);
    if (tiny >= f.low && tiny <= f.high) x.push_back(tiny);
  }
  for (int k = 1; k < 20000; ++k) {
    const double turn = k * 1.57079632679489661923L;  // nearest to multiples of pi/2, where reduction cancels most
    if (turn >= f.low && turn <= f.high) x.push_back(turn);
  }
  return x;
}

}  // namespace

TEST_CASE("elementary functions on the device: within their ulp, and the host's bits") {
  cl::Kernel kernel = kernel_of(kElementary);
  for (std::size_t which = 0; which < functions().size(); ++which) {
    const Function& f = functions()[which];
    CAPTURE(f.name);
    std::vector<double> a = arguments(f, which), b;
    Random random(which + 100);
    const bool power = f.name == "pow";
    for (const double x : a) {
      // Exponents that keep a power within the normal range, where long double is exact enough.
      const double most = power && x > 0.0 && x != 1.0 ? 700.0 / std::fabs(std::log(x)) : 1e6;
      b.push_back(random.between(-most, most));
    }
    const std::size_t finite = a.size();
    for (const double x : {0.0, -0.0, 1.0, -1.0, kInf, -kInf, kNan, 5e-324, 1.7976931348623157e308, 1e10})
      for (const double y : {0.0, -0.0, 1.0, -2.0, kInf, kNan}) {
        a.push_back(x);
        b.push_back(y);
      }
    const cl::Buffer result = out<double>(a.size());
    run(kernel, a.size(), in(a), in(b), result, static_cast<cl_uint>(which));
    const std::vector<double> found = read<double>(result, a.size());
    std::size_t differ = 0;
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      differ += !same_bits(found[i], f.host(a[i], b[i]));
      if (i < finite) worst = std::max(worst, ulp_error(found[i], f.exact(a[i], b[i])));
    }
    MESSAGE(f.name << ": worst " << worst << " ulp of " << a.size());
    CHECK(differ == 0);
    CHECK(worst < f.ulp);
    CHECK(worst > 0.4);  // correctly rounded results lie up to half an ulp off: less means nothing was measured
  }
}

TEST_CASE("a difference of products on the device: 1.5 ulp, and its sign is exact") {
  cl::Kernel kernel = kernel_of(R"(
#include "shared/portable.h"
__kernel void probe(const __global f64 *in, __global f64 *out, u32 items) {
  const u32 i = get_global_id(0);
  if (i < items) out[i] = difference_of_products(in[4 * i], in[4 * i + 1], in[4 * i + 2], in[4 * i + 3]);
})");
  Random random(1);
  std::vector<double> x;
  const std::size_t count = 300000;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = random.number(-60, 60), b = random.number(-60, 60);
    double c = random.number(-60, 60), d = random.number(-60, 60);
    if (i % 3 == 1) {  // nearly equal products: all leading bits cancel
      c = a * (1.0 + random.number(-53, -20));
      d = b * (1.0 - (c / a - 1.0)) * (1.0 + random.number(-60, -50));
    } else if (i % 3 == 2) {  // a few ulp apart, or equal
      c = b;
      d = a;
      for (unsigned k = random.word() % 3; k > 0; --k) d = std::nextafter(d, random.word() % 2 ? kInf : -kInf);
    }
    x.insert(x.end(), {a, b, c, d});
  }
  const cl::Buffer result = out<double>(count);
  run(kernel, count, in(x), result);
  const std::vector<double> found = read<double>(result, count);
  double worst = 0.0;
  std::size_t wrong_sign = 0, zeros = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // 106-bit products are exact in 113 bits; what their difference rounds is 2^-60 ulp of the answer.
    const Quad exact = Quad(x[4 * i]) * x[4 * i + 1] - Quad(x[4 * i + 2]) * x[4 * i + 3];
    worst = std::max(worst, ulp_error(found[i], exact));
    wrong_sign += (found[i] > 0) != (exact > 0) || (found[i] < 0) != (exact < 0);
    zeros += exact == 0;
  }
  MESSAGE("worst " << worst << " ulp; " << zeros << " exact zeros");
  CHECK(worst <= 1.5);
  CHECK(worst > 0.5);
  CHECK(wrong_sign == 0);
  CHECK(zeros > count / 20);
}

TEST_CASE("vector helpers on the device against 113-bit arithmetic") {
  cl::Kernel kernel = kernel_of(R"(
#include "shared/portable.h"
static void put(__global f64 *out, vec3 v) { out[0] = v.x; out[1] = v.y; out[2] = v.z; }
__kernel void probe(const __global f64 *in, __global f64 *out, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  const vec3 a = v3_load(in + 7 * i), b = v3_load(in + 7 * i + 3);
  const f64 s = in[7 * i + 6];
  __global f64 *o = out + 32 * i;
  put(o, v3_add(a, b));
  put(o + 3, v3_sub(a, b));
  put(o + 6, v3_neg(a));
  put(o + 9, v3_scale(s, a));
  put(o + 12, v3_fma(s, b, a));
  put(o + 15, v3_cross(a, b));
  put(o + 18, v3_unit(a));
  vec3 t, n;
  v3_frame(v3_unit(a), &t, &n);
  put(o + 21, t);
  put(o + 24, n);
  o[27] = v3_dot(a, b);
  o[28] = v3_length(a);
  o[29] = f64_min(a.x, b.x);
  o[30] = f64_max(a.x, b.x);
})");
  Random random(2);
  const std::size_t count = 50000;
  std::vector<double> x;
  for (std::size_t i = 0; i < count; ++i) {
    const int spread = i % 2 ? 0 : 40;
    for (int k = 0; k < 7; ++k) x.push_back(random.number(-spread, spread));
    if (i % 5 == 0) x[7 * i + i % 3] = 0.0;
    if (i % 7 == 0) {  // unit vectors near -z, where a naive frame divides by nearly zero
      x[7 * i] = random.number(-40, -2);
      x[7 * i + 1] = random.number(-40, -2);
      x[7 * i + 2] = i % 2 ? -1.0 : 1.0;
    }
    if (i % 11 == 0)
      for (int k = 0; k < 3; ++k) x[7 * i + 3 + k] = x[7 * i + k] * (1.0 + random.number(-52, -30));  // nearly parallel
  }
  const cl::Buffer result = out<double>(32 * count);
  run(kernel, count, in(x), result);
  const std::vector<double> found = read<double>(result, 32 * count);
  double single = 0, cross = 0, unit = 0, dot = 0, length = 0, frame = 0, hand = 0;
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double *v = x.data() + 7 * i, *o = found.data() + 32 * i;
    Quad a[3], b[3], sizes = 0, product = 0, square = 0;
    const Quad s = v[6];
    for (int k = 0; k < 3; ++k) {
      a[k] = v[k];
      b[k] = v[3 + k];
      product += a[k] * b[k];
      sizes += std::fabs(v[k] * v[3 + k]);
      square += a[k] * a[k];
    }
    Quad root = std::sqrt(static_cast<Long>(square));
    root = (root + square / root) / 2;
    for (int k = 0; k < 3; ++k) {
      single =
          std::max({single, ulp_error(o[k], a[k] + b[k]), ulp_error(o[3 + k], a[k] - b[k]), ulp_error(o[6 + k], -a[k]),
                    ulp_error(o[9 + k], s * a[k]), ulp_error(o[12 + k], s * b[k] + a[k])});
      const int p = (k + 1) % 3, q = (k + 2) % 3;
      cross = std::max(cross, ulp_error(o[15 + k], a[p] * b[q] - a[q] * b[p]));
      if (a[k] != 0) unit = std::max(unit, std::fabs(static_cast<double>((o[18 + k] - a[k] / root) * root / a[k])));
    }
    dot = std::max(dot, std::fabs(static_cast<double>((o[27] - product) / sizes)));
    length = std::max(length, std::fabs(static_cast<double>((o[28] - root) / root)));
    chosen += o[29] == std::min(v[0], v[3]) && o[30] == std::max(v[0], v[3]);
    const auto inner = [o](int j, int k) {
      return static_cast<double>(Quad(o[j]) * o[k] + Quad(o[j + 1]) * o[k + 1] + Quad(o[j + 2]) * o[k + 2]);
    };
    for (const auto& [j, k, e] : {std::array<int, 3>{21, 21, 1}, {24, 24, 1}, {21, 24, 0}, {21, 18, 0}, {24, 18, 0}})
      frame = std::max(frame, std::fabs(inner(j, k) - e));
    for (int k = 0; k < 3; ++k) {  // t × b = n
      const int p = (k + 1) % 3, q = (k + 2) % 3;
      hand = std::max(hand, std::fabs(o[21 + p] * o[24 + q] - o[21 + q] * o[24 + p] - o[18 + k]));
    }
  }
  MESSAGE("one operation " << single << " ulp, cross " << cross << " ulp; in half ulps of the size: dot "
                           << dot / kHalfUlp << ", length " << length / kHalfUlp << ", unit " << unit / kHalfUlp
                           << ", frame " << frame / kHalfUlp);
  CHECK(single <= 0.5);
  CHECK(cross <= 1.5);                       // difference_of_products
  CHECK(dot <= 3.0 * kHalfUlp * 1.0001);     // three roundings
  CHECK(length <= 2.5 * kHalfUlp * 1.0001);  // half of three, and the root's own
  CHECK(unit <= 3.5 * kHalfUlp * 1.0001);    // and a division
  CHECK(frame < 16 * kHalfUlp);              // Duff et al. (2017) measure 5e-16
  CHECK(hand < 16 * kHalfUlp);
  CHECK(chosen == count);
}

TEST_CASE("Philox on the device: Random123's known answers, and the reference over arrays") {
  cl::Kernel kernel = kernel_of(R"(
#include "shared/philox.h"
__kernel void probe(const __global u32 *in, __global u32 *out, u32 items) {
  const u32 i = get_global_id(0);
  if (i >= items) return;
  const u32 counter[4] = {in[6 * i], in[6 * i + 1], in[6 * i + 2], in[6 * i + 3]};
  u32 words[4];
  philox4x32(in[6 * i + 4], in[6 * i + 5], counter, words);
  for (u32 k = 0; k < 4; ++k) out[4 * i + k] = words[k];
})");
  std::vector<u32> x(6, 0u);
  x.insert(x.end(), 6, 0xffffffffu);
  x.insert(x.end(), {0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u, 0xa4093822u, 0x299f31d0u});
  const std::vector<u32> known = {0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u, 0x408f276du, 0x41c83b0eu,
                                  0xa20bc7c6u, 0x6d5451fdu, 0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u};
  Random random(3);
  const std::size_t count = 100000;
  while (x.size() < 6 * count) x.push_back(random.word());
  const cl::Buffer result = out<u32>(4 * count);
  run(kernel, count, in(x), result);
  const std::vector<u32> found = read<u32>(result, 4 * count);
  for (std::size_t k = 0; k < known.size(); ++k) CHECK(found[k] == known[k]);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const u32* v = x.data() + 6 * i;
    const auto expected = clray_reference::philox({v[4], v[5]}, {v[0], v[1], v[2], v[3]});
    for (std::size_t k = 0; k < 4; ++k) wrong += found[4 * i + k] != expected[k];
  }
  CHECK(wrong == 0);
}
