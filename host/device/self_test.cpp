// SPDX-License-Identifier: Apache-2.0
// The start-up self-test. Some answers are written down: contraction, rounding, Philox's published answers, carries.
// The host computes the rest; it is built without contraction and rounds + - * / sqrt and fma as IEEE 754 says.
#include "device/self_test.hpp"

#include <fmt/format.h>

#include <cmath>

#include "device/buffers.hpp"
#include "device/kernel_cache.hpp"
#include "shared/elementary.h"
#include "shared/philox.h"

namespace clray {
namespace {

constexpr std::size_t kItems = 192;  // three groups of 64
constexpr std::size_t kGroup = 64;
constexpr std::size_t kResults = 13;
constexpr std::size_t kSums = 3;

const char* const kNames[kResults] = {"a*b+c without fusing",
                                      "fma",
                                      "division",
                                      "square root",
                                      "subnormal product",
                                      "subnormal sum",
                                      "rounding to integers",
                                      "Philox",
                                      "Philox",
                                      "exponential function",
                                      "logarithm",
                                      "sine",
                                      "cosine"};

/// Numbers in ±[2^-8, 2^8) with all their bits in use, and a few chosen ones first.
std::vector<f64> inputs() {
  std::vector<f64> in = {
      1.0 + 0x1p-30, 1.0 - 0x1p-30, -1.0,  // a*b+c is 0, fused it is -2^-60
      0x1.8p-31,     3.0,           0.0,   // rounds half to even: 1.5 -> 2
      0x1.4p-30,     -7.0,          1.0,   // 2.5 -> 2
      -0x1.8p-31,    0.1,           1.0,   // -1.5 -> -2
  };
  for (u32 i = 0; in.size() < 3 * kItems; ++i) {
    const u32 counter[4] = {i, 0, 0, 0};
    u32 r[4];
    philox4x32(1, 2, counter, r);
    const u64 mantissa = (static_cast<u64>(r[0]) << 20) ^ r[1];
    const f64 magnitude = std::ldexp(1.0 + static_cast<f64>(mantissa) * 0x1p-52, static_cast<int>(r[2] % 16u) - 8);
    in.push_back((r[3] & 1u) ? magnitude : -magnitude);
  }
  return in;
}

std::vector<u64> expected_results(const std::vector<f64>& in) {
  std::vector<u64> expected;
  for (u32 id = 0; id < kItems; ++id) {
    const f64 a = in[3 * id], b = in[3 * id + 1], c = in[3 * id + 2];
    const f64 product = a * b;
    const f64 tiny = a * 0x1p-1030;
    const f64 tinier = b * 0x1p-1040;
    const i64 whole = static_cast<i64>(std::nearbyint(a * 0x1p31));
    const u32 counter[4] = {id, static_cast<u32>(whole), 0x13198a2eu, 0x03707344u};
    u32 r[4];
    philox4x32(0xa4093822u, id, counter, r);
    for (const f64 value : {product + c, std::fma(a, b, c), a / b, std::sqrt(std::fabs(a)), tiny, tiny + tinier}) {
      expected.push_back(CLRAY_AS_U64(value));
    }
    expected.push_back(static_cast<u64>(whole));
    expected.push_back((static_cast<u64>(r[1]) << 32) | r[0]);
    expected.push_back((static_cast<u64>(r[3]) << 32) | r[2]);
    expected.push_back(CLRAY_AS_U64(el_exp(a)));
    expected.push_back(CLRAY_AS_U64(el_log(std::fabs(b))));
    f64 sine, cosine;
    el_sincos(c, &sine, &cosine);
    expected.push_back(CLRAY_AS_U64(sine));
    expected.push_back(CLRAY_AS_U64(cosine));
  }
  return expected;
}

/// Refuses a host that does not compute as expected itself, for example one built with contraction.
void check_host(const std::vector<u64>& expected) {
  const u32 counter[4] = {0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u};
  u32 r[4];
  philox4x32(0xa4093822u, 0x299f31d0u, counter, r);  // Random123's published answer for the digits of pi
  const bool philox = r[0] == 0xd16cfe09u && r[1] == 0x94fdcceb && r[2] == 0x5001e420u && r[3] == 0x24126ea1u;
  const bool unfused = expected[0] == 0 && expected[1] == CLRAY_AS_U64(-0x1p-60);
  const bool rounding = expected[kResults + 6] == 2 && expected[2 * kResults + 6] == 2 &&
                        expected[3 * kResults + 6] == static_cast<u64>(-2);
  if (!philox || !unfused || !rounding) {
    throw Error(ErrorCode::bug, "the host program was built with unsafe floating-point options", "self-test");
  }
}

std::string hex(u64 bits) {
  return fmt::format("{:016x}", bits);
}

void refuse(const OpenedDevice& opened, const char* what, u64 expected, u64 found) {
  throw Error(ErrorCode::device,
              fmt::format("refused: the start-up self-test found a wrong {} (expected {}, found {})", what,
                          hex(expected), hex(found)),
              opened.info.name);
}

}  // namespace

void run_self_test(OpenedDevice& opened, const KernelFiles& files) {
  static const std::vector<f64> in = inputs();
  static const std::vector<u64> expected = expected_results(in);
  check_host(expected);

  const std::string entry = "device/self_test.cl";
  ProgramOptions options;
  options.defines["CLRAY_SELF_TEST_RESULTS"] = std::to_string(kResults) + "u";
  const std::string source = program_source(opened, entry, options, files);
  const bool embedded = &files == &embedded_kernels();
  const std::string what = "arithmetic\n" + source;
  if (embedded && remembered(opened, what)) return;
  const cl::Program program = build_source(opened, entry, source, false);
  cl::Kernel kernel = make_kernel(opened, program, "self_test");
  const cl::Buffer in_buffer = make_buffer(opened, in);
  const cl::Buffer out_buffer = make_zero_buffer<u64>(opened, kItems * kResults);
  const cl::Buffer sums_buffer = make_zero_buffer<i64>(opened, kSums);
  set_arguments(opened, kernel, in_buffer, out_buffer, sums_buffer, static_cast<cl_uint>(kItems));
  launch(opened, kernel, kItems, kGroup);
  const auto found = read_buffer<u64>(opened, out_buffer, expected.size());
  const auto sums = read_buffer<i64>(opened, sums_buffer, kSums);

  i64 total = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (found[i] != expected[i]) refuse(opened, kNames[i % kResults], expected[i], found[i]);
    if (i % kResults == 6) total += static_cast<i64>(expected[i]);
  }
  const i64 answers[kSums] = {total, -static_cast<i64>(kItems), static_cast<i64>(kItems) * 0xffffffffll};
  for (std::size_t i = 0; i < kSums; ++i) {
    if (sums[i] != answers[i]) refuse(opened, "64-bit sum", static_cast<u64>(answers[i]), static_cast<u64>(sums[i]));
  }
  if (embedded) remember(opened, what);
}

}  // namespace clray
