// SPDX-License-Identifier: Apache-2.0
// check_scene(): demands of a scene built by hand what load_scene() demands of a file. Errors name the member by its
// path ("components[2].radius"), since there is no line. Rules about several values are shared by both.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <string_view>
#include <unordered_set>

#include "clray/error.hpp"
#include "scene/file/keys.hpp"
#include "scene/file/material.hpp"
#include "scene/file/value_checks.hpp"
#include "scene/motion.hpp"
#include "scene/scene_parts.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"
#include "shared/portable.h"
#include "text/name_index.hpp"

namespace clray {
namespace {

[[noreturn]] void fail(const std::string& where, const std::string& message) {
  throw Error(ErrorCode::input, message, where);
}

/// At this distance over size, positions in double precision still have five digits for a shape.
constexpr double kFarthest = 1e11;

double largest(const Vec3& v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

/// The longest of a component's lengths, and how far from the origin its points may be beyond that.
struct Reach {
  double size_m = 0.0, distance_m = 0.0;
};

Reach reach_of(const Component& c) {
  double size = 0.0, distance = 0.0;
  if (c.mesh) {
    Vec3 low(kInfinity), high(-kInfinity);
    for (const Vec3& v : c.mesh->vertices) {
      low = glm::min(low, v);
      high = glm::max(high, v);
    }
    size = largest(high - low);
    distance = std::max(largest(low), largest(high)) * c.transform.scale;
  } else {
    const TableRow& row = table_row("shape", c.shape);
    const std::vector<double> values = row_values(row, c.parameters);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!row.keys[i].is_switch) size = std::max(size, values[i]);
    }
  }
  distance = std::max(distance, largest(c.transform.translate));
  if (c.hinge) distance = std::max(distance, largest(c.hinge->point));
  return {size * c.transform.scale, distance};
}

std::string reach_fault(const Reach& reach) {
  if (reach.distance_m <= kFarthest * reach.size_m) return "";
  return fmt::format(
      "transform: the component, {:.6g} m large, lies {:.6g} m from the origin, where positions have no "
      "digits left for its shape; expected at most {:g} times its size",
      reach.size_m, reach.distance_m, kFarthest);
}

void check_row(const std::string& where, const TableRow& row, const std::map<std::string, double>& parameters) {
  for (const auto& [name, value] : parameters) {
    const TableKey* key = find_key(row, name);
    if (key == nullptr) {
      std::vector<std::string> known;
      for (const TableKey& each : row.keys) known.push_back(each.name);
      fail(where, fmt::format("unknown key '{}' of '{}'{}", name, row.name, did_you_mean(name, known)));
    }
    if (key_accepts(*key, value)) continue;
    std::string expected;
    key_accepts(*key, value, &expected);
    fail(where + "." + name, fmt::format("expected {}, found {}", expected, value));
  }
}

const TableRow& row_of(const std::string& where, const char* member, const std::string& kind, const std::string& name) {
  const int index = table_index(kind, name);
  if (index < 0) {
    fail(where + member, fmt::format("expected one of {}, found \"{}\"{}", fmt::join(row_names(kind), ", "), name,
                                     did_you_mean(name, row_names(kind))));
  }
  return table(kind)[static_cast<std::size_t>(index)];
}

void check_table(const std::string& where, const BrdfTable& t) {
  for (const std::vector<double>* axis : {&t.theta_i_rad, &t.theta_o_rad, &t.phi_rad}) {
    const double most = (axis == &t.phi_rad ? CLRAY_PI : 0.5 * CLRAY_PI) * (1.0 + 1e-12);
    for (const double angle : *axis) check_number(where, angle, {0.0, most, true, true});
    if (axis->empty() || !std::is_sorted(axis->begin(), axis->end(), std::less_equal<double>())) {
      fail(where, "expected increasing angles");
    }
  }
  // In steps, because the product of three sizes may overflow.
  const std::size_t rows = t.value.size() / t.phi_rad.size();
  if (t.value.size() % t.phi_rad.size() != 0 || rows % t.theta_o_rad.size() != 0 ||
      rows / t.theta_o_rad.size() != t.theta_i_rad.size()) {
    fail(where, "expected one value per combination of angles");
  }
  for (const double value : t.value) check_number(where, value, kNotNegative);
}

// A scene may hold a million materials, so texts are made for a complaint only.
void check_material(const std::string& where, const Material& m) {
  const TableRow& row = row_of(where, ".model", "brdf", m.model);
  check_row(where, row, m.parameters);
  if (const std::string fault = number_fault(m.infrared_reflectance, kShare); !fault.empty())
    fail(where + ".infrared_reflectance", fault);
  for (const auto& [name, spectrum] : m.spectra) {
    const TableKey* key = find_key(row, name);
    if (key == nullptr) fail(where, fmt::format("unknown key '{}' of '{}'", name, row.name));
    if (const std::string fault = spectrum_fault(spectrum, key); !fault.empty()) fail(where + "." + name, fault);
  }
  if (!row.file && m.table) fail(where + ".table", "the model '" + row.name + "' has none");
  if (row.file) {
    if (!m.table) fail(where + ".table", fmt::format("missing; the model '{}' needs a table", row.name));
    check_table(where + ".table", *m.table);
  }
}

void check_mesh(const std::string& where, const Mesh* mesh, double scale) {
  if (mesh == nullptr || mesh->triangles.empty()) fail(where, "missing; expected a mesh with triangles");
  if (mesh->triangle_slot.size() != mesh->triangles.size()) fail(where, "expected one slot per triangle");
  for (const std::uint32_t slot : mesh->triangle_slot) {
    if (slot >= mesh->material_slots.size()) fail(where, "a triangle's slot is beyond material_slots");
  }
  for (const auto& t : mesh->triangles) {
    for (const std::uint32_t v : t) {
      if (v >= mesh->vertices.size()) fail(where, "a triangle's vertex is beyond vertices");
    }
  }
  for (std::size_t i = 0; i < mesh->vertices.size(); ++i) {
    const Vec3& v = mesh->vertices[i];
    for (int k = 0; k < 3; ++k) {
      if (!(std::fabs(v[k]) * scale <= kLongest_m) || !(std::fabs(v[k]) <= kLongest_m)) {
        fail(fmt::format("{}.vertices[{}]", where, i),
             fmt::format("expected at most {:g} m, found {} (times a scale of {})", kLongest_m, v[k], scale));
      }
    }
  }
}

/// Returns how far from the origin the component may reach, m.
double check_component(const std::string& where, const Scene& scene, const Component& c) {
  const TableRow& row = row_of(where, ".shape", "shape", c.shape);
  check_row(where, row, c.parameters);
  check_number(where + ".transform.scale", c.transform.scale, kPositive);
  const std::string fault = shape_fault(c);
  if (!fault.empty()) fail(where, fault);
  if (!row.file && c.mesh) fail(where + ".mesh", "the shape '" + row.name + "' has none");
  if (row.file) check_mesh(where + ".mesh", c.mesh.get(), c.transform.scale);
  const std::size_t slots = row.file ? c.mesh->material_slots.size() : 1;
  if (c.materials.size() != slots) {
    fail(where + ".materials", fmt::format("expected {} of them, found {}", slots, c.materials.size()));
  }
  for (const std::uint32_t m : c.materials) {
    if (m >= scene.materials.size()) fail(where + ".materials", fmt::format("there is no material {}", m));
  }
  check_place(where + ".transform.translate", c.transform.translate);
  check_unit(where + ".transform.axis", c.transform.axis);
  check_angle(where + ".transform.angle_rad", c.transform.angle_rad);
  if (c.hinge) {
    check_unit(where + ".hinge.axis", c.hinge->axis);
    check_place(where + ".hinge.point", c.hinge->point);
    check_angle(where + ".hinge.angle_rad", c.hinge->angle_rad);
  }
  const Reach reach = reach_of(c);
  const std::string distance = reach_fault(reach);
  if (!distance.empty()) fail(where, distance);
  return reach.size_m + reach.distance_m;
}

void check_motion(const Motion& m) {
  check_keys("motion", m);
  check_number("motion.stop_s", m.stop_s, {m.start_s, kInfinity, true, false});
  orientation_count(m);
}

void check_view(const std::string& where, const Scene& scene, const Orientation& view) {
  check_number(where + ".time_s", view.time_s, {-kInfinity, kInfinity, false, false});
  check_unit(where + ".source", view.source);
  const double length = glm::dot(view.body_to_space, view.body_to_space);
  if (!(std::fabs(length - 1.0) <= 1e-6)) fail(where + ".body_to_space", "expected a unit quaternion");
  const auto check_size = [&](const char* member, std::size_t found) {
    if (found != 0 && found != scene.observers.size())
      fail(where + member,
           fmt::format("expected {}, one per observer, or none, found {}", scene.observers.size(), found));
  };
  check_size(".observers", view.observers.size());
  check_size(".ranges_m", view.ranges_m.size());
  for (std::size_t o = 0; o < view.observers.size(); ++o) {
    const std::string each = fmt::format("{}.observers[{}]", where, o);
    check_unit(each, view.observers[o]);
    if (at_source(scene.observers[o], scene.source) && view.observers[o] != view.source)
      fail(each, "is not the view's source, where this observer is");
  }
  for (const double range : view.ranges_m) check_number(where + ".ranges_m", range, kNotNegative);
  check_number(where + ".source_range_m", view.source_range_m, kNotNegative);
  check_number(where + ".light", view.light, kNotNegative);
}

void check_views(const Scene& scene) {
  if (scene.views.empty()) return;
  if (scene.motion || scene.pass)
    fail("views", fmt::format("given beside a {}; expected only one of them", scene.motion ? "motion" : "pass"));
  if (!(static_cast<double>(scene.views.size()) <= kMaxOrientations))
    fail("views", fmt::format("expected at most {}, found {}", kMaxOrientations, scene.views.size()));
  for (std::size_t i = 0; i < scene.views.size(); ++i) check_view(fmt::format("views[{}]", i), scene, scene.views[i]);
}

void check_trace(const TraceOptions& o) {
  check_keys("trace", o);
  check_number("trace.work_group_size", o.work_group_size, {1.0, 1024.0, true, true});
}

/// Checks names that are keys of results: they must differ. If there is only one, it may be empty. A detector without a
/// name has that of its kind.
template <typename List>
void check_names(const std::string& where, const List& list) {
  const auto name_at = [&](std::size_t i) -> std::string_view {
    if constexpr (std::is_same_v<List, std::vector<DetectorSpec>>) {
      if (list[i].name.empty()) return list[i].kind;
    }
    return list[i].name;
  };
  text::NameIndex names;
  names.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!names.insert(name_at(i), static_cast<std::uint32_t>(i), name_at).second)
      fail(where, "a second one of the name \"" + std::string(name_at(i)) + "\"");
  }
}

}  // namespace

std::string shape_fault(const Component& c) {
  const int index = table_index("shape", c.shape);
  if (index < 0) return "";
  const TableRow& row = table("shape")[static_cast<std::size_t>(index)];
  const std::vector<double> values = row_values(row, c.parameters);
  double radius = 0.0, inner = -1.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double length = values[i] * c.transform.scale;
    const bool zero = values[i] == 0.0;  // allowed by some keys' ranges, such as a cone's tip
    if (!row.keys[i].is_switch && !zero && !(length >= kShortest_m && length <= kLongest_m)) {
      return fmt::format("{}: expected a length from {:g} to {:g} m, found {}", row.keys[i].name, kShortest_m,
                         kLongest_m, length);
    }
    if (row.keys[i].name == "radius") radius = values[i];
    if (row.keys[i].name == "inner_radius") inner = values[i];
  }
  if (inner >= radius && inner >= 0.0 && radius > 0.0) {
    return fmt::format("inner_radius: expected less than radius = {}, found {}", radius, inner);
  }
  return "";
}

std::string distance_fault(const Component& c) {
  return reach_fault(reach_of(c));
}

std::string detector_fault(const DetectorSpec& d) {
  const auto steps = [&](const char* key) {
    const auto given = d.parameters.find(key);
    return given == d.parameters.end() ? 0.0 : given->second;
  };
  if (steps("azimuth_steps") > 0.0 && steps("elevation_steps") < 2.0) {
    return fmt::format(
        "elevation_steps: a grid of Sun directions has at least 2 (-90 and 90 degrees) beside azimuth_steps "
        "= {}, found {}",
        steps("azimuth_steps"), steps("elevation_steps"));
  }
  if (steps("elevation_steps") > 0.0 && steps("azimuth_steps") == 0.0) {
    return fmt::format("azimuth_steps: a grid of Sun directions has at least 1 beside elevation_steps = {}, found 0",
                       steps("elevation_steps"));
  }
  const auto start = d.parameters.find("start_ns"), stop = d.parameters.find("stop_ns");
  const bool both = start != d.parameters.end() && stop != d.parameters.end();
  if (both && !(start->second < stop->second)) {
    return fmt::format("stop_ns: expected more than start_ns = {}, found {}", start->second, stop->second);
  }
  const auto bin = d.parameters.find("bin_ps");
  if (both && bin != d.parameters.end() && !((stop->second - start->second) * 1e3 / bin->second <= 1e7)) {
    return fmt::format("bin_ps: the window needs more than 1e7 bins of {} ps", bin->second);
  }
  return "";
}

std::string source_fault(const Scene& scene) {
  const Source& s = scene.source;
  if (s.kind != Source::Kind::sun) return "";
  if (s.spectrum && s.spectrum->wavelength_nm.size() < 2) return "expected a spectrum of at least two wavelengths";
  std::vector<Band> bands = s.bands;
  for (const DetectorSpec& d : scene.detectors) {
    const std::vector<Band> more = bands_of(scene, table_row("detector", d.kind));
    if (s.bands.empty()) bands.insert(bands.end(), more.begin(), more.end());
  }
  for (const Band& band : bands) {
    if (!(source_band_W_m2(s, band) > 0.0)) {
      return fmt::format("the source has no light in the band {}: its spectrum does not overlap it", band.name);
    }
  }
  return "";
}

void check_scene(const Scene& scene) {
  if (scene.components.empty()) fail("components", "missing; expected at least one");
  if (scene.observers.empty()) fail("observers", "missing; expected at least one");
  if (scene.detectors.empty()) fail("detectors", "missing; expected at least one");
  check_place("reference_point", scene.reference_point);
  check_names("materials", scene.materials);
  check_names("components", scene.components);
  check_names("observers", scene.observers);
  check_names("detectors", scene.detectors);
  check_names("variants", scene.variants);
  check_names("source.bands", scene.source.bands);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    check_material("materials[" + std::to_string(i) + "]", scene.materials[i]);
  }
  double body_m = 0.0;
  for (std::size_t i = 0; i < scene.components.size(); ++i) {
    body_m = std::max(body_m, check_component(fmt::format("components[{}]", i), scene, scene.components[i]));
  }
  if (const double distance = largest(scene.reference_point); !(distance <= kFarthest * body_m)) {
    fail("reference_point", fmt::format("lies {:.6g} m from the origin, where delays have no digits left for the body; "
                                        "expected at most {:g} times its {:.6g} m",
                                        distance, kFarthest, body_m));
  }
  std::unordered_set<std::string_view> defined;
  if (!scene.variants.empty()) {
    for (const Material& m : scene.materials) defined.insert(m.name);
  }
  for (std::size_t i = 0; i < scene.variants.size(); ++i) {
    const std::string where = fmt::format("variants[{}].materials", i);
    check_names(where, scene.variants[i].materials);
    for (const Material& m : scene.variants[i].materials) {
      if (defined.count(m.name) == 0) fail(where, "nobody defines a material \"" + m.name + "\"");
      check_material(where, m);
    }
  }
  check_keys("source", scene.source);
  for (std::size_t i = 0; i < scene.observers.size(); ++i) {
    check_keys(fmt::format("observers[{}]", i), scene.observers[i]);
  }
  for (std::size_t i = 0; i < scene.detectors.size(); ++i) {
    const std::string where = fmt::format("detectors[{}]", i);
    check_row(where, row_of(where, ".kind", "detector", scene.detectors[i].kind), scene.detectors[i].parameters);
    const std::string fault = detector_fault(scene.detectors[i]);
    if (!fault.empty()) fail(where, fault);
  }
  const std::string dark = source_fault(scene);
  if (!dark.empty()) fail("source.bands", dark);
  if (scene.motion) check_motion(*scene.motion);
  check_views(scene);
  if (scene.station) check_keys("station", *scene.station);
  check_pass(scene);
  check_ranging(scene);
  check_trace(scene.trace);
}

}  // namespace clray
