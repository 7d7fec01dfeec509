// SPDX-License-Identifier: Apache-2.0
// See closed_forms.hpp.
#include "support/closed_forms.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace clray_test {

using clray::Vec3;

namespace {

double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double clamped(double x, double low, double high) {
  return std::min(std::max(x, low), high);
}

struct Facet {
  double weight;
  std::array<double, 3> delay;  // sorted
};

double share_of_facet(const Facet& f, double t) {
  const auto [a, b, c] = f.delay;
  if (t >= c) return 1.0;
  if (t <= a) return 0.0;
  if (t <= b) return (t - a) * (t - a) / ((b - a) * (c - a));
  return 1.0 - (c - t) * (c - t) / ((c - b) * (c - a));
}

double simpson(const std::function<double(double)>& f, double a, double fa, double b, double fb, double fm,
               double whole, double tolerance, int depth) {
  const double m = 0.5 * (a + b), fl = f(0.5 * (a + m)), fr = f(0.5 * (m + b));
  const double left = (m - a) / 6.0 * (fa + 4.0 * fl + fm), right = (b - m) / 6.0 * (fm + 4.0 * fr + fb);
  const double change = left + right - whole;
  if (depth <= 0 || std::fabs(change) <= 15.0 * tolerance) return left + right + change / 15.0;
  return simpson(f, a, fa, m, fm, fl, left, 0.5 * tolerance, depth - 1) +
         simpson(f, m, fm, b, fb, fr, right, 0.5 * tolerance, depth - 1);
}

}  // namespace

Cdf two_way(const std::function<double(double)>& share_of_depth) {
  return [share_of_depth](double t) { return share_of_depth(0.5 * kLightSpeed * t); };
}

namespace {

/// Sum over the facets that s and o are in front of; `intensity` is A per m² of facet, of the two cosines.
Pulse sum_of_facets(const clray::Mesh& mesh, Vec3 s, Vec3 o, const std::function<double(double, double)>& intensity) {
  std::vector<Facet> facets;
  Pulse pulse;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    const Vec3 n = cross(b - a, c - a);
    const double twice_area = std::sqrt(dot(n, n));
    const double mu_i = dot(n, s) / twice_area, mu_o = dot(n, o) / twice_area;
    if (!(mu_i > 0.0) || !(mu_o > 0.0)) continue;
    Facet f{0.5 * twice_area * intensity(mu_i, mu_o), {}};
    const Vec3 way = s + o;
    f.delay = {-dot(way, a) / kLightSpeed, -dot(way, b) / kLightSpeed, -dot(way, c) / kLightSpeed};
    std::sort(f.delay.begin(), f.delay.end());
    pulse.total_m2_per_sr += f.weight;
    facets.push_back(f);
  }
  const double total = pulse.total_m2_per_sr;
  pulse.share = [facets, total](double t) {
    double sum = 0.0;
    for (const Facet& f : facets) sum += f.weight * share_of_facet(f, t);
    return sum / total;
  };
  return pulse;
}

}  // namespace

Pulse convex_lambert(const clray::Mesh& mesh, double rho, Vec3 s, Vec3 o) {
  return sum_of_facets(mesh, s, o, [rho](double mu_i, double mu_o) { return rho / kPi * mu_i * mu_o; });
}

Pulse monostatic_facets(const clray::Mesh& mesh, Vec3 s, const std::function<double(double)>& intensity) {
  return sum_of_facets(mesh, s, s, [&](double mu, double) { return intensity(mu); });
}

Pulse lambert_sphere(double rho, double radius) {
  return {2.0 * rho * radius * radius / 3.0, two_way([radius](double depth) {
            const double left = 1.0 - clamped((depth + radius) / radius, 0.0, 1.0);
            return 1.0 - left * left * left;
          })};
}

Pulse lambert_disc(double rho, double radius, double tilt) {
  const double mu = std::cos(tilt), half = radius * std::sin(tilt);
  return {rho * radius * radius * mu * mu, two_way([half](double depth) {
            const double y = clamped(depth / half, -1.0, 1.0);
            return 0.5 + (y * std::sqrt(1.0 - y * y) + std::asin(y)) / kPi;
          })};
}

Pulse lambert_plate(double rho, double a, double b, double tilt) {
  const double mu = std::cos(tilt), half = 0.5 * a * std::sin(tilt);
  return {rho / kPi * a * b * mu * mu,
          two_way([half](double depth) { return clamped(0.5 * (depth / half + 1.0), 0.0, 1.0); })};
}

Pulse lambert_cone(double rho, double radius, double height) {
  const double sine = radius / std::hypot(radius, height);
  return {rho * radius * radius * sine, two_way([height](double depth) {
            const double y = clamped((depth + height) / height, 0.0, 1.0);
            return y * y;
          })};
}

Pulse lambert_cylinder_side(double rho, double radius, double length) {
  return {0.5 * rho * length * radius, two_way([radius](double depth) {
            const double phi = std::acos(clamped(-depth / radius, 0.0, 1.0));
            return (phi + std::sin(phi) * std::cos(phi)) / (0.5 * kPi);
          })};
}

double lambert_phase(double alpha) {
  return (std::sin(alpha) + (kPi - alpha) * std::cos(alpha)) / kPi;
}

double ashikhmin_shirley_sphere_specular(double rho, double d, double n, double radius) {
  return 0.25 * radius * radius * (1.0 - d) * rho * (n + 1.0) / (n + 2.0);
}

double ashikhmin_shirley_facet(double rho, double d, double n, double mu) {
  const double g = 1.0 - std::pow(1.0 - 0.5 * mu, 5), s = 1.0 - d;
  return d * 28.0 * rho / (23.0 * kPi) * (1.0 - s * rho) * g * g * mu * mu +
         (n + 1.0) / (8.0 * kPi) * s * rho * std::pow(mu, n + 1.0);
}

double ashikhmin_shirley_sphere(double rho, double d, double n, double radius) {
  const auto diffuse = [](double mu) {
    const double g = 1.0 - std::pow(1.0 - 0.5 * mu, 5);
    return g * g * mu * mu;
  };
  return ashikhmin_shirley_sphere_specular(rho, d, n, radius) + 2.0 * kPi * radius * radius * d * 28.0 * rho /
                                                                    (23.0 * kPi) * (1.0 - (1.0 - d) * rho) *
                                                                    integrate(diffuse, 0.0, 1.0);
}

double integrate(const std::function<double(double)>& f, double a, double b) {
  constexpr int kPieces = 16;
  double sum = 0.0, largest = 0.0;
  for (int i = 0; i <= 64; ++i) largest = std::max(largest, std::fabs(f(a + (b - a) * i / 64)));
  for (int i = 0; i < kPieces; ++i) {
    const double l = a + (b - a) * i / kPieces, h = a + (b - a) * (i + 1) / kPieces, m = 0.5 * (l + h);
    const double fl = f(l), fh = f(h), fm = f(m);
    sum += simpson(f, l, fl, h, fh, fm, (h - l) / 6.0 * (fl + 4.0 * fm + fh), 1e-14 * largest * (b - a), 40);
  }
  return sum;
}

}  // namespace clray_test
