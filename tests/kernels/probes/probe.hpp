// SPDX-License-Identifier: Apache-2.0
// Running a few lines of OpenCL C over arrays, so that device functions can be compared one by one with a reference.
// The text sees all of kernels/ through #include, flattened as in a real run. Device: CLRAY_TEST_DEVICE, else the CPU.
#ifndef CLRAY_TESTS_PROBE_HPP
#define CLRAY_TESTS_PROBE_HPP

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "device/buffers.hpp"
#include "device/embedded.hpp"
#include "device/platforms.hpp"
#include "device/program.hpp"
#include "shared/portable.h"

namespace probe {

__extension__ typedef __float128 Quad;
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kHalfUlp = 0x1p-53;  ///< relative error of one rounding

inline clray::OpenedDevice& device() {
  static clray::OpenedDevice opened = [] {
    const char* name = std::getenv("CLRAY_TEST_DEVICE");
    return clray::open_device(clray::choose_devices(clray::find_devices(), name ? name : "cpu").front());
  }();
  return opened;
}

/// The kernel `probe` of `text`, which may include any file of kernels/. Compiler warnings are errors.
inline cl::Kernel kernel_of(const std::string& text, const clray::ProgramOptions& options = {}) {
  clray::KernelFiles files = clray::embedded_kernels();
  files["probe.cl"] = text;
  const std::string source = clray::program_source(device(), "probe.cl", options, files);
  return clray::make_kernel(device(), clray::build_source(device(), "probe.cl", source, false), "probe");
}

template <class T>
cl::Buffer in(const std::vector<T>& values) {
  return clray::make_buffer(device(), values);
}
template <class T>
cl::Buffer out(std::size_t count) {
  return clray::make_zero_buffer<T>(device(), count);
}
template <class T>
std::vector<T> read(const cl::Buffer& buffer, std::size_t count) {
  return clray::read_buffer<T>(device(), buffer, count);
}

/// Runs `items` work-items; the kernel's last argument is their number.
template <class... Arguments>
void run(cl::Kernel& kernel, std::size_t items, const Arguments&... arguments) {
  clray::set_arguments(device(), kernel, arguments..., static_cast<cl_uint>(items));
  clray::launch(device(), kernel, items, 64);
}

inline bool same_bits(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof a) == 0;
}

/// |got - exact| in units of the last place of the exact value (of the smallest subnormal below the normal range).
template <class Exact>
double ulp_error(double got, Exact exact) {
  const double rounded = static_cast<double>(exact);
  if (std::isnan(got) && std::isnan(rounded)) return 0.0;
  if (std::isinf(rounded)) {
    if (got == rounded) return 0.0;
    return std::fabs(got) >= std::numeric_limits<double>::max() && (got > 0) == (rounded > 0) ? 1.0 : kInf;
  }
  if (!std::isfinite(got)) return kInf;
  int exponent = -1021;
  if (rounded != 0.0) std::frexp(rounded, &exponent);
  const Exact ulp = static_cast<Exact>(std::ldexp(1.0, std::max(exponent - 53, -1074)));
  return std::fabs(static_cast<double>((static_cast<Exact>(got) - exact) / ulp));
}

/// Numbers with all bits in use.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint32_t word() { return static_cast<std::uint32_t>(engine_()); }
  double uniform() { return double(engine_() >> 11) * 0x1p-53; }
  double between(double a, double b) { return a + (b - a) * uniform(); }
  /// ±2^e·[1, 2), e uniform in [low, high].
  double number(int low, int high) {
    const double x = std::ldexp(1.0 + uniform(), low + int(uniform() * (high - low + 1)));
    return engine_() & 1u ? x : -x;
  }
  vec3 direction() {
    for (;;) {
      const vec3 x = v3(between(-1, 1), between(-1, 1), between(-1, 1));
      const double l = v3_length(x);
      if (l <= 1.0 && l > 0.1) return v3_unit(x);
    }
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace probe

#endif
