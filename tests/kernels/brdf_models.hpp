// SPDX-License-Identifier: Apache-2.0
// All surface models for the tests: the portable kernel files compiled for the host, parameter sets made from the rows
// of brdf.def (defaults, ends and decades of each key, all corners), and a quadrature over the hemisphere of its own.
// A new row is tested with no new test code.
#ifndef CLRAY_TESTS_BRDF_MODELS_HPP
#define CLRAY_TESTS_BRDF_MODELS_HPP

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "scene/tables.hpp"
#include "shared/abi.h"
#include "shared/elementary.h"

namespace brdf_kernels {
// The models come before what chooses among them.
// clang-format off
#include "brdf/brdf.h"
#include "generated/brdf_all.inc"
#include "brdf/dispatch.cl"
// clang-format on
}  // namespace brdf_kernels

namespace brdf_test {

using namespace brdf_kernels;

constexpr double kPi = 3.14159265358979323846;
const vec3 kUp = v3(0.0, 0.0, 1.0);

inline vec3 direction(double theta, double phi) {
  return v3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
}
inline vec3 incident(double mu) {
  return v3(std::sqrt((1.0 - mu) * (1.0 + mu)), 0.0, mu);
}

/// A smooth table, symmetric in theta_i and theta_o on equal axes (so reciprocal) and independent of phi at normal
/// incidence, for the rows that read one.
inline const std::vector<double>& sample_table() {
  static const std::vector<double> table = [] {
    const int n = 7, n_phi = 5;
    std::vector<double> t = {double(n), double(n), double(n_phi)};
    for (int axis = 0; axis < 2; ++axis)
      for (int k = 0; k < n; ++k) t.push_back(k * 1.5 / (n - 1));
    for (int k = 0; k < n_phi; ++k) t.push_back(k * kPi / (n_phi - 1));
    for (int i = 0; i < n; ++i)
      for (int o = 0; o < n; ++o)
        for (int k = 0; k < n_phi; ++k)
          t.push_back(0.15 + 0.05 * std::cos(0.3 * (i + o)) + 0.004 * i * o * std::cos(k * kPi / (n_phi - 1)) / n);
    return t;
  }();
  return table;
}

struct Model {
  std::string name;
  ClrayMaterial material;

  double eval(const BrdfAngles& a) const { return brdf_eval(&material, sample_table().data(), a); }
  double pdf(const BrdfAngles& a) const { return brdf_pdf(&material, sample_table().data(), a); }
  double reflectance(double mu) const { return brdf_reflectance(&material, sample_table().data(), mu); }
  double bound(double u) const { return brdf_bound(&material, sample_table().data(), u); }
  BrdfSample sample(vec3 wi, double u0, double u1, double u2) const {
    return brdf_sample(&material, sample_table().data(), wi, u0, u1, u2);
  }
  bool is_delta() const { return sample(kUp, 0.5, 0.5, 0.5).delta; }
};

inline Model make_model(int row, const std::vector<double>& values) {
  const auto& info = clray::table("brdf")[row];
  Model model;
  model.material = ClrayMaterial{};
  model.material.model = static_cast<u32>(row);
  model.name = info.name;
  for (std::size_t k = 0; k < values.size(); ++k) {
    model.material.p[k] = values[k];
    model.name += " " + info.keys[k].name + "=" + std::to_string(values[k]);
  }
  return model;
}

/// Values a key may have: its ends (just inside where open), middle, and decades where it spans many.
inline std::vector<double> key_values(const clray::TableKey& key) {
  const double span = key.high - key.low;
  const double low = key.low_included ? key.low : key.low + 0.03 * span;
  const double high = key.high_included ? key.high : key.high - 0.03 * span;
  std::vector<double> values = {low, high, 0.5 * (low + high)};
  if (span > 1000.0)
    for (double v = 1.0; v < high; v *= 10.0) values.push_back(v);
  if (low > 0.0)
    for (double v = 10.0 * low; v < high; v *= 10.0) values.push_back(v);
  return values;
}

/// Defaults and one key changed at a time; with `corners` also every combination of the ends.
inline std::vector<Model> models(bool corners) {
  std::vector<Model> all;
  const auto& rows = clray::table("brdf");
  for (int row = 0; row < static_cast<int>(rows.size()); ++row) {
    const auto& keys = rows[row].keys;
    const std::vector<double> defaults = clray::row_values(rows[row], {});
    std::set<std::vector<double>> sets = {defaults};
    for (std::size_t k = 0; k < keys.size(); ++k)
      for (double value : key_values(keys[k])) {
        sets.insert(clray::row_values(rows[row], {{keys[k].name, value}}));
        std::vector<double> changed = defaults;
        changed[k] = value;
        sets.insert(changed);
      }
    for (unsigned corner = 0; corners && corner < (1u << keys.size()); ++corner) {
      std::vector<double> set = defaults;
      for (std::size_t k = 0; k < keys.size(); ++k) set[k] = key_values(keys[k])[(corner >> k) & 1u];
      sets.insert(set);
    }
    for (const auto& set : sets) all.push_back(make_model(row, set));
  }
  return all;
}

/// Nodes and weights of 16-point Gauss-Legendre on [-1, 1], found by Newton's method.
inline const std::vector<std::pair<double, double>>& gauss_rule() {
  static const std::vector<std::pair<double, double>> rule = [] {
    const int n = 16;
    std::vector<std::pair<double, double>> r;
    for (int i = 0; i < n; ++i) {
      long double x = std::cos(kPi * (i + 0.75) / (n + 0.5)), slope = 0.0L;
      for (int iteration = 0; iteration < 20; ++iteration) {
        long double p0 = 1.0L, p1 = x;
        for (int k = 2; k <= n; ++k) {
          const long double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
          p0 = p1;
          p1 = p2;
        }
        slope = n * (x * p1 - p0) / (x * x - 1.0L);
        x -= p1 / slope;
      }
      r.emplace_back(static_cast<double>(x), static_cast<double>(2.0L / ((1.0L - x * x) * slope * slope)));
    }
    return r;
  }();
  return rule;
}

/// Ends of pieces of [low, high], finer by powers of `ratio` toward each centre, down to `finest`.
inline std::vector<double> graded(double low, double high, const std::vector<double>& centres, double finest,
                                  double ratio) {
  std::set<double> ends = {low, high};
  for (double c : centres) {
    if (c > low && c < high) ends.insert(c);
    for (double step = high - low; step > finest; step /= ratio)
      for (double x : {c - step, c + step})
        if (x > low && x < high) ends.insert(x);
  }
  std::vector<double> pieces;
  for (double x : ends)  // no slivers
    if (pieces.empty() || x - pieces.back() > 0.05 * finest || x == high) pieces.push_back(x);
  return pieces;
}

/// Pieces of the hemisphere of wo for light from elevation mu: graded in theta toward 0, the light's elevation and the
/// horizon, in phi (folded to [0, pi]) toward both sides of the plane of incidence. Peaks lie only there.
struct Cells {
  std::vector<double> theta, phi;
  explicit Cells(double mu, double finest = 1e-4, double ratio = 3.0)
      : theta(graded(0.0, kPi / 2, {0.0, std::acos(mu), kPi / 2}, finest, ratio)),
        phi(graded(0.0, kPi, {0.0, kPi}, finest, ratio)) {
    // A table has kinks at its nodes.
    for (int k = 1; k <= 6; ++k) theta.push_back(sample_table()[3 + k]);
    for (int k = 1; k <= 3; ++k) phi.push_back(k * kPi / 4);
    std::sort(theta.begin(), theta.end());
    std::sort(phi.begin(), phi.end());
  }
  std::size_t size() const { return (theta.size() - 1) * (phi.size() - 1); }
  std::size_t of(double t, double p) const {
    const auto index = [](const std::vector<double>& ends, double x) {
      const auto above = std::upper_bound(ends.begin() + 1, ends.end() - 1, x);
      return static_cast<std::size_t>(above - ends.begin() - 1);
    };
    return index(theta, t) * (phi.size() - 1) + index(phi, p);
  }
  /// Integral of f(angles)·sin(theta) dtheta dphi over each piece and its mirror image at -phi.
  std::vector<double> integrals(double mu, const std::function<double(const BrdfAngles&)>& f) const {
    std::vector<double> result;
    const vec3 wi = incident(mu);
    for (std::size_t i = 0; i + 1 < theta.size(); ++i)
      for (std::size_t j = 0; j + 1 < phi.size(); ++j) {
        double sum = 0.0;
        for (auto [x, w] : gauss_rule())
          for (auto [y, v] : gauss_rule()) {
            const double t = 0.5 * (theta[i] + theta[i + 1]) + 0.5 * x * (theta[i + 1] - theta[i]);
            const double p = 0.5 * (phi[j] + phi[j + 1]) + 0.5 * y * (phi[j + 1] - phi[j]);
            sum += w * v * std::sin(t) * f(brdf_angles(kUp, wi, direction(t, p)));
          }
        result.push_back(sum * 0.5 * (theta[i + 1] - theta[i]) * (phi[j + 1] - phi[j]));
      }
    return result;
  }
  double integral(double mu, const std::function<double(const BrdfAngles&)>& f) const {
    double sum = 0.0;
    for (double part : integrals(mu, f)) sum += part;
    return sum;
  }
};

}  // namespace brdf_test

#endif
