// SPDX-License-Identifier: Apache-2.0
// Each surface model against its formula as the literature prints it, in long double and from vectors, and against
// closed forms of its reflectance.
#include <complex>
#include <random>

#include "doctest/doctest.h"
#include "kernels/brdf_models.hpp"

using namespace brdf_test;

namespace {

using Long = long double;
constexpr Long kPiL = 3.141592653589793238462643383279502884L;

Model model(const std::string& name, const std::map<std::string, double>& values) {
  const int row = clray::table_index("brdf", name);
  REQUIRE(row >= 0);
  return make_model(row, clray::row_values(clray::table("brdf")[row], values));
}

/// Angles of two directions in long double; n = +z.
struct LongAngles {
  Long mu_i, mu_o, nh, u, cos_phase;
  LongAngles(vec3 i, vec3 o) {
    const Long x = static_cast<Long>(i.x) + o.x, y = static_cast<Long>(i.y) + o.y, z = static_cast<Long>(i.z) + o.z;
    const Long length = std::sqrt(x * x + y * y + z * z);
    mu_i = i.z;
    mu_o = o.z;
    nh = z / length;
    // wo·h and wi·wo by the length of wi + wo: equal for unit vectors, and not spoilt near |wi + wo| = 0 by vectors
    // that are unit to 1e-16 only.
    u = 0.5L * length;
    cos_phase = 0.5L * length * length - 1.0L;
  }
};

/// Ashikhmin-Shirley as Wetterer, Hill & Jah (2014) write it, with h normalised and cos alpha = n·h.
Long paper_f(Long rho, Long d, Long n, Long f0, const LongAngles& a) {
  const Long s = 1.0L - d;
  const Long s_fresnel = s * f0 + (1.0L - s * f0) * std::pow(1.0L - a.u, 5.0L);
  const Long s_rs = (n + 1.0L) / (8.0L * kPiL) * s_fresnel * std::pow(a.nh, n) / (a.u * std::max(a.mu_i, a.mu_o));
  // 1 - (1 - mu/2)^5 keeps too few digits at grazing incidence even here
  const auto g = [](Long mu) { return -std::expm1(5.0L * std::log1p(-mu / 2.0L)); };
  const Long rd = 28.0L * rho / (23.0L * kPiL) * (1.0L - s * f0) * g(a.mu_i) * g(a.mu_o);
  return d * rd + s_rs;
}

/// Pairs of directions: anywhere, near the mirror image at many scales, near retro-reflection, at grazing incidence.
std::vector<std::pair<vec3, vec3>> pairs(int count) {
  std::vector<std::pair<vec3, vec3>> result;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  while (static_cast<int>(result.size()) < count) {
    const double mu = uniform(random) < 0.2 ? 1e-5 * uniform(random) + 1e-9 : uniform(random);
    const vec3 wi = incident(mu);
    const double spread = std::pow(10.0, -5.0 * uniform(random));
    const double side = uniform(random) < 0.5 ? -1.0 : 1.0;
    const vec3 wo = v3_unit(v3(side * wi.x + spread * normal(random), spread * normal(random),
                               std::fabs(wi.z + spread * normal(random)) + 1e-12));
    result.emplace_back(wi, wo);
  }
  return result;
}

}  // namespace

TEST_CASE("Ashikhmin-Shirley equals the paper's formula, exponents to 10^6") {
  // c^n is below 1e-300 where n·sin² exceeds 1400, so an ulp of sin² costs 1400 ulp at most: 1e-12 with a little room,
  // and 1e-15 of the change with u, as 1 - u has lost digits at the retro-reflection. Values below 1e-290 are left.
  for (double n : {0.0, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6})
    for (double d : {0.0, 0.3, 1.0})
      for (double rho : {0.0, 0.5, 1.0}) {
        const Model m = model("ashikhmin-shirley", {{"rho", rho}, {"d", d}, {"n", n}, {"f0", 0.7}});
        INFO(m.name);
        Long worst = 0.0L;
        for (const auto& [wi, wo] : pairs(2000)) {
          const BrdfAngles angles = brdf_angles(kUp, wi, wo);
          if (angles.half_length < 1e-3) continue;
          const LongAngles a(wi, wo);
          const Long exact = paper_f(rho, d, n, 0.7L, a);
          if (exact < 1e-290L) continue;
          const Long slope = 5.0L * std::pow(1.0L - a.u, 4.0L) * (n + 1.0L) / (8.0L * kPiL) * std::pow(a.nh, n) /
                             (a.u * std::max(a.mu_i, a.mu_o));
          worst = std::max(worst, std::fabs(m.eval(angles) - exact) / (2e-12L * exact + 1e-15L * slope));
        }
        CHECK(worst < 1.0L);
      }
}

TEST_CASE("Ashikhmin-Shirley reflectance at normal incidence against the polynomial's integral") {
  // d = 0, mu = 1: R = integral of (n+1)·c^n·F(c)·(2c² - 1) over 1/sqrt(2) < c < 1, F expanded in powers of c.
  for (double n : {0.0, 1.0, 5.0, 50.0, 500.0, 1e4, 1e5, 1e6})
    for (double f0 : {0.0, 0.04, 0.5, 1.0}) {
      const Long binomial[] = {1, -5, 10, -10, 5, -1};
      Long r = 0.0L;
      const auto moment = [&](int k) {  // of c^(n+k)
        return (n + 1.0L) * (1.0L - std::exp(-0.5L * (n + k + 1.0L) * std::log(2.0L))) / (n + k + 1.0L);
      };
      for (int k = 0; k <= 5; ++k) {
        const Long factor = (k == 0 ? static_cast<Long>(f0) : 0.0L) + (1.0L - f0) * binomial[k];
        r += factor * (2.0L * moment(k + 2) - moment(k));
      }
      const Model m = model("ashikhmin-shirley", {{"rho", 0.5}, {"d", 0.0}, {"n", n}, {"f0", f0}});
      INFO(m.name);
      // 1e-10 where smooth; for f0 = 0 the alternating sum itself loses digits, so absolute 1e-16.
      CHECK(std::fabs(m.reflectance(1.0) - r) < 1e-10L * std::fabs(r) + 1e-16L);
    }
  // A narrow peak reflects as the Fresnel factor F at the light's elevation, less what min/(mu_i + mu_o) takes from
  // half vectors tilted away by a normal deviate of variance 1/n: F·(1 - 2 tan(theta)/sqrt(2 pi n)) + O(1/n).
  for (double mu : {0.3, 0.6, 1.0}) {
    const Model m = model("ashikhmin-shirley", {{"rho", 0.5}, {"d", 0.0}, {"n", 1e6}});
    const double fresnel = 0.5 + 0.5 * std::pow(1.0 - mu, 5), tangent = std::sqrt(1.0 - mu * mu) / mu;
    CHECK(m.reflectance(mu) ==
          doctest::Approx(fresnel * (1.0 - 2.0 * tangent / std::sqrt(2.0 * kPi * 1e6))).epsilon(2e-5));
  }
  // d = 1, f0 = 0: what the diffuse coat alone reflects, plus the grazing coat, which vanishes at normal incidence.
  const Model coat = model("ashikhmin-shirley", {{"rho", 1.0}, {"d", 1.0}, {"n", 1e6}});
  CHECK(coat.reflectance(1.0) == doctest::Approx(31.0 / 32.0).epsilon(1e-12));
}

TEST_CASE("Lommel-Seeliger: formula, forward and backward, closed reflectances") {
  for (double g : {-0.9, -0.3, 0.0, 1e-9, 0.5, 0.9}) {
    const Model m = model("lommel-seeliger", {{"albedo", 0.3}, {"g", g}});
    for (const auto& [wi, wo] : pairs(2000)) {
      const LongAngles a(wi, wo);
      const Long gl = g;
      const Long cos_scattering = -a.cos_phase;
      const Long p = (1.0L - gl * gl) / std::pow(1.0L + gl * gl - 2.0L * gl * cos_scattering, 1.5L);
      const Long exact = 0.3L / (4.0L * kPiL) * p / (a.mu_i + a.mu_o);
      // cos(alpha) of directions that are unit to 1e-16 only, over the least denominator (1 - |g|)² = 0.01
      REQUIRE(std::fabs(m.eval(brdf_angles(kUp, wi, wo)) - exact) < 2e-13L * exact);
    }
  }
  for (double mu : {1e-6, 0.1, 0.5, 1.0}) {
    const Model m = model("lommel-seeliger", {{"albedo", 0.3}, {"g", 0.0}});
    CHECK(m.reflectance(mu) == doctest::Approx(0.15 * (1.0 - mu * std::log1p(1.0 / mu))).epsilon(1e-14));
    const Model near = model("lommel-seeliger", {{"albedo", 0.3}, {"g", 1e-12}});
    CHECK(near.reflectance(mu) == doctest::Approx(m.reflectance(mu)).epsilon(1e-10));
  }
  // Forward scattering leaves at the far side of grazing light, backward scattering returns.
  const vec3 grazing = direction(1.5, 0.0), across = direction(1.5, kPi);
  const Model forward = model("lommel-seeliger", {{"g", 0.6}}), backward = model("lommel-seeliger", {{"g", -0.6}});
  CHECK(forward.eval(brdf_angles(kUp, grazing, across)) > 10.0 * forward.eval(brdf_angles(kUp, grazing, grazing)));
  CHECK(backward.eval(brdf_angles(kUp, grazing, grazing)) > 10.0 * backward.eval(brdf_angles(kUp, grazing, across)));
}

TEST_CASE("mirror: Fresnel's coefficients in complex arithmetic") {
  using Complex = std::complex<Long>;
  for (double index : {0.05, 0.3, 0.9, 1.0, 1.5, 2.4, 100.0})
    for (double extinction : {0.0, 1e-3, 0.5, 2.5, 6.7, 100.0})
      for (double mu : {1e-7, 1e-3, 0.1, 0.4, 0.7, 0.99, 1.0}) {
        CAPTURE(index);
        CAPTURE(extinction);
        CAPTURE(mu);
        const Complex n(index, extinction), cosine(mu);
        const Complex inner = std::sqrt((n - 1.0L) * (n + 1.0L) + cosine * cosine);
        const Complex rs = (cosine - inner) / (cosine + inner);
        const Complex rp = (n * n * cosine - inner) / (n * n * cosine + inner);
        const Long exact = 0.5L * (std::norm(rs) + std::norm(rp));
        const Model m = model("mirror", {{"index", index}, {"extinction", extinction}});
        CHECK(std::fabs(m.reflectance(mu) - exact) < 1e-14L);
      }
  CHECK(model("mirror", {{"reflectance", 0.8}}).reflectance(0.3) == 0.8);
  const BrdfSample s = model("mirror", {{"reflectance", 0.8}}).sample(direction(0.4, 1.1), 0.1, 0.2, 0.3);
  const vec3 expected = direction(0.4, 1.1 + kPi);
  CHECK(v3_length(v3_sub(s.wo, expected)) < 4e-16);
  CHECK(s.weight == 0.8);
  CHECK(s.delta == 1);
}

TEST_CASE("GGX: formula in tangents, and the white furnace") {
  for (double alpha : {0.001, 0.01, 0.1, 0.5, 1.0}) {
    const Model m = model("ggx", {{"roughness", alpha}, {"f0", 0.4}});
    INFO(m.name);
    Long worst = 0.0L;
    for (const auto& [wi, wo] : pairs(3000)) {
      const BrdfAngles angles = brdf_angles(kUp, wi, wo);
      if (angles.half_length < 1e-3) continue;
      const LongAngles a(wi, wo);
      const Long alpha2 = static_cast<Long>(alpha) * alpha;
      const auto lambda = [&](Long mu) { return 0.5L * (std::sqrt(1.0L + alpha2 * (1.0L / (mu * mu) - 1.0L)) - 1.0L); };
      // tan² from the horizontal part of h, as 1/c² - 1 loses digits at the peak even here
      const Long hx = static_cast<Long>(wi.x) + wo.x, hy = static_cast<Long>(wi.y) + wo.y;
      const Long tan2 = (hx * hx + hy * hy) / ((a.mu_i + a.mu_o) * (a.mu_i + a.mu_o));
      const Long d = 1.0L / (kPiL * alpha2 * std::pow(a.nh, 4.0L) * std::pow(1.0L + tan2 / alpha2, 2.0L));
      const Long fresnel = 0.4L + 0.6L * std::pow(1.0L - a.u, 5.0L);
      const Long g2 = 1.0L / (1.0L + lambda(a.mu_i) + lambda(a.mu_o));
      const Long exact = fresnel * d * g2 / (4.0L * a.mu_i * a.mu_o);
      worst = std::max(worst, std::fabs(m.eval(angles) - exact) / exact);
    }
    CHECK(worst < 1e-13L);
    const Model white = model("ggx", {{"roughness", alpha}, {"f0", 1.0}});
    // alpha = 1 makes D constant: f = 1/(2 pi (mu_i + mu_o)) in closed form
    if (alpha == 1.0)
      for (double mu : {1e-3, 0.1, 0.5, 1.0})
        CHECK(white.reflectance(mu) == doctest::Approx(1.0 - mu * std::log1p(1.0 / mu)).epsilon(1e-9));
    for (double mu : {0.01, 0.1, 0.5, 1.0}) {
      CHECK(white.reflectance(mu) <= 1.0 + 1e-12);
      if (alpha <= 0.01 && mu >= 0.1) CHECK(white.reflectance(mu) > 0.98);
    }
  }
}

TEST_CASE("tabulated: nodes, linear in angles, constant beyond, and what is no table") {
  const auto linear = [](double i, double o, double p) { return 0.1 + 0.03 * i + 0.02 * o + 0.01 * p; };
  std::vector<double> t = {3, 2, 4, 0.0, 0.5, 1.2, 0.1, 1.4, 0.0, 1.0, 2.0, 3.0};
  for (double i : {0.0, 0.5, 1.2})
    for (double o : {0.1, 1.4})
      for (double p : {0.0, 1.0, 2.0, 3.0}) t.push_back(linear(i, o, p));
  REQUIRE(brdf_tabulated_valid(t.data(), t.size()));
  ClrayMaterial m = {};
  m.p[0] = 0.5;
  std::vector<double> shifted = {9.0, 9.0};
  shifted.insert(shifted.end(), t.begin(), t.end());
  m.table = 2;
  for (double i : {0.0, 0.3, 0.5, 1.1, 1.2, 1.5})
    for (double o : {0.01, 0.1, 0.7, 1.4, 1.55})
      for (double p : {0.0, 0.4, 1.0, 2.9, 3.0, 3.1}) {
        const double f = brdf_tabulated_eval(&m, shifted.data(), brdf_angles(kUp, direction(i, 0.0), direction(o, p)));
        const double phi = i == 0.0 ? 0.0 : p;  // no azimuth at normal incidence
        const double expected = 0.5 * linear(std::min(i, 1.2), std::min(std::max(o, 0.1), 1.4), std::min(phi, 3.0));
        CHECK(f == doctest::Approx(expected).epsilon(1e-7));  // acos near 1 has half the digits
      }
  const auto broken = [&](std::size_t at, double value) {
    std::vector<double> b = t;
    b[at] = value;
    return !brdf_tabulated_valid(b.data(), b.size());
  };
  CHECK(broken(0, 2.0));
  CHECK(broken(1, 0.0));
  CHECK(broken(2, 4.5));
  CHECK(broken(3, -0.1));
  CHECK(broken(4, 0.0));
  CHECK(broken(7, 1.6));
  CHECK(broken(11, 3.2));
  CHECK(broken(14, -1e-9));
  CHECK(broken(14, std::nan("")));
  CHECK(broken(14, HUGE_VAL));
  CHECK_FALSE(brdf_tabulated_valid(t.data(), t.size() - 1));
  // A constant table is Lambert.
  std::vector<double> flat = {1, 1, 1, 0.0, 0.0, 0.0, 0.2};
  m.table = 0;
  m.p[0] = 1.0;
  CHECK(brdf_tabulated_reflectance(&m, flat.data(), 0.4) == doctest::Approx(0.2 * kPi).epsilon(1e-14));
}

TEST_CASE("white-sky reflectance in closed form") {
  const auto white = [](const Model& m) {
    double sum = 0.0;
    const std::vector<double> ends = graded(0.0, 1.0, {0.0, 1.0}, 1e-4, 3.0);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
      for (auto [x, w] : gauss_rule()) {
        const double mu = 0.5 * (ends[i] + ends[i + 1]) + 0.5 * x * (ends[i + 1] - ends[i]);
        sum += w * (ends[i + 1] - ends[i]) * mu * m.reflectance(mu);
      }
    return sum;
  };
  CHECK(white(model("lambert", {{"rho", 0.3}})) == doctest::Approx(0.3).epsilon(1e-13));
  CHECK(white(model("lommel-seeliger", {{"albedo", 0.3}, {"g", 0.0}})) ==
        doctest::Approx(0.3 * 2.0 / 3.0 * (1.0 - std::log(2.0))).epsilon(1e-11));
  // rho·d·(integral of 2 mu g) = 23/28, the coat's F0 = 0 and n = 0 part by the same integral of reflectance apart
  const double both = white(model("ashikhmin-shirley", {{"rho", 0.8}, {"d", 1.0}, {"n", 50.0}}));
  const double coat = white(model("ashikhmin-shirley", {{"rho", 0.0}, {"d", 1.0}, {"n", 50.0}}));
  CHECK(both - coat == doctest::Approx(0.8 * 23.0 / 28.0).epsilon(1e-11));
  // A Schlick mirror's white sky is f0 + (1 - f0)/21; a narrow peak tends to it, less 4·F·sin(theta)/sqrt(2 pi n)
  // integrated over mu (see above).
  const double narrow = white(model("ashikhmin-shirley", {{"rho", 0.5}, {"d", 0.0}, {"n", 1e6}}));
  double loss = 0.0;
  for (int k = 0; k < 10000; ++k) {
    const double mu = (k + 0.5) / 10000;
    loss += 4.0 * (0.5 + 0.5 * std::pow(1.0 - mu, 5)) * std::sqrt(1.0 - mu * mu) / std::sqrt(2.0 * kPi * 1e6) / 10000;
  }
  CHECK(narrow == doctest::Approx(0.5 + 0.5 / 21.0 - loss).epsilon(2e-5));
}
