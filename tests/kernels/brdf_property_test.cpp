// SPDX-License-Identifier: Apache-2.0
// What every surface model must do, over all rows of brdf.def and the parameter sets that brdf_models.hpp makes of
// them: reciprocity, energy, agreement of eval, sample, pdf, reflectance and bound, and finite numbers everywhere.
#include <algorithm>
#include <random>

#include "doctest/doctest.h"
#include "kernels/brdf_models.hpp"

using namespace brdf_test;

namespace {

vec3 random_direction(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double z = std::max(1e-12, uniform(random));
  const double mu = uniform(random) < 0.2 ? 1e-6 * z : z;
  const double phi = 2.0 * kPi * uniform(random);
  const double r = std::sqrt((1.0 - mu) * (1.0 + mu));
  return v3(r * std::cos(phi), r * std::sin(phi), mu);
}

/// A direction near the mirror image of w, so that narrow peaks are met.
vec3 near_mirror(std::mt19937_64& random, vec3 w, double spread) {
  std::normal_distribution<double> normal(0.0, spread);
  const vec3 v = v3_unit(v3(-w.x + normal(random), -w.y + normal(random), w.z + normal(random)));
  return v.z > 0.0 ? v : v3(-w.x, -w.y, w.z);
}

constexpr double kSpreads[] = {1.0, 0.1, 0.01, 1e-3, 1e-4};

}  // namespace

TEST_CASE("every model is reciprocal") {
  // Both orders see the same half vector; what is left are roundings of sums of products: 1e-13 covers their count.
  std::mt19937_64 random(1);
  for (const Model& m : models(true)) {
    INFO(m.name);
    double worst = 0.0;
    for (int k = 0; k < 2000; ++k) {
      const vec3 wi = random_direction(random);
      const vec3 wo = k % 2 ? random_direction(random) : near_mirror(random, wi, kSpreads[k % 5]);
      const double f = m.eval(brdf_angles(kUp, wi, wo)), g = m.eval(brdf_angles(kUp, wo, wi));
      REQUIRE(f >= 0.0);
      if (f + g > 1e-250) worst = std::max(worst, std::fabs(f - g) / (f + g));
    }
    CHECK(worst < 1e-13);
  }
}

TEST_CASE("reflectance is within [0,1] and equals an independent quadrature of eval") {
  // Tolerance: 1e-9 (2e-11 was seen), relative to at least 1e-6.
  double worst = 0.0;
  std::string where;
  for (const Model& m : models(false)) {
    INFO(m.name);
    for (double mu : {1e-5, 0.0, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.999, 1.0}) {
      const double r = m.reflectance(mu);
      CHECK(r >= 0.0);
      CHECK(r <= 1.0 + 1e-12);
    }
    if (m.is_delta()) continue;
    for (double mu : {1.0, 0.9, 0.37, 0.05}) {
      CAPTURE(mu);
      const double r = m.reflectance(mu);
      const double q = Cells(mu).integral(mu, [&](const BrdfAngles& a) { return m.eval(a) * a.mu_o; });
      const double error = std::fabs(r - q) / std::max(q, 1e-6);
      CHECK(error < 1e-9);
      if (error > worst) {
        worst = error;
        where = m.name + " at " + std::to_string(mu);
      }
    }
  }
  MESSAGE("worst relative difference " << worst << ": " << where);
}

TEST_CASE("energy stays below 1 at every corner of the parameters") {
  for (const Model& m : models(true)) {
    INFO(m.name);
    for (double mu : {1e-7, 1e-3, 1.0 / 128, 0.1, 0.3, 0.6, 0.95, 1.0}) {
      CAPTURE(mu);
      const double r = m.reflectance(mu);
      CHECK(r >= 0.0);
      CHECK(r <= 1.0 + 1e-9);
    }
  }
}

TEST_CASE("sampled weight is eval times cosine over pdf, its mean the reflectance") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const Model& m : models(false)) {
    INFO(m.name);
    for (double mu : {1.0, 0.6, 0.05}) {
      CAPTURE(mu);
      const vec3 wi = incident(mu);
      const int count = 200000;
      double sum = 0.0, sum2 = 0.0, worst = 0.0, worst_pdf = 0.0, worst_length = 0.0;
      int wrong_failures = 0, below = 0, wrong_mirrors = 0;
      for (int k = 0; k < count; ++k) {
        const double lobe = uniform(random), u = uniform(random), v = uniform(random);  // in this order everywhere
        const BrdfSample s = m.sample(wi, lobe, u, v);
        if (!s.ok) {
          wrong_failures += !(s.weight == 0.0);
          continue;
        }
        const BrdfAngles a = brdf_angles(kUp, wi, s.wo);
        below += !(s.wo.z > 0.0);
        worst_length = std::fmax(worst_length, std::fabs(v3_length(s.wo) - 1.0));
        sum += s.weight;
        sum2 += s.weight * s.weight;
        if (s.delta) {
          wrong_mirrors +=
              !(a.sin2_half < 1e-30 && s.weight == m.reflectance(mu) && m.eval(a) == 0.0 && m.pdf(a) == 0.0);
          continue;
        }
        const double pdf = m.pdf(a);
        worst_pdf = std::max(worst_pdf, std::isfinite(s.pdf) ? std::fabs(s.pdf - pdf) / pdf : 1.0);
        worst = std::max(worst, std::fabs(s.weight * s.pdf - m.eval(a) * a.mu_o) / std::max(1e-300, s.weight * s.pdf));
      }
      CHECK(worst < 1e-13);
      CHECK(worst_pdf < 1e-13);
      CHECK(worst_length < 1e-15);
      CHECK(wrong_failures == 0);
      CHECK(below == 0);
      CHECK(wrong_mirrors == 0);
      const double mean = sum / count, error = std::sqrt(std::max(0.0, sum2 / count - mean * mean) / count);
      // 6 standard errors; 1e-5 for rare large weights that a small sample may miss. What happens once in 10,000 draws
      // happens 20 times here, so that the error knows of it.
      CHECK(std::fabs(mean - m.reflectance(mu)) <= 6.0 * error + 1e-5);
    }
  }
}

TEST_CASE("white-sky reflectance: quadrature of reflectance against sampled light from the whole sky") {
  // 6 standard errors of 200,000 cosine-weighted directions of light with a sampled reflection each.
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const Model& m : models(false)) {
    INFO(m.name);
    const int count = 200000;
    double sum = 0.0, sum2 = 0.0;
    for (int k = 0; k < count; ++k) {
      const vec3 wi = incident(std::sqrt(uniform(random)));
      const double w = m.sample(wi, uniform(random), uniform(random), uniform(random)).weight;
      sum += w;
      sum2 += w * w;
    }
    const double mean = sum / count, error = std::sqrt(std::max(0.0, sum2 / count - mean * mean) / count);
    double white = 0.0;
    const std::vector<double> ends = graded(0.0, 1.0, {0.0, 1.0}, 1e-3, 4.0);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
      for (auto [x, w] : gauss_rule()) {
        const double mu = 0.5 * (ends[i] + ends[i + 1]) + 0.5 * x * (ends[i + 1] - ends[i]);
        white += w * (ends[i + 1] - ends[i]) * mu * m.reflectance(mu);
      }
    CHECK(std::fabs(white - mean) <= 6.0 * error + 1e-12);
  }
}

TEST_CASE("the bound holds over all normals") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const Model& m : models(true)) {
    INFO(m.name);
    double worst = 0.0;
    for (int k = 0; k < 4000; ++k) {
      const vec3 wi = random_direction(random);
      const vec3 wo = k % 2 ? random_direction(random) : near_mirror(random, wi, kSpreads[k % 5]);
      const BrdfAngles a = brdf_angles(kUp, wi, wo);
      if (a.half_length < 2e-3) continue;
      const double bound = m.bound(0.5 * a.half_length);
      REQUIRE(std::isfinite(bound));
      REQUIRE(bound > 0.0);
      worst = std::max(worst, m.eval(a) * a.mu_o / bound);
    }
    CHECK(worst <= 1.0 + 1e-12);
    for (double u : {0.0, 1e-9, 1.0}) {
      CHECK(std::isfinite(m.bound(u)));
      CHECK(m.bound(u) > 0.0);
    }
  }
}

TEST_CASE("a row states the traits of its model: delta, bounded") {
  for (const Model& m : models(true)) {
    INFO(m.name);
    const clray::TableRow& row = clray::table("brdf")[m.material.model];
    CHECK(m.is_delta() == row.delta);
    // With "the bound holds over all normals": one number for every pair of directions.
    if (row.bounded)
      for (double u : {0.0, 1e-9, 0.3, 0.7, 1.0}) CHECK(m.bound(u) == m.bound(1.0));
  }
}

TEST_CASE("numbers are finite and not negative up to 89.99999 degrees and at the ends of the uniforms") {
  std::vector<double> mus = {1.0, 1.0 - 1e-16, 0.5, 1e-3, std::cos(89.99999 * kPi / 180.0), 1e-15, 1e-160};
  const double ends[] = {0x1p-33, 0.5, 1.0 - 0x1p-33, 0x1p-53, 1.0 - 0x1p-53};
  for (const Model& m : models(true)) {
    INFO(m.name);
    for (double mu_i : mus)
      for (double mu_o : mus)
        for (double phi : {0.0, 1e-9, 1.0, kPi - 1e-9, kPi}) {
          CAPTURE(mu_i);
          CAPTURE(mu_o);
          CAPTURE(phi);
          const vec3 wi = incident(mu_i);
          const vec3 o = incident(mu_o);
          const BrdfAngles a = brdf_angles(kUp, wi, v3(o.x * std::cos(phi), o.x * std::sin(phi), o.z));
          REQUIRE(std::isfinite(m.eval(a)));
          REQUIRE(m.eval(a) >= 0.0);
          REQUIRE(std::isfinite(m.pdf(a)));
          REQUIRE(m.pdf(a) >= 0.0);
        }
    for (double mu_i : mus)
      for (double u0 : ends)
        for (double u1 : ends)
          for (double u2 : ends) {
            const BrdfSample s = m.sample(incident(mu_i), u0, u1, u2);
            REQUIRE(std::isfinite(s.weight));
            REQUIRE(s.weight >= 0.0);
            REQUIRE(std::isfinite(s.pdf));
            if (s.ok) REQUIRE(s.wo.z > 0.0);
          }
  }
}
