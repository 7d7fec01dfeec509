// SPDX-License-Identifier: Apache-2.0
// Share of the Sun's disk; see shadow.hpp. The disk is cut into strips that lead to and from the Earth. Along a strip
// the rays that meet the ellipsoid lie between the roots of a quadratic, so that only the sum over the strips is
// numerical.
#include "pass/shadow.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "clray/constants.hpp"
#include "ephemeris/site.hpp"
#include "pass/sun.hpp"

namespace clray::pass {

double visible_share(const Vec3& place_m, const Vec3& sun_m, double sun_radius_m, double radius_m, double flattening) {
  const Vec3 toward = sun_m - place_m;
  const double distance = glm::length(toward);
  const Vec3 d = toward / distance;
  // The ellipsoid is a unit sphere where z is stretched.
  const Vec3 scale(1.0 / radius_m, 1.0 / radius_m, 1.0 / (radius_m * (1.0 - flattening)));
  const auto squeezed = [&](const Vec3& v) { return v * scale; };
  const Vec3 r = squeezed(place_m);
  const double outside = glm::dot(r, r) - 1.0;
  if (outside <= 0.0) return 0.0;  // inside the Earth
  Vec3 across = -place_m + glm::dot(place_m, d) * d;
  // Most places are on the Sun's side, or far beside the shadow.
  const double behind = -glm::dot(place_m, d), spread = 1.02 * (sun_radius_m + radius_m) / distance;
  if (behind <= 0.0 || glm::length(across) > radius_m + spread * behind) return 1.0;
  // Right before or behind the Earth's centre any direction will do.
  if (glm::length(across) < 1e-6 * radius_m)
    across = glm::cross(d, std::fabs(d.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
  const Vec3 e1 = glm::normalize(across), e2 = glm::cross(d, e1);
  const double disk = std::tan(std::asin(sun_radius_m / distance));
  const Vec3 u = squeezed(e1);
  constexpr int kStrips = 512;
  double dark = 0.0, all = 0.0;
  for (int i = 0; i < kStrips; ++i) {
    // Strips at sines of even steps: the disk's edge, where chords shrink like a square root, costs no accuracy.
    const double angle = constants::kPi * ((i + 0.5) / kStrips - 0.5);
    const double half = disk * std::cos(angle);
    const Vec3 m = squeezed(d + disk * std::sin(angle) * e2);
    const double weight = std::cos(angle);
    all += 2.0 * half * weight;
    // A ray m + x u meets the sphere where (r.(m + x u))^2 >= |m + x u|^2 (|r|^2 - 1), and ahead where r.(m + x u) < 0.
    const double rm = glm::dot(r, m), ru = glm::dot(r, u);
    const double a = ru * ru - outside * glm::dot(u, u), b = rm * ru - outside * glm::dot(m, u);
    const double c = rm * rm - outside * glm::dot(m, m), root2 = b * b - a * c;
    // From outside the sphere a is negative for directions toward it, unless the Earth fills more than half of the sky.
    double low = -half, high = half;
    if (root2 <= 0.0) {
      if (a < 0.0) continue;
    } else {
      const double root = std::sqrt(root2), x1 = (-b - root) / a, x2 = (-b + root) / a;
      if (a < 0.0) {
        low = std::max(low, std::min(x1, x2));
        high = std::min(high, std::max(x1, x2));
      } else {
        // Two pieces, one ahead and one behind; e1 leads toward the Earth, so that ahead is the one of large x.
        low = std::max(low, std::max(x1, x2));
      }
    }
    const double middle = rm + 0.5 * (low + high) * ru;
    if (high > low && middle < 0.0) dark += (high - low) * weight;
  }
  return std::clamp(1.0 - dark / all, 0.0, 1.0);
}

double sun_share(const Vec3& place_m, const Vec3& sun_m) {
  return visible_share(place_m, sun_m, kSunRadius_m, ephemeris::kEarthRadius_m, ephemeris::kEarthFlattening);
}

}  // namespace clray::pass
