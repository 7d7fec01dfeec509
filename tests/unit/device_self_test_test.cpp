// SPDX-License-Identifier: Apache-2.0
// The start-up self-test passes here, and refuses a device that computes otherwise (played by edits of the
// kernel's text).
#include <doctest/doctest.h>

#include <chrono>
#include <cstdint>

#include "device/buffers.hpp"
#include "device/embedded.hpp"
#include "device/platforms.hpp"
#include "device/program.hpp"
#include "device/self_test.hpp"
#include "support/sanitized.hpp"
#include "unit/device_support.hpp"

using namespace clray;
using clray::test::files_with_fault;
using clray::test::opened_cpu;

namespace {

/// What the self-test says when `text` in kernel file `path` reads `fault` instead.
std::string refusal(const std::string& path, const std::string& text, const std::string& fault) {
  static OpenedDevice opened = opened_cpu();  // one context: each reads the driver's library of built-in functions
  const KernelFiles files = files_with_fault(path, text, fault);
  try {
    run_self_test(opened, files);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::device);
    CHECK(error.context() == opened.info.name);
    return error.message();
  }
  return "passed";
}

void check_refused(const std::string& path, const std::string& text, const std::string& fault,
                   const std::string& what) {
  const std::string message = refusal(path, text, fault);
  INFO(message);
  CHECK(message.find("refused: the start-up self-test found a wrong " + what) == 0);
}

}  // namespace

TEST_CASE("the self-test passes on this machine's CPU, and a Device opens") {
  CHECK_NOTHROW(Device("cpu"));
  CHECK(Device("cpu").info().fp64);
}

TEST_CASE("the self-test passes with the 32-bit pair in place of 64-bit atomics") {
  OpenedDevice opened = opened_cpu();
  opened.defines["CLRAY_NO_INT64_ATOMICS"] = "1";
  // Files of its own: for the embedded ones it may be remembered, and then nothing is built.
  CHECK_NOTHROW(run_self_test(opened, KernelFiles(embedded_kernels())));
  REQUIRE(opened.programs.size() == 1);
  CHECK(opened.programs.begin()->first.find("EXTENSION cl_khr_int64_base_atomics") == std::string::npos);
}

TEST_CASE("the self-test refuses a device that computes otherwise") {
  const std::string entry = "device/self_test.cl";
  check_refused(entry, "a * b + c)", "fma(a, b, c))", "a*b+c without fusing");
  check_refused(entry, "fma(a, b, c)", "(a * b + c)", "fma");
  check_refused(entry, "a / b", "a * (1.0 / b)", "division");
  check_refused(entry, "sqrt(fabs(a))", "convert_double(sqrt(convert_float(fabs(a))))", "square root");
  check_refused(entry, "CLRAY_AS_U64(tiny)", "(fabs(tiny) < 0x1p-1022 ? 0 : CLRAY_AS_U64(tiny))", "subnormal product");
  check_refused(entry, "convert_long_rte(a", "convert_long_rtz(a", "rounding to integers");
  check_refused(entry, "el_exp(a)", "exp(a)", "exponential function");
  check_refused(entry, "el_log(fabs(b))", "log(fabs(b))", "logarithm");
  check_refused(entry, "el_sincos(c, &sine, &cosine)", "sine = sincos(c, &cosine)", "");
  check_refused("shared/philox.h", "round < 10", "round < 9", "Philox");
  check_refused("math/atomic64.cl", "atom_add(p, v)", "atom_add(p, (i64)(i32)v)", "64-bit sum");
}

TEST_CASE("the 32-bit pair gives the sums of the 64-bit atomics") {
  const std::string kernel =
      "#include \"math/atomic64.cl\"\n"
      "__kernel void add(const __global i64 *values, volatile __global i64 *sums, u32 n) {\n"
      "  const u32 id = (u32)get_global_id(0);\n"
      "  if (id < n) atomic_add_i64(sums + id % 3u, values[id]);\n"
      "}\n";
  KernelFiles files = embedded_kernels();
  files["test.cl"] = kernel;
  constexpr std::size_t kCount = 10007;
  std::vector<std::int64_t> values(kCount), expected(3, 0);
  std::uint64_t state = 1;
  for (std::size_t i = 0; i < kCount; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    values[i] = static_cast<std::int64_t>(state) >> (8 + state % 40);  // of both signs and all sizes
    expected[i % 3] += values[i];
  }
  for (const bool pair : {false, true}) {
    OpenedDevice opened = opened_cpu();
    ProgramOptions options;
    options.defines = opened.defines;
    if (pair) options.defines["CLRAY_NO_INT64_ATOMICS"] = "1";
    const auto program = build_source(opened, "test.cl", flatten("test.cl", options, files), true);
    cl::Kernel add = make_kernel(opened, program, "add");
    const cl::Buffer in = make_buffer(opened, values);
    const cl::Buffer sums = make_zero_buffer<std::int64_t>(opened, 3);
    set_arguments(opened, add, in, sums, static_cast<cl_uint>(kCount));
    const cl::Event event = launch(opened, add, kCount, 64);
    CHECK(read_buffer<std::int64_t>(opened, sums, 3) == expected);
    CHECK(seconds_of(opened, event) > 0.0);
  }
}

TEST_CASE("a warm self-test is quick") {
  OpenedDevice first = opened_cpu();
  run_self_test(first);  // remembers that it passed
  double best_s = 1e9;
  for (int i = 0; i < 5; ++i) {
    OpenedDevice opened = opened_cpu();
    const auto start = std::chrono::steady_clock::now();
    run_self_test(opened);
    best_s = std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  MESSAGE("warm self-test: " << 1000.0 * best_s << " ms");
  CHECK((best_s < 0.005 || clray_test::kSanitized));
}
