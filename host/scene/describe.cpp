// SPDX-License-Identifier: Apache-2.0
// describe_scene() and list_table(): what clray understood and what it offers, as aligned text for a person.
// Lengths in m, angles in degrees, whatever the file's units were.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "clray/scene.hpp"
#include "scene/motion.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"
#include "shared/portable.h"
#include "text/columns.hpp"

namespace clray {
namespace {

using text::Columns;

std::string vector_text(const Vec3& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}
double degrees(double radians) {
  return radians / CLRAY_PI * 180.0;
}

std::string count_text(std::size_t n, const std::string& one) {
  return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s");
}

std::string row_text(const TableRow& row, const std::map<std::string, double>& parameters,
                     const std::map<std::string, Spectrum>& spectra = {}) {
  const std::vector<double> values = row_values(row, parameters);
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (parameters.count(row.keys[i].name) == 0 && spectra.count(row.keys[i].default_key) > 0) {
      text += fmt::format(", {} = {}", row.keys[i].name, row.keys[i].default_key);
      continue;
    }
    const auto spectrum = spectra.find(row.keys[i].name);
    if (spectrum == spectra.end() && std::isnan(values[i])) continue;
    const std::string value = spectrum != spectra.end()
                                  ? "spectrum of " + count_text(spectrum->second.value.size(), "point")
                              : row.keys[i].is_switch ? (values[i] != 0.0 ? "yes" : "no")
                                                      : fmt::format("{:.6g}", values[i]);
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", row.keys[i].name, value);
  }
  return text;
}

std::string material_text(const Material& m) {
  const TableRow& row = table_row("brdf", m.model);
  std::string text = row_text(row, m.parameters, m.spectra);
  if (m.table) {
    text += fmt::format(", table of {} x {} x {} angles", m.table->theta_i_rad.size(), m.table->theta_o_rad.size(),
                        m.table->phi_rad.size());
  }
  if (!m.two_sided) text += ", black back";
  if (m.infrared_reflectance > 0.0) text += fmt::format(", infrared reflectance {:.6g}", m.infrared_reflectance);
  return text;
}

std::string mesh_text(const Mesh& mesh) {
  Vec3 low(1e308), high(-1e308);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], mesh.vertices[v][i]);
        high[i] = std::max(high[i], mesh.vertices[v][i]);
      }
    }
  }
  const MeshReport& r = mesh.report;
  std::string text =
      fmt::format("{}, {:.6g} x {:.6g} x {:.6g} m, area {:.6g} m2", count_text(mesh.triangles.size(), "triangle"),
                  high.x - low.x, high.y - low.y, high.z - low.z, r.area_m2);
  if (r.degenerate > 0) text += fmt::format(", {} degenerate", r.degenerate);
  text += r.boundary_edges + r.non_manifold_edges == 0
              ? ", closed"
              : fmt::format(", {} boundary and {} non-manifold edges", r.boundary_edges, r.non_manifold_edges);
  return text;
}

std::string place_text(const Component& c) {
  std::string text;
  const Transform& t = c.transform;
  if (t.scale != 1.0) text += fmt::format(", scaled by {:.6g}", t.scale);
  if (t.angle_rad != 0.0)
    text += fmt::format(", turned {:.6g} deg about {}", degrees(t.angle_rad), vector_text(t.axis));
  if (t.translate != Vec3(0.0)) text += ", moved to " + vector_text(t.translate);
  if (c.hinge) {
    const char* follow = c.hinge->follow == Hinge::Follow::source     ? ", follows the source"
                         : c.hinge->follow == Hinge::Follow::observer ? ", follows the observer"
                                                                      : "";
    text += fmt::format(", hinged about {} through {} at {:.6g} deg{}", vector_text(c.hinge->axis),
                        vector_text(c.hinge->point), degrees(c.hinge->angle_rad), follow);
  }
  return text;
}

std::string component_materials(const Scene& scene, const Component& c) {
  std::string text;
  for (std::size_t i = 0; i < c.materials.size(); ++i) {
    const std::string& name = scene.materials[c.materials[i]].name;
    const std::string slot = c.mesh && !c.mesh->material_slots[i].empty() ? c.mesh->material_slots[i] + " = " : "";
    text += (text.empty() ? "" : ", ") + (slot == name + " = " ? "" : slot) + name;
  }
  return text;
}

std::string body_text(const Scene& scene) {
  Columns components, materials;
  for (const Component& c : scene.components) {
    const TableRow& row = table_row("shape", c.shape);
    const std::string what = c.mesh ? mesh_text(*c.mesh) : row_text(row, c.parameters);
    components.add({c.name, c.shape, component_materials(scene, c), what + place_text(c)});
  }
  for (const Material& m : scene.materials) materials.add({m.name, m.model, material_text(m)});
  std::string text = fmt::format("components ({})\n{}", scene.components.size(), components.text("  "));
  text += fmt::format("materials ({})\n{}", scene.materials.size(), materials.text("  "));
  if (scene.variants.empty()) return text;
  Columns variants;
  for (const Variant& v : scene.variants) {
    std::string name = v.name;
    for (const Material& m : v.materials) {
      variants.add({name, m.name, m.model, material_text(m)});
      name.clear();
    }
  }
  return text + fmt::format("variants ({})\n{}", scene.variants.size(), variants.text("  "));
}

std::string source_text(const Scene& scene) {
  const Source& s = scene.source;
  if (s.kind == Source::Kind::laser)
    return fmt::format("laser {:.6g} nm toward {}", s.wavelength_nm, vector_text(s.direction));
  const std::string light = s.spectrum && s.blackbody_K <= 0.0
                                ? "spectrum of " + count_text(s.spectrum->value.size(), "point")
                                : fmt::format("black body of {:.6g} K, {:.6g} W/m2",
                                              s.blackbody_K > 0.0 ? s.blackbody_K : 5772.0, s.irradiance_W_m2);
  std::string text = fmt::format("sun toward {}, {}; bands", vector_text(s.direction), light);
  const std::vector<Band> bands = bands_of(scene);
  constexpr std::size_t kMost = 8;
  for (std::size_t i = 0; i < std::min(bands.size(), kMost); ++i) {
    const Band& b = bands[i];
    const std::string range = b.response ? fmt::format("{} (curve {:.6g}-{:.6g} nm", b.name, b.low_nm, b.high_nm)
                              : b.name == make_band(b.low_nm, b.high_nm).name
                                  ? b.name + " nm ("
                                  : fmt::format("{} ({:.6g}-{:.6g} nm", b.name, b.low_nm, b.high_nm);
    text += fmt::format("{} {}{}{:.6g} W/m2)", i > 0 ? "," : "", range, range.back() == '(' ? "" : ", ",
                        source_band_W_m2(s, b));
  }
  if (bands.size() > kMost)
    text += fmt::format(" and {} more up to {:.6g} nm", bands.size() - kMost, bands.back().high_nm);
  return text;
}

std::string motion_text(const Motion& m) {
  const std::string steps = count_text(orientation_count(m), "orientation");
  if (!m.attitudes.empty()) {
    return fmt::format("table of {}, {:.6g} s to {:.6g} s: {}", count_text(m.attitudes.size(), "attitude"),
                       m.attitudes.front().time_s, m.attitudes.back().time_s, steps);
  }
  return fmt::format(
      "spin about {}, period {:.6g} s, phase {:.6g} deg, {:.6g} s to {:.6g} s in steps of {:.6g} deg: {}",
      vector_text(m.axis), m.period_s, degrees(m.phase_rad), m.start_s, m.stop_s, degrees(m.step_rad), steps);
}

std::string station_text(const Station& s) {
  const std::string range = !s.cpf_file.empty() ? "range from " + s.cpf_file
                            : !s.ranges.empty() ? "range from a table of " + count_text(s.ranges.size(), "row")
                                                : fmt::format("range {:.6g} m", s.range_m);
  const std::string pulse = !s.pulse.empty()       ? "a pulse of " + count_text(s.pulse.size(), "point")
                            : s.pulse_fwhm_s > 0.0 ? fmt::format("{:.6g} ps FWHM", s.pulse_fwhm_s * 1e12)
                                                   : "delta pulse";
  return fmt::format(
      "{}: {}, {:.6g} J, {}, {:.6g} Hz, aperture {:.6g} m, divergence {:.6g} urad, noise {:.6g}/ns, gate {:.6g} ns",
      s.name, range, s.pulse_energy_J, pulse, s.rate_Hz, s.aperture_m, s.divergence_rad * 1e6, s.noise_per_ns,
      s.gate_s * 1e9);
}

std::string trace_text(const TraceOptions& o) {
  std::string text = fmt::format("{}, seed {}, {} replicates, {} samples",
                                 count_text(static_cast<std::size_t>(o.max_bounces), "bounce"), o.seed, o.replicates,
                                 o.sobol ? "Sobol" : "random");
  if (o.rays > 0) text += fmt::format(", {} rays", o.rays);
  if (o.target_error_percent > 0.0) text += fmt::format(", to {:.6g} %", o.target_error_percent);
  if (o.time_limit_s > 0.0) text += fmt::format(", at most {:.6g} s", o.time_limit_s);
  return text;
}

}  // namespace

std::string describe_scene(const Scene& scene) {
  Columns lines;
  if (scene.reference_point != Vec3(0.0)) lines.add({"reference", vector_text(scene.reference_point) + " m"});
  lines.add({"source", source_text(scene)});
  for (const Observer& o : scene.observers) {
    std::string text = o.monostatic ? "at the source" : "toward " + vector_text(o.direction);
    if (o.range_m > 0.0) text += fmt::format(", at {:.6g} m", o.range_m);
    if (o.acceptance_rad > 0.0) text += fmt::format(", cone of {:.6g} mrad", o.acceptance_rad * 1e3);
    lines.add({"observer", o.name.empty() ? text : o.name + ": " + text});
  }
  if (scene.motion) lines.add({"motion", motion_text(*scene.motion)});
  if (scene.station) lines.add({"station", station_text(*scene.station)});
  for (const DetectorSpec& d : scene.detectors) {
    const TableRow& row = table_row("detector", d.kind);
    const std::string options = row_text(row, d.parameters);
    const std::string what = d.name == d.kind ? d.kind : d.name + ": " + d.kind;
    lines.add({"detector", what + (options.empty() ? "" : ", " + options)});
  }
  lines.add({"trace", trace_text(scene.trace)});
  std::string text =
      fmt::format("scene {}\n{}{}", scene.path.empty() ? scene.name : scene.path, body_text(scene), lines.text(""));
  for (const std::string& warning : scene.warnings) text += "warning: " + warning + "\n";
  return text;
}

std::string list_table(const std::string& kind) {
  if (kind != "brdf" && kind != "shape" && kind != "detector") {
    throw Error(ErrorCode::usage, "expected devices, brdf, shape or detector, found '" + kind + "'", "--list");
  }
  std::string text;
  for (const TableRow& row : table(kind)) {
    Columns lines;
    for (const TableKey& key : row.keys) {
      const std::string value = !key.default_key.empty()        ? key.default_key
                                : std::isnan(key.default_value) ? "none"
                                : key.is_switch                 ? (key.default_value != 0.0 ? "true" : "false")
                                                                : fmt::format("{:.6g}", key.default_value);
      lines.add({key.name, value, key.is_switch ? "true or false" : key.range, key.meaning});
    }
    text += row.name + ": " + row.meaning + "\n" + lines.text("    ");
  }
  return text;
}

}  // namespace clray
