// SPDX-License-Identifier: Apache-2.0
// Spectra and sources. A black body's share in a band is the integral of x³/(eˣ−1) over x = hc/(λkT), divided by
// π⁴/15 (Planck 1901), by composite Gauss-Legendre quadrature of five points on panels of at most 0.25 in x: its
// error there is below 1e-18 of the integrand, and narrow bands do not suffer the cancellation of a difference of
// two tails. Products of tables (reflectance, light, filter) are integrated by the same rule, piece by piece between
// the points of all of them. There they are polynomials, so the rule is exact.
#include "scene/spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "clray/constants.hpp"
#include "shared/elementary.h"

namespace clray {
namespace {

/// Beyond this x the integrand is below the smallest normal number.
constexpr double kLargest = 700.0;

/// Exact integral of the piecewise linear function over [low, high] inside the table.
double integral_inside(const Spectrum& s, double low, double high) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < s.wavelength_nm.size(); ++i) {
    const double a = std::max(low, s.wavelength_nm[i]), b = std::min(high, s.wavelength_nm[i + 1]);
    if (a < b) sum += 0.5 * (b - a) * (spectrum_at(s, a) + spectrum_at(s, b));
  }
  return sum;
}

double planck(double x) {
  return x * x * x / el_expm1(x);
}

/// Integral of f over [low, high] by the five-point rule on `panels` panels, last panel first.
template <class Function>
double gauss(Function f, double low, double high, double panels) {
  // Nodes and weights of the rule on [-1, 1] in closed form.
  const double near = std::sqrt(5.0 - 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
  const double far = std::sqrt(5.0 + 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
  const double near_weight = (322.0 + 13.0 * std::sqrt(70.0)) / 900.0;
  const double far_weight = (322.0 - 13.0 * std::sqrt(70.0)) / 900.0;
  const double half = 0.5 * (high - low) / panels;
  double sum = 0.0;
  for (double i = panels - 1.0; i >= 0.0; i -= 1.0) {
    const double middle = low + (2.0 * i + 1.0) * half;
    sum += half * (128.0 / 225.0 * f(middle) + near_weight * (f(middle - near * half) + f(middle + near * half)) +
                   far_weight * (f(middle - far * half) + f(middle + far * half)));
  }
  return sum;
}

/// Integral of x³/(eˣ−1) over [low, high]; small terms first.
double planck_integral(double low, double high) {
  high = std::min(high, kLargest);
  if (!(low < high)) return 0.0;
  return gauss(planck, low, high, std::ceil((high - low) / 0.25));
}

/// hc/(λkT)
double planck_x(double wavelength_nm, double temperature_K) {
  return constants::kPlanck_J_s * constants::kLightSpeed_m_s / constants::kBoltzmann_J_K /
         (wavelength_nm * 1e-9 * temperature_K);
}

double temperature_of(const Source& source) {
  return source.blackbody_K > 0.0 ? source.blackbody_K : constants::kSun_K;
}

bool is_table(const Source& source) {
  return source.spectrum && source.blackbody_K <= 0.0;
}

/// Integral over a band of `weight` × the source's light × the band's response. `points`: of a table that `weight` is
/// linear between, or null; `step_nm`: the widest panel on which it is smooth.
template <class Weight>
double band_integral(Weight weight, const Spectrum* points, double step_nm, const Band& band, const Source& source) {
  std::vector<double> ends{band.low_nm, band.high_nm};
  const Spectrum* const tables[] = {points, band.response.get(), is_table(source) ? &*source.spectrum : nullptr};
  for (const Spectrum* table : tables) {
    if (table == nullptr) continue;
    for (const double w : table->wavelength_nm) {
      if (w > band.low_nm && w < band.high_nm) ends.push_back(w);
    }
  }
  std::sort(ends.begin(), ends.end());
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (!(ends[i] < ends[i + 1])) continue;
    const auto passed = [&](double w) { return weight(w) * source_spectral_W_m2_nm(source, w) * response_at(band, w); };
    // One panel is exact for a product of three lines. A black body needs panels that are small in x and in ln λ.
    double panels = std::ceil((ends[i + 1] - ends[i]) / step_nm);
    if (!is_table(source)) {
      const double x = planck_x(ends[i], temperature_of(source)), relative = 1.0 - ends[i] / ends[i + 1];
      panels =
          std::ceil(std::max({panels, std::min(x, kLargest) * relative / 0.25, (ends[i + 1] / ends[i] - 1.0) / 0.05}));
    }
    sum += gauss(passed, ends[i], ends[i + 1], std::min(std::max(panels, 1.0), 100000.0));
  }
  return sum;
}

constexpr double kAnyStep = std::numeric_limits<double>::infinity();

/// The integral of light and response alone.
double band_light(const Band& band, const Source& source) {
  return band_integral([](double) { return 1.0; }, nullptr, kAnyStep, band, source);
}

double planck_share_per_unit() {
  return 15.0 / (CLRAY_PI * CLRAY_PI * CLRAY_PI * CLRAY_PI);
}

}  // namespace

double spectrum_at(const Spectrum& spectrum, double wavelength_nm) {
  const std::vector<double>& x = spectrum.wavelength_nm;
  const std::vector<double>& y = spectrum.value;
  if (wavelength_nm <= x.front()) return y.front();
  if (wavelength_nm >= x.back()) return y.back();
  const std::size_t i = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), wavelength_nm) - x.begin());
  const double t = (wavelength_nm - x[i - 1]) / (x[i] - x[i - 1]);
  return (1.0 - t) * y[i - 1] + t * y[i];
}

double spectrum_inside(const Spectrum& spectrum, double wavelength_nm) {
  const std::vector<double>& x = spectrum.wavelength_nm;
  return wavelength_nm >= x.front() && wavelength_nm <= x.back() ? spectrum_at(spectrum, wavelength_nm) : 0.0;
}

double band_mean(const std::function<double(double)>& weight, double step_nm, const Band& band, const Source& source) {
  if (source.kind == Source::Kind::laser)
    return response_at(band, source.wavelength_nm) > 0.0 ? weight(source.wavelength_nm) : 0.0;
  const double light = source_band_W_m2(source, band);
  return light > 0.0 ? band_integral(weight, nullptr, step_nm, band, source) / light : 0.0;
}

double spectrum_mean(const Spectrum& spectrum, double low_nm, double high_nm) {
  if (!(low_nm < high_nm)) return spectrum_at(spectrum, low_nm);
  const double first = spectrum.wavelength_nm.front(), last = spectrum.wavelength_nm.back();
  const double before = std::max(0.0, std::min(high_nm, first) - low_nm);
  const double after = std::max(0.0, high_nm - std::max(low_nm, last));
  const double inside = integral_inside(spectrum, low_nm, high_nm);
  return (inside + before * spectrum.value.front() + after * spectrum.value.back()) / (high_nm - low_nm);
}

double spectrum_mean(const Spectrum& spectrum, const Band& band, const Source& source) {
  if (source.kind == Source::Kind::laser || !(band.low_nm < band.high_nm)) {
    return spectrum_mean(spectrum, band.low_nm, band.high_nm);
  }
  const double light = band_light(band, source);
  if (!(light > 0.0)) return spectrum_mean(spectrum, band.low_nm, band.high_nm);
  // Rounding must not carry a reflectance beyond its table's values.
  const auto [least, most] = std::minmax_element(spectrum.value.begin(), spectrum.value.end());
  const auto value = [&](double w) { return spectrum_at(spectrum, w); };
  return std::min(std::max(band_integral(value, &spectrum, kAnyStep, band, source) / light, *least), *most);
}

double response_at(const Band& band, double wavelength_nm) {
  if (wavelength_nm < band.low_nm || wavelength_nm > band.high_nm) return 0.0;
  return band.response ? spectrum_inside(*band.response, wavelength_nm) : 1.0;
}

double ab_zero_W_m2(const Band& band) {
  if (!(band.low_nm < band.high_nm)) return 0.0;
  if (!band.response)
    return constants::kAbZero_W_m2_Hz * constants::kLightSpeed_m_s * 1e9 * (1.0 / band.low_nm - 1.0 / band.high_nm);
  // dν = c/λ² dλ; panels of 2 % of λ leave the rule below rounding.
  const std::vector<double>& w = band.response->wavelength_nm;
  const std::vector<double>& t = band.response->value;
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < w.size(); ++i) {
    const double low = std::max(w[i], band.low_nm), high = std::min(w[i + 1], band.high_nm);
    if (!(low < high)) continue;
    const double slope = (t[i + 1] - t[i]) / (w[i + 1] - w[i]);
    const auto per_nm = [&](double x) { return (t[i] + slope * (x - w[i])) / (x * x); };
    sum += gauss(per_nm, low, high, std::ceil((high / low - 1.0) / 0.02));
  }
  return constants::kAbZero_W_m2_Hz * constants::kLightSpeed_m_s * 1e9 * sum;
}

double vega_zero_W_m2(const Band& band) {
  Source vega;
  vega.kind = Source::Kind::sun;
  vega.spectrum = vega_spectrum();
  return source_band_W_m2(vega, band) * std::pow(10.0, 0.4 * band.vega_magnitude);
}

double source_band_W_m2(const Source& source, const Band& band) {
  if (source.kind == Source::Kind::laser) return response_at(band, source.wavelength_nm);
  if (band.response) return band_light(band, source);
  if (is_table(source)) return integral_inside(*source.spectrum, band.low_nm, band.high_nm);
  const double temperature = temperature_of(source);
  const double low = planck_x(band.high_nm, temperature), high = planck_x(band.low_nm, temperature);
  return source.irradiance_W_m2 * planck_share_per_unit() * planck_integral(low, high);
}

double source_spectral_W_m2_nm(const Source& source, double wavelength_nm) {
  if (source.kind == Source::Kind::laser) return 0.0;
  if (is_table(source)) return spectrum_inside(*source.spectrum, wavelength_nm);
  const double x = planck_x(wavelength_nm, temperature_of(source));
  if (x > kLargest) return 0.0;
  return source.irradiance_W_m2 * planck_share_per_unit() * planck(x) * x / wavelength_nm;
}

Band make_band(double low_nm, double high_nm) {
  const std::string name = low_nm == high_nm ? fmt::format("{}", low_nm) : fmt::format("{}-{}", low_nm, high_nm);
  return {name, low_nm, high_nm};
}

Band make_band(const std::string& name, Spectrum response) {
  const double low = response.wavelength_nm.front(), high = response.wavelength_nm.back();
  return {name, low, high, std::make_shared<const Spectrum>(std::move(response))};
}

std::vector<Band> bands_of(const Scene& scene) {
  const Source& source = scene.source;
  if (source.kind == Source::Kind::laser) return {make_band(source.wavelength_nm, source.wavelength_nm)};
  if (!source.bands.empty()) return source.bands;
  return {make_band(400.0, 700.0)};
}

std::vector<Band> bands_of(const Scene& scene, const TableRow& detector) {
  return takes_all_light(scene, detector) ? std::vector<Band>{all_light(scene.source)} : bands_of(scene);
}

bool takes_all_light(const Scene& scene, const TableRow& detector) {
  return detector.whole && scene.source.kind == Source::Kind::sun && scene.source.bands.empty();
}

Band all_light(const Source& source) {
  double low = 200.0, high = 10000.0;
  if (is_table(source)) {
    low = source.spectrum->wavelength_nm.front();
    high = source.spectrum->wavelength_nm.back();
  } else if (source.blackbody_K > 0.0) {
    low *= constants::kSun_K / source.blackbody_K;
    high *= constants::kSun_K / source.blackbody_K;
  }
  Band band = make_band(low, high);
  band.name = fmt::format("{:.6g}-{:.6g}", low, high);
  return band;
}

}  // namespace clray
