// SPDX-License-Identifier: Apache-2.0
// Materials of a scene to the device's material table. Reflectances are dimensionless or 1/sr, wavelengths nm.
#include "body/materials.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "body/portable_tables.hpp"
#include "body/reflectance.hpp"
#include "clray/error.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

/// Layout of a tabulated BRDF in `tables`: see kernels/brdf/tabulated.cl.
std::uint32_t add_table(std::vector<double>& tables, const BrdfTable& table) {
  const auto at = static_cast<std::uint32_t>(tables.size());
  for (const auto* axis : {&table.theta_i_rad, &table.theta_o_rad, &table.phi_rad})
    tables.push_back(static_cast<double>(axis->size()));
  for (const auto* axis : {&table.theta_i_rad, &table.theta_o_rad, &table.phi_rad, &table.value})
    tables.insert(tables.end(), axis->begin(), axis->end());
  return at;
}

/// The reflectance table of a material with these values of its row's keys. The process keeps a table for further
/// passes and traces: making one may take a second, and its key holds everything that it depends on.
std::shared_ptr<const std::vector<double>> known_reflectance(const ClrayMaterial& material,
                                                             const std::vector<double>& values,
                                                             const BrdfTable* measured) {
  constexpr std::size_t kMostKept = 4096;
  static std::mutex mutex;
  static std::map<std::vector<double>, std::shared_ptr<const std::vector<double>>> kept;
  std::vector<double> key(values), tables, angles;
  key.push_back(material.model);
  ClrayMaterial alone = material;  // with its own table first
  alone.table = 0;
  if (measured != nullptr) {
    add_table(tables, *measured);
    key.insert(key.end(), tables.begin(), tables.end());
    angles = measured->theta_i_rad;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (const auto found = kept.find(key); found != kept.end()) return found->second;
  }
  auto nodes = std::make_shared<const std::vector<double>>(
      reflectance_table([&](double mu) { return surface_reflectance(alone, tables, mu); }, angles));
  const std::lock_guard<std::mutex> lock(mutex);
  if (kept.size() >= kMostKept) kept.clear();
  return kept.emplace(std::move(key), std::move(nodes)).first->second;
}

}  // namespace

MaterialTable material_table(const Scene& scene, const std::vector<Lane>& lanes, bool reflectances) {
  MaterialTable s;
  s.columns = static_cast<std::uint32_t>(scene.materials.size());
  std::vector<bool> used(table("brdf").size(), false);
  std::map<const BrdfTable*, std::uint32_t> placed;
  std::map<const std::vector<double>*, std::uint32_t> known;  // offsets of reflectance tables
  std::vector<std::shared_ptr<const std::vector<double>>> held;
  for (const Lane& lane : lanes) {
    for (const Material& base : scene.materials) {
      const Material& m = material_of(scene, lane, base);
      const int row = table_index("brdf", m.model);
      if (row < 0) throw Error(ErrorCode::input, "unknown model \"" + m.model + "\"", "material " + m.name);
      std::map<std::string, double> parameters = m.parameters;
      for (const auto& [key, spectrum] : m.spectra) parameters[key] = spectrum_mean(spectrum, lane.band, scene.source);
      const std::vector<double> values = row_values(table("brdf")[row], parameters);
      ClrayMaterial out{};
      out.model = static_cast<std::uint32_t>(row);
      out.flags = m.two_sided ? CLRAY_MATERIAL_TWO_SIDED : 0u;
      for (std::size_t k = 0; k < values.size() && k < CLRAY_MATERIAL_PARAMETERS; ++k) out.p[k] = values[k];
      out.emissivity = 1.0 - m.infrared_reflectance;
      if (m.table) {
        if (!placed.count(m.table.get())) placed[m.table.get()] = add_table(s.tables, *m.table);
        out.table = placed[m.table.get()];
      }
      if (reflectances) {
        const std::shared_ptr<const std::vector<double>> nodes = known_reflectance(out, values, m.table.get());
        if (!known.count(nodes.get())) {
          known[nodes.get()] = static_cast<std::uint32_t>(s.tables.size());
          s.tables.insert(s.tables.end(), nodes->begin(), nodes->end());
          held.push_back(nodes);
        }
        out.reflectance = known[nodes.get()];
      }
      s.one_sided = s.one_sided || !m.two_sided;
      s.delta = s.delta || table("brdf")[row].delta;
      used[row] = true;
      s.rows.push_back(out);
    }
  }
  for (std::size_t row = 0; row < used.size(); ++row) {
    if (used[row]) s.models.push_back(static_cast<int>(row));
  }
  return s;
}

double weight_bound(const MaterialTable& table, double cos_half_phase) {
  double bound = 0.0;
  for (const ClrayMaterial& m : table.rows) bound = std::max(bound, surface_bound(m, table.tables, cos_half_phase));
  return bound;
}

}  // namespace clray
