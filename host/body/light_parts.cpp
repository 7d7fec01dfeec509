// SPDX-License-Identifier: Apache-2.0
// See light_parts.hpp. Plain fp64 and clray's own functions: the same parts on every host.
#include "body/light_parts.hpp"

#include <algorithm>
#include <cmath>

#include "scene/spectrum.hpp"
#include "shared/elementary.h"

namespace clray {
namespace {

constexpr double kNegligible = 1e-10;  // of (variance of a key / its largest value squared)·(share of the light)
constexpr int kEvenCells = 128;        // side by side in ln λ, between which points of spectra are edges too

/// The spectra of all surfaces of the scene and its variants.
std::vector<const Spectrum*> spectra_of(const Scene& scene) {
  std::vector<const Spectrum*> all;
  const auto take = [&](const std::vector<Material>& materials) {
    for (const Material& m : materials) {
      for (const auto& [key, spectrum] : m.spectra) all.push_back(&spectrum);
    }
  };
  take(scene.materials);
  for (const Variant& v : scene.variants) take(v.materials);
  return all;
}

/// Adds those of `points` that are inside the band and a thousandth away from every edge before.
void add_edges(std::vector<double> points, std::vector<double>* edges) {
  std::sort(points.begin(), points.end());
  const std::vector<double> before = *edges;
  double last = 0.0;
  for (const double w : points) {
    const auto above = std::lower_bound(before.begin(), before.end(), w);
    if (above == before.begin() || above == before.end()) continue;
    if (w < 1.001 * std::max(last, above[-1]) || 1.001 * w > *above) continue;
    edges->push_back(last = w);
  }
  std::sort(edges->begin(), edges->end());
}

/// Where a part may end: the spectra's points, then even steps.
std::vector<double> edges_of(const Band& band, const std::vector<const Spectrum*>& spectra) {
  std::vector<double> edges{band.low_nm, band.high_nm}, points, steps;
  for (const Spectrum* s : spectra) points.insert(points.end(), s->wavelength_nm.begin(), s->wavelength_nm.end());
  for (int k = 1; k < kEvenCells; ++k)
    steps.push_back(band.low_nm * el_exp(el_log(band.high_nm / band.low_nm) * k / kEvenCells));
  add_edges(std::move(points), &edges);
  add_edges(std::move(steps), &edges);
  return edges;
}

/// Running sums over cells of light, of light·key and of light·key² for each key.
class Cells {
 public:
  Cells(const Scene& scene, const std::vector<double>& edges, const std::vector<const Spectrum*>& spectra)
      : light_(edges.size(), 0.0), first_(spectra.size(), std::vector<double>(edges.size(), 0.0)), second_(first_) {
    for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
      const Band cell{"", edges[k], edges[k + 1]};
      const double light = source_band_W_m2(scene.source, cell);
      light_[k + 1] = light_[k] + light;
      for (std::size_t s = 0; s < spectra.size(); ++s) {
        const std::vector<double>& values = spectra[s]->value;
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        const double size = std::max({std::fabs(*least), std::fabs(*most), 1e-300});
        const double mean = spectrum_mean(*spectra[s], cell, scene.source) / size;
        first_[s][k + 1] = first_[s][k] + light * mean;
        second_[s][k + 1] = second_[s][k] + light * mean * mean;
      }
    }
  }

  double light(std::size_t a, std::size_t b) const { return light_[b] - light_[a]; }

  /// Variance of the keys over cells a … b - 1, times the light there.
  double spread(std::size_t a, std::size_t b) const {
    const double all = light(a, b);
    double sum = 0.0;
    for (std::size_t s = 0; s < first_.size() && all > 0.0; ++s) {
      const double mean = first_[s][b] - first_[s][a];
      sum += std::max(0.0, second_[s][b] - second_[s][a] - mean * (mean / all));
    }
    return sum;
  }

 private:
  std::vector<double> light_;
  std::vector<std::vector<double>> first_, second_;
};

}  // namespace

LightParts parts_of(const Scene& scene, const Band& band) {
  const std::vector<const Spectrum*> spectra = spectra_of(scene);
  if (spectra.empty()) return {{band}, {1.0}};
  const std::vector<double> edges = edges_of(band, spectra);
  const Cells cells(scene, edges, spectra);
  const std::size_t end = edges.size() - 1;
  const double all = cells.light(0, end);
  std::vector<std::size_t> cuts{0, end};
  while (cuts.size() <= kMostLightParts) {
    double best = kNegligible * all;
    std::size_t where = 0;
    for (std::size_t p = 0; p + 1 < cuts.size(); ++p) {
      const double before = cells.spread(cuts[p], cuts[p + 1]);
      for (std::size_t k = cuts[p] + 1; k < cuts[p + 1]; ++k) {
        // Both sides need light: without it a part has no mean.
        if (!(cells.light(cuts[p], k) > 0.0 && cells.light(k, cuts[p + 1]) > 0.0)) continue;
        const double gain = before - cells.spread(cuts[p], k) - cells.spread(k, cuts[p + 1]);
        if (gain > best) {
          best = gain;
          where = k;
        }
      }
    }
    if (where == 0) break;
    cuts.insert(std::upper_bound(cuts.begin(), cuts.end(), where), where);
  }
  LightParts parts;
  for (std::size_t p = 0; p + 1 < cuts.size(); ++p) {
    parts.bands.push_back(make_band(edges[cuts[p]], edges[cuts[p + 1]]));
    parts.shares.push_back(cells.light(cuts[p], cuts[p + 1]) / all);
  }
  return parts;
}

}  // namespace clray
