// SPDX-License-Identifier: Apache-2.0
// describe_scene(): what clray understood, as aligned text for a person. Meshes and places in m and degrees; values of
// keys in the units of the keys' names.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/scene.hpp"
#include "clray/sizes.hpp"
#include "scene/file/keys.hpp"
#include "scene/motion.hpp"
#include "scene/scene_parts.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"
#include "shared/portable.h"
#include "text/columns.hpp"
#include "text/text.hpp"

namespace clray {
namespace {

using text::Columns;

std::string vector_text(const Vec3& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}
double degrees(double radians) {
  return radians / CLRAY_PI * 180.0;
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
                                  ? "spectrum of " + text::counted(spectrum->second.value.size(), "point")
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
      fmt::format("{}, {:.6g} x {:.6g} x {:.6g} m, area {:.6g} m2", text::counted(mesh.triangles.size(), "triangle"),
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

/// A scene may have a million materials or components; a person reads the first of them.
constexpr std::size_t kMostLines = 100, kMostWords = 20;

std::string component_materials(const Scene& scene, const Component& c) {
  std::string text;
  for (std::size_t i = 0; i < c.materials.size(); ++i) {
    if (i == kMostWords) return text + fmt::format(" and {} more", c.materials.size() - i);
    const std::string& name = scene.materials[c.materials[i]].name;
    const std::string slot = c.mesh && !c.mesh->material_slots[i].empty() ? c.mesh->material_slots[i] + " = " : "";
    text += (text.empty() ? "" : ", ") + (slot == name + " = " ? "" : slot) + name;
  }
  return text;
}

/// Calls `add` for the first entries of a list. Returns words that count the others, if any.
template <typename List, typename Add>
std::string add_first(const List& list, const Add& add) {
  for (std::size_t i = 0; i < std::min(list.size(), kMostLines); ++i) add(list[i]);
  return list.size() > kMostLines ? fmt::format("and {} more", list.size() - kMostLines) : "";
}

std::string section_text(const char* title, std::size_t count, const Columns& lines, const std::string& rest) {
  return fmt::format("{} ({})\n{}{}", title, count, lines.text("  "), rest.empty() ? "" : "  " + rest + "\n");
}

std::string body_text(const Scene& scene) {
  Columns components, materials;
  const std::string more_components = add_first(scene.components, [&](const Component& c) {
    const TableRow& row = table_row("shape", c.shape);
    const std::string what = c.mesh ? mesh_text(*c.mesh) : row_text(row, c.parameters);
    components.add({c.name, c.shape, component_materials(scene, c), what + place_text(c)});
  });
  const std::string more_materials = add_first(scene.materials, [&](const Material& m) {
    materials.add({m.name, m.model, material_text(m)});
  });
  std::string text = section_text("components", scene.components.size(), components, more_components) +
                     section_text("materials", scene.materials.size(), materials, more_materials);
  if (scene.variants.empty()) return text;
  Columns variants;
  const std::string more_variants = add_first(scene.variants, [&](const Variant& v) {
    std::string name = v.name;
    const std::string more = add_first(v.materials, [&](const Material& m) {
      variants.add({name, m.name, m.model, material_text(m)});
      name.clear();
    });
    if (!more.empty()) variants.add({"", more});
  });
  return text + section_text("variants", scene.variants.size(), variants, more_variants);
}

std::string motion_text(const Motion& m) {
  return key_text(m) + ": " + text::counted(orientation_count(m), "orientation");
}

}  // namespace

std::string describe_scene(const Scene& scene) {
  check_scene(scene);
  Columns lines;
  if (scene.reference_point != Vec3(0.0)) lines.add({"reference", vector_text(scene.reference_point) + " m"});
  lines.add({"source", key_text(scene.source)});
  const std::string more_observers = add_first(scene.observers, [&](const Observer& o) {
    lines.add({"observer", key_text(o)});
  });
  if (!more_observers.empty()) lines.add({"", more_observers});
  if (scene.motion) lines.add({"motion", motion_text(*scene.motion)});
  if (!scene.views.empty()) lines.add({"views", fmt::format("{}, given one by one", scene.views.size())});
  if (scene.pass) {
    lines.add({"pass", key_text(*scene.pass)});
    lines.add({"attitude", key_text(scene.pass->attitude)});
  }
  if (scene.station) {
    std::string text;
    for (const KeyValue& each : key_values(*scene.station)) {
      // In a pass the orbit gives the range, and the pass the calendar.
      const std::string& name = each.row->key.name;
      if (each.value.empty() || (scene.pass && (name == "range_m" || name == "start_mjd"))) continue;
      text += (text.empty() ? "" : ", ") + name + " " + each.value;
    }
    lines.add({"station", text});
    const std::string ranges = ranging_text(scene);
    if (!ranges.empty()) lines.add({"ranges", ranges});
  }
  for (const DetectorSpec& d : scene.detectors) {
    const TableRow& row = table_row("detector", d.kind);
    const std::string options = row_text(row, d.parameters);
    std::string what = d.name == d.kind ? d.kind : d.name + ": " + d.kind;
    if (!options.empty()) what += ", " + options;
    if (takes_all_light(scene, row)) {
      const Band light = all_light(scene.source);
      what += fmt::format(", light {} nm ({:.6g} W/m2)", light.name, source_band_W_m2(scene.source, light));
    }
    lines.add({"detector", what});
  }
  lines.add({"trace", key_text(scene.trace)});
  lines.add({"results", size_text(scene)});
  std::string text = fmt::format("scene {}\n{}{}", text::shown(scene.path.empty() ? scene.name : scene.path),
                                 body_text(scene), lines.text(""));
  for (const std::string& warning : scene.warnings) text += "warning: " + text::shown(warning) + "\n";
  return text;
}

}  // namespace clray
