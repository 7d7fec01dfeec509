// SPDX-License-Identifier: Apache-2.0
// Ashikhmin-Shirley at the ends of its parameters: finite, not negative, within the energy that fell in, and the
// narrow peak's total against its closed form.
#include <fmt/format.h>

#include <cmath>

#include "stability/case.hpp"

namespace clray_test {

using clray::Scene;

namespace {

Outcome corners() {
  int runs = 0;
  std::string broken;
  for (double d : {0.0, 1.0})
    for (double rho : {0.0, 1.0})
      for (double n : {0.0, 1.0, 10.0, 1e3, 1e4, 1e6}) {
        Scene scene = scene_of("sphere", {{"radius", 1.0}}, ashikhmin_shirley(rho, d, n));
        detect(scene, "pressure");
        scene.detectors.insert(scene.detectors.begin(), clray::DetectorSpec{"delay", "delay", {}});
        const clray::Result result = run(rays(scene, 14));
        const clray::DelayResult& a = result.delay.at(0);
        std::string why;
        bool good = sound(result, &why) && std::isfinite(a.intensity_m2_per_sr.value);
        for (double bin : a.bin_m2_per_sr) good = good && bin >= 0.0;
        const clray::PressureResult& p = result.pressure.at(0);
        // Absorbed share between none and all, within its error: nothing reflects more than it gets.
        good = good && p.absorbed_m2.value >= -4.0 * p.absorbed_m2.standard_error - 1e-9;
        good = good && p.absorbed_m2.value <= kPi + 4.0 * p.absorbed_m2.standard_error + 1e-9;
        if (!good) broken += fmt::format(" d={} rho={} n={}{}", d, rho, n, why);
        ++runs;
      }
  return {broken.empty(), fmt::format("{} spheres{}", runs, broken.empty() ? "" : ", broken:" + broken)};
}

Outcome peak(double n, int log2_rays) {
  Scene scene = scene_of("sphere", {{"radius", 1.0}}, ashikhmin_shirley(0.5, 0.0, n));
  const clray::Result result = run(rays(scene, log2_rays));
  const clray::Estimate& a = result.delay.at(0).intensity_m2_per_sr;
  return near(a.value, a.standard_error, ashikhmin_shirley_sphere_specular(0.5, 0.0, n, 1.0), 1e-10);
}

/// A mirror-like plate seen from the mirror direction: the peak's height has a closed form for every n.
Outcome plate_peak(double n) {
  const double theta = radians(30.0), rho = 0.5;
  Scene scene = scene_of(plate_mesh(1, 1), ashikhmin_shirley(rho, 0.0, n));
  bistatic(scene, toward(theta), toward(-theta));
  const clray::Result result = run(rays(scene, 12));
  const double mu = std::cos(theta);
  const double fresnel = rho + (1.0 - rho) * std::pow(1.0 - mu, 5);
  const double exact = (n + 1.0) / (8.0 * kPi) / (mu * mu) * fresnel * mu * mu;
  const clray::Estimate& a = result.delay.at(0).intensity_m2_per_sr;
  // The half vector is off the normal by ε: (1 − ε²)^n; sums are kept to 2^-37 of the bound.
  return near(a.value, a.standard_error, exact, 1e-10);
}

}  // namespace

std::vector<Case> surface_cases() {
  const char* const kFour = "4 standard errors + 1e-10";
  std::vector<Case> cases = {{"surfaces", "d, rho ∈ {0, 1}, n ∈ {0, 1, 10, 10³, 10⁴, 10⁶}",
                              "finite, no bin below zero, absorbed between none and all",
                              "exact; absorbed within 4 standard errors", true, corners}};
  for (double n : {1e3, 1e5})
    cases.push_back({"surfaces", fmt::format("sphere with a peak of n = {:g}", n), "R²/4·F₀·(n+1)/(n+2)", kFour, true,
                     [n] { return peak(n, 20); }});
  cases.push_back({"surfaces", "sphere with a peak of n = 1e6, 2^23 rays", "R²/4·F₀·(n+1)/(n+2)", kFour, false,
                   [] { return peak(1e6, 23); }});
  for (double n : {1.0, 1e3, 1e6})
    cases.push_back({"surfaces", fmt::format("plate at the top of its peak, n = {:g}", n), "(n+1)/8π·F",
                     "1e-10: rounding, and half a unit of the sums", true, [n] { return plate_peak(n); }});
  return cases;
}

}  // namespace clray_test
