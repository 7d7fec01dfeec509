// SPDX-License-Identifier: Apache-2.0
// The Ashikhmin-Shirley peak at exponents up to 10⁶ against long double: the kernel's own code, compiled for the host,
// about the top of its lobe, where a rounding of the half vector's cosine would be amplified n times.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernels/brdf_models.hpp"
#include "stability/case.hpp"

namespace clray_test {

namespace {

using Long = long double;
constexpr Long kPiLong = 3.141592653589793238462643383279502884L;
constexpr double kEps = 0x1p-53;
// Roundings, each of at most eps. In the exponent: |n × h|² over h² 9, log1p 4 (2 ulp), times n + 1, 1.
constexpr double kInExponent = 14.0;
// Beside it: exp 2, sF 10 (near grazing, 5 times those of u), the constants' products 5, the cosines and quotients 4.
constexpr double kBeside = 21.0;

struct Peak {
  Long f = 0.0L;
  Long exponent = 0.0L;  ///< (n+1)·log(n·h), which a rounding of its factors is multiplied by
};

/// docs/physics.md, section 2, with d = 0 and F₀ = rho, from the components of the two directions; normal +z. cos^(n+1)
/// is taken by the sine, so long double too loses nothing to cancellation.
Peak exact_peak(Long rho, Long n, const vec3& i, const vec3& o) {
  const Long x = static_cast<Long>(i.x) + o.x, y = static_cast<Long>(i.y) + o.y, z = static_cast<Long>(i.z) + o.z;
  const Long across = x * x + y * y, square = across + z * z, u = 0.5L * std::sqrt(square);
  const Long mu_i = i.z, mu_o = o.z;
  Peak peak;
  peak.exponent = 0.5L * (n + 1.0L) * std::log1p(-across / square);
  const Long fresnel = rho + (1.0L - rho) * std::pow(1.0L - std::min(1.0L, u), 5.0L);
  peak.f = (n + 1.0L) / (4.0L * kPiLong) * fresnel * std::exp(peak.exponent) / (mu_i + mu_o) / std::max(mu_i, mu_o);
  return peak;
}

Outcome lobe(double n) {
  const double rho = 0.5;
  const int row = clray::table_index("brdf", "ashikhmin-shirley");
  const auto& info = clray::table("brdf")[static_cast<std::size_t>(row)];
  const auto model = brdf_test::make_model(row, clray::row_values(info, {{"rho", rho}, {"d", 0.0}, {"n", n}}));
  double worst = 0.0, worst_ratio = 0.0;
  for (double theta : {0.0, 0.5, 1.2, 1.5})
    for (int k = 0; k <= 400; ++k) {
      // Half vectors from the normal to eight lobe widths from it, every way round.
      const double off = 0.02 * k / std::sqrt(n) * std::cos(theta), turn = 2.399963 * k;
      const double tilt_x = off * std::cos(turn), tilt_y = off * std::sin(turn);
      const auto wi = brdf_test::direction(theta, 0.3), mirrored = brdf_test::direction(theta, 0.3 + kPi);
      const vec3 wo = v3_unit(v3(mirrored.x + 2.0 * tilt_x, mirrored.y + 2.0 * tilt_y, mirrored.z));
      if (!(wo.z > 0.0)) continue;
      const double found = model.eval(brdf_kernels::brdf_angles(brdf_test::kUp, wi, wo));
      const Peak exact = exact_peak(rho, n, wi, wo);
      const double off_by = static_cast<double>(std::fabs(found - exact.f) / exact.f);
      worst = std::max(worst, off_by);
      worst_ratio =
          std::max(worst_ratio, off_by / (kEps * (kBeside + kInExponent * static_cast<double>(-exact.exponent))));
    }
  return {worst_ratio <= 1.0 && worst > 0.0, fmt::format("off by {:.1e}, {:.2f} of the bound", worst, worst_ratio)};
}

}  // namespace

std::vector<Case> lobe_cases() {
  std::vector<Case> cases;
  for (double n : {1.0, 10.0, 1e3, 1e4, 1e5, 1e6})
    cases.push_back({"surfaces", fmt::format("peak of n = {:g} to 8 lobe widths", n), "the formula in long double",
                     "eps·(21 + 14·(n+1)·log 1/cos): roundings counted, those of the exponent amplified by it", true,
                     [n] { return lobe(n); }});
  return cases;
}

}  // namespace clray_test
