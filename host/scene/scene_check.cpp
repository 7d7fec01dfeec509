// SPDX-License-Identifier: Apache-2.0
// check_scene(): what load_scene() demands of a file, demanded of a scene built by hand. Errors name the member by
// its path ("components[2].radius"), for want of a line. The faults of several values taken together are shared.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "clray/error.hpp"
#include "scene/material.hpp"
#include "scene/motion.hpp"
#include "scene/scene_parts.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

[[noreturn]] void fail(const std::string& where, const std::string& message) {
  throw Error(ErrorCode::input, message, where);
}

void check_number(const std::string& where, double value, const Range& r) {
  const bool low = r.low_included ? value >= r.low : value > r.low;
  const bool high = r.high_included ? value <= r.high : value < r.high;
  if (!std::isfinite(value) || !low || !high) {
    fail(where, fmt::format("expected a number in {}, found {}", range_text(r), value));
  }
}

void check_vector(const std::string& where, const Vec3& v) {
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(v[i])) fail(where, "expected three finite numbers");
  }
}

void check_unit(const std::string& where, const Vec3& v) {
  check_vector(where, v);
  const double square = v.x * v.x + v.y * v.y + v.z * v.z;
  // A vector normalised in any sensible way is within a few ulp; 1e-12 allows for single steps of arithmetic after.
  if (!(std::fabs(square - 1.0) <= 1e-12)) {
    fail(where, fmt::format("expected a unit vector, found length {}", std::sqrt(square)));
  }
}

void check_keys(const std::string& where, const TableRow& row, const std::map<std::string, double>& parameters) {
  std::vector<std::string> known;
  for (const TableKey& key : row.keys) known.push_back(key.name);
  for (const auto& [name, value] : parameters) {
    const TableKey* key = find_key(row, name);
    if (key == nullptr) {
      fail(where, fmt::format("unknown key '{}' of '{}'{}", name, row.name, did_you_mean(name, known)));
    }
    std::string expected;
    if (!key_accepts(*key, value, &expected)) {
      fail(where + "." + name, fmt::format("expected {}, found {}", expected, value));
    }
  }
}

const TableRow& row_of(const std::string& where, const std::string& kind, const std::string& name) {
  const int index = table_index(kind, name);
  if (index < 0) {
    fail(where, fmt::format("expected one of {}, found \"{}\"{}", fmt::join(row_names(kind), ", "), name,
                            did_you_mean(name, row_names(kind))));
  }
  return table(kind)[static_cast<std::size_t>(index)];
}

void check_spectrum(const std::string& where, const Spectrum& s, const TableKey* key) {
  if (s.wavelength_nm.empty() || s.wavelength_nm.size() != s.value.size())
    fail(where, "expected one value per wavelength");
  for (std::size_t i = 0; i < s.value.size(); ++i) {
    check_number(where, s.wavelength_nm[i], kPositive);
    if (i > 0 && !(s.wavelength_nm[i] > s.wavelength_nm[i - 1])) fail(where, "wavelengths must increase");
    std::string expected;
    if (key != nullptr && !key_accepts(*key, s.value[i], &expected)) {
      fail(where, fmt::format("expected {}, found {}", expected, s.value[i]));
    }
    if (key == nullptr) check_number(where, s.value[i], kNotNegative);
  }
}

void check_table(const std::string& where, const BrdfTable& t) {
  for (const std::vector<double>* axis : {&t.theta_i_rad, &t.theta_o_rad, &t.phi_rad}) {
    if (axis->empty() || !std::is_sorted(axis->begin(), axis->end(), std::less_equal<double>())) {
      fail(where, "expected increasing angles");
    }
  }
  if (t.value.size() != t.theta_i_rad.size() * t.theta_o_rad.size() * t.phi_rad.size()) {
    fail(where, "expected one value per combination of angles");
  }
  for (const double value : t.value) check_number(where, value, kNotNegative);
}

void check_material(const std::string& where, const Material& m) {
  const TableRow& row = row_of(where + ".model", "brdf", m.model);
  check_keys(where, row, m.parameters);
  check_number(where + ".infrared_reflectance", m.infrared_reflectance, kShare);
  for (const auto& [name, spectrum] : m.spectra) {
    const TableKey* key = find_key(row, name);
    if (key == nullptr) fail(where, fmt::format("unknown key '{}' of '{}'", name, row.name));
    check_spectrum(where + "." + name, spectrum, key);
  }
  if (row.file) {
    if (!m.table) fail(where + ".table", fmt::format("missing; the model '{}' needs a table", row.name));
    check_table(where + ".table", *m.table);
  }
}

void check_component(const std::string& where, const Scene& scene, const Component& c) {
  const TableRow& row = row_of(where + ".shape", "shape", c.shape);
  check_keys(where, row, c.parameters);
  const std::string fault = shape_fault(c);
  if (!fault.empty()) fail(where, fault);
  std::size_t slots = 1;
  if (row.file) {
    if (!c.mesh || c.mesh->triangles.empty()) fail(where + ".mesh", "missing; expected a mesh with triangles");
    if (c.mesh->triangle_slot.size() != c.mesh->triangles.size())
      fail(where + ".mesh", "expected one slot per triangle");
    slots = c.mesh->material_slots.size();
    for (const std::uint32_t slot : c.mesh->triangle_slot) {
      if (slot >= slots) fail(where + ".mesh", "a triangle's slot is beyond material_slots");
    }
    for (const auto& t : c.mesh->triangles) {
      for (const std::uint32_t v : t) {
        if (v >= c.mesh->vertices.size()) fail(where + ".mesh", "a triangle's vertex is beyond vertices");
      }
    }
  }
  if (c.materials.size() != slots) {
    fail(where + ".materials", fmt::format("expected {} of them, found {}", slots, c.materials.size()));
  }
  for (const std::uint32_t m : c.materials) {
    if (m >= scene.materials.size()) fail(where + ".materials", fmt::format("there is no material {}", m));
  }
  check_vector(where + ".transform.translate", c.transform.translate);
  check_unit(where + ".transform.axis", c.transform.axis);
  check_number(where + ".transform.angle_rad", c.transform.angle_rad, kAny);
  check_number(where + ".transform.scale", c.transform.scale, kPositive);
  if (!c.hinge) return;
  check_unit(where + ".hinge.axis", c.hinge->axis);
  check_vector(where + ".hinge.point", c.hinge->point);
  check_number(where + ".hinge.angle_rad", c.hinge->angle_rad, kAny);
}

void check_source(const Source& s) {
  check_unit("source.direction", s.direction);
  if (s.kind == Source::Kind::laser) check_number("source.wavelength_nm", s.wavelength_nm, kPositive);
  if (s.spectrum) check_spectrum("source.spectrum", *s.spectrum, nullptr);
  check_number("source.blackbody_K", s.blackbody_K, kNotNegative);
  check_number("source.irradiance_W_m2", s.irradiance_W_m2, kPositive);
  for (const Band& b : s.bands) {
    check_number("source.bands", b.low_nm, kPositive);
    check_number("source.bands", b.high_nm, {b.low_nm, kInfinity, false, false});
    if (b.response) check_spectrum("source.bands.response", *b.response, nullptr);
  }
  const std::string fault = source_fault(s);
  if (!fault.empty()) fail("source.bands", fault);
}

void check_motion(const Motion& m) {
  check_number("motion.start_s", m.start_s, kAny);
  check_number("motion.stop_s", m.stop_s, {m.start_s, kInfinity, true, false});
  if (m.attitudes.empty()) {
    check_unit("motion.axis", m.axis);
    check_number("motion.period_s", m.period_s, kPositive);
    check_number("motion.phase_rad", m.phase_rad, kAny);
    check_number("motion.step_rad", m.step_rad, kPositive);
  }
  for (std::size_t i = 0; i < m.attitudes.size(); ++i) {
    const Quaternion& q = m.attitudes[i].body_to_space;
    const double square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
    check_number("motion.attitudes.time_s", m.attitudes[i].time_s, kAny);
    if (i > 0 && !(m.attitudes[i].time_s > m.attitudes[i - 1].time_s)) fail("motion.attitudes", "times must increase");
    if (!(std::fabs(square - 1.0) <= 1e-9)) fail("motion.attitudes", "expected quaternions of length 1");
  }
  if (!m.attitudes.empty() && !(m.start_s == 0.0 && m.stop_s == 0.0)) {
    const double first = m.attitudes.front().time_s, last = m.attitudes.back().time_s;
    check_number("motion.start_s", m.start_s, {first, last, true, true});
    check_number("motion.stop_s", m.stop_s, {first, last, true, true});
  }
  orientation_count(m);
}

void check_pairs(const std::string& where, const std::vector<std::pair<double, double>>& pairs, const Range& range) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    check_number(where, pairs[i].first, kAny);
    check_number(where, pairs[i].second, range);
    if (i > 0 && !(pairs[i].first > pairs[i - 1].first)) fail(where, "times must increase");
  }
}

void check_station(const Station& s) {
  check_number("station.range_m", s.range_m, kPositive);
  check_pairs("station.ranges", s.ranges, kPositive);
  check_pairs("station.pulse", s.pulse, kNotNegative);
  check_vector("station.position_m", s.position_m);
  if (!s.cpf_file.empty() && s.position_m == Vec3(0.0)) fail("station.position_m", "missing; a prediction needs it");
  const std::pair<const char*, double> positive[] = {{"pulse_energy_J", s.pulse_energy_J},
                                                     {"rate_Hz", s.rate_Hz},
                                                     {"aperture_m", s.aperture_m},
                                                     {"divergence_rad", s.divergence_rad},
                                                     {"gate_s", s.gate_s}};
  for (const auto& [name, value] : positive) check_number(std::string("station.") + name, value, kPositive);
  const std::pair<const char*, double> not_negative[] = {
      {"start_mjd", s.start_mjd},       {"pulse_fwhm_s", s.pulse_fwhm_s}, {"pointing_rad", s.pointing_rad},
      {"noise_per_ns", s.noise_per_ns}, {"dark_per_ns", s.dark_per_ns},   {"jitter_fwhm_s", s.jitter_fwhm_s},
      {"dead_time_s", s.dead_time_s}};
  for (const auto& [name, value] : not_negative) check_number(std::string("station.") + name, value, kNotNegative);
  const std::pair<const char*, double> shares[] = {
      {"eta_q", s.eta_q}, {"eta_t", s.eta_t}, {"eta_r", s.eta_r}, {"T_a", s.T_a}, {"T_c", s.T_c}};
  for (const auto& [name, value] : shares) check_number(std::string("station.") + name, value, kShare);
}

void check_trace(const TraceOptions& o) {
  check_number("trace.max_bounces", o.max_bounces, {1.0, 64.0, true, true});
  check_number("trace.target_error_percent", o.target_error_percent, {0.0, 100.0, true, true});
  check_number("trace.time_limit_s", o.time_limit_s, kNotNegative);
  check_number("trace.replicates", o.replicates, {2.0, 64.0, true, true});
  check_number("trace.max_rays", static_cast<double>(o.max_rays), {1.0, 0x1p40, true, true});
  check_number("trace.work_group_size", o.work_group_size, {1.0, 1024.0, true, true});
  check_number("trace.rays", static_cast<double>(o.rays), {0.0, 0x1p40, true, true});
}

/// Names that key results must differ, and one alone may be empty.
template <typename List>
void check_names(const std::string& where, const List& list) {
  std::set<std::string> names;
  for (const auto& each : list) {
    if (!names.insert(each.name).second) fail(where, "a second one of the name \"" + each.name + "\"");
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
    if (row.keys[i].name == "radius") radius = values[i];
    if (row.keys[i].name == "inner_radius") inner = values[i];
  }
  if (inner >= radius && inner >= 0.0 && radius > 0.0) {
    return fmt::format("inner_radius: expected less than radius = {}, found {}", radius, inner);
  }
  return "";
}

std::string detector_fault(const DetectorSpec& d) {
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

std::string source_fault(const Source& s) {
  if (s.kind != Source::Kind::sun) return "";
  if (s.spectrum && s.spectrum->wavelength_nm.size() < 2) return "expected a spectrum of at least two wavelengths";
  Scene scene;
  scene.source = s;
  for (const Band& band : bands_of(scene)) {
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
  check_vector("reference_point", scene.reference_point);
  check_names("materials", scene.materials);
  check_names("components", scene.components);
  check_names("observers", scene.observers);
  check_names("detectors", scene.detectors);
  check_names("variants", scene.variants);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    check_material(fmt::format("materials[{}]", i), scene.materials[i]);
  }
  for (std::size_t i = 0; i < scene.components.size(); ++i) {
    check_component(fmt::format("components[{}]", i), scene, scene.components[i]);
  }
  for (std::size_t i = 0; i < scene.variants.size(); ++i) {
    const std::string where = fmt::format("variants[{}].materials", i);
    check_names(where, scene.variants[i].materials);
    for (const Material& m : scene.variants[i].materials) {
      if (find_material(scene, m.name) < 0) fail(where, "nobody defines a material \"" + m.name + "\"");
      check_material(where, m);
    }
  }
  check_source(scene.source);
  for (std::size_t i = 0; i < scene.observers.size(); ++i) {
    const std::string where = fmt::format("observers[{}]", i);
    if (!scene.observers[i].monostatic) check_unit(where + ".direction", scene.observers[i].direction);
    check_number(where + ".acceptance_rad", scene.observers[i].acceptance_rad, {0.0, 3.141592653589794, true, true});
    check_number(where + ".range_m", scene.observers[i].range_m, kNotNegative);
  }
  for (std::size_t i = 0; i < scene.detectors.size(); ++i) {
    const std::string where = fmt::format("detectors[{}]", i);
    check_keys(where, row_of(where + ".kind", "detector", scene.detectors[i].kind), scene.detectors[i].parameters);
    const std::string fault = detector_fault(scene.detectors[i]);
    if (!fault.empty()) fail(where, fault);
  }
  if (scene.motion) check_motion(*scene.motion);
  if (scene.station) check_station(*scene.station);
  check_trace(scene.trace);
}

}  // namespace clray
