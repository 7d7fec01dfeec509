// SPDX-License-Identifier: Apache-2.0
// load_scene(): a scene file or a bare mesh, then what the command line says, then the checks. A bare mesh is seen
// from +z by a monostatic 532 nm station with the detector `delay`, Lambert rho = 0.5 where no MTL speaks; if only
// pictures are asked for, it is lit by the Sun from over the viewer's shoulder.
#include "clray/scene.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>

#include "clray/error.hpp"
#include "scene/file/material.hpp"
#include "scene/file/value_checks.hpp"
#include "scene/mesh/foreign_format.hpp"
#include "scene/scene_parts.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"
#include "text/input_file.hpp"
#include "text/text.hpp"

namespace clray {
namespace {

namespace fs = std::filesystem;

Scene bare_mesh(const std::string& path, const SceneOptions& options) {
  Scene scene;
  scene.path = path;
  scene.name = fs::path(path).stem().string();
  Component component;
  component.name = scene.name;
  component.mesh = load_mesh(path, options.length_unit_m > 0.0 ? options.length_unit_m : 1.0);
  scene.warnings = component.mesh->warnings;
  MaterialBook(&scene).assign(&component, {}, "");
  scene.components.push_back(std::move(component));
  return scene;
}

Vec3 option_direction(const Vec3& v, const std::string& option) {
  if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z) || v == Vec3(0.0)) {
    throw Error(ErrorCode::usage, "expected three finite numbers X,Y,Z that are not all zero", option);
  }
  return unit_vector(v);
}

/// Lights a bare mesh by the Sun from over the viewer's left shoulder if only pictures are asked for. Light from the
/// viewer's own eye, such as a laser station's, shows no relief. A mesh with colours is seen in three bands.
void light_for_pictures(const SceneOptions& options, Scene* scene) {
  const bool pictures = std::all_of(scene->detectors.begin(), scene->detectors.end(),
                                    [](const DetectorSpec& d) { return table_row("detector", d.kind).pixel; });
  if (!pictures || options.source || options.observer_at_source) return;
  scene->source.kind = Source::Kind::sun;
  const bool coloured = std::any_of(scene->materials.begin(), scene->materials.end(),
                                    [](const Material& m) { return !m.spectra.empty(); });
  if (coloured) {
    // The bands of the colours of an MTL.
    for (const double low : {400.0, 500.0, 600.0}) scene->source.bands.push_back(make_band(low, low + 100.0));
  }
  Observer& observer = scene->observers.front();
  observer.monostatic = false;
  const Vec3 o = observer.direction;
  // The picture's own axes (host/pipeline/views.cpp): up is +y, or ±z where the view is along it.
  Vec3 up(0.0, 1.0, 0.0);
  if (std::fabs(o.y) > 0.999) up = Vec3(0.0, 0.0, o.y > 0.0 ? -1.0 : 1.0);
  const Vec3 right = glm::normalize(glm::cross(up, o));
  scene->source.direction = glm::normalize(o - 0.35 * right + 0.45 * glm::cross(o, right));
}

/// The detectors of the kinds asked for. A kind that the scene file has keeps the file's options.
void apply_detectors(const SceneOptions& options, Scene* scene) {
  if (!options.detectors.empty()) {
    std::vector<DetectorSpec> chosen;
    for (const std::string& kind : options.detectors) {
      if (table_index("detector", kind) < 0) {
        std::string known;
        for (const std::string& name : row_names("detector")) known += (known.empty() ? "" : ", ") + name;
        throw Error(
            ErrorCode::usage,
            "unknown detector '" + kind + "'; expected one of " + known + did_you_mean(kind, row_names("detector")),
            "--detector");
      }
      const std::size_t before = chosen.size();
      const bool again =
          std::any_of(chosen.begin(), chosen.end(), [&](const DetectorSpec& d) { return d.kind == kind; });
      if (again) continue;
      for (const DetectorSpec& d : scene->detectors) {
        if (d.kind == kind) chosen.push_back(d);
      }
      if (chosen.size() == before) chosen.push_back({kind, kind, {}});
    }
    scene->detectors = chosen;
  }
  if (scene->detectors.empty()) scene->detectors.push_back({"delay", "delay", {}});
  if (!options.bins) return;
  bool used = false;
  for (DetectorSpec& d : scene->detectors) {
    const TableKey* key = find_key(table_row("detector", d.kind), "bins");
    if (key == nullptr) continue;
    std::string expected;
    if (!key_accepts(*key, *options.bins, &expected)) throw Error(ErrorCode::usage, "expected " + expected, "--bins");
    d.parameters["bins"] = *options.bins;
    d.parameters.erase("bin_ps");
    used = true;
  }
  if (!used) throw Error(ErrorCode::usage, "needs a detector with bins, such as delay", "--bins");
}

/// One observer in the given direction, or at the source. It keeps the keys in which all observers of the scene agree.
void replace_observers(const SceneOptions& options, Scene* scene) {
  const std::vector<Observer>& before = scene->observers;
  Observer one = before.empty() ? Observer{} : before.front();
  if (before.size() > 1) {
    const auto shared = [&](auto member) {
      return std::all_of(before.begin(), before.end(), [&](const Observer& o) { return o.*member == one.*member; });
    };
    std::string lost;
    const auto keep = [&](auto member, const char* key) {
      if (shared(member)) return;
      one.*member = Observer{}.*member;
      lost += std::string(lost.empty() ? "; they differ in " : ", ") + key + ", which is left out";
    };
    keep(&Observer::range_m, "range_m");
    keep(&Observer::acceptance_rad, "acceptance_mrad");
    one.name.clear();
    scene->warnings.push_back("--observer stands instead of the scene's " + text::counted(before.size(), "observer") +
                              lost);
  }
  one.monostatic = !options.observer;
  one.toward = Toward::fixed;
  if (options.observer) one.direction = option_direction(*options.observer, "--observer");
  scene->observers = {one};
}

void apply_options(const SceneOptions& options, Scene* scene) {
  if (!options.material.empty()) {
    scene->materials = {parse_material(options.material)};
    for (Component& c : scene->components) c.materials.assign(c.materials.size(), 0);
    if (!scene->variants.empty()) scene->warnings.push_back("--material overrides the variants of the scene");
    scene->variants.clear();
  }
  if (options.source) {
    scene->source.direction = option_direction(*options.source, "--source");
    scene->source.toward = Toward::fixed;
  }
  if (options.observer || options.observer_at_source) replace_observers(options, scene);
  if (scene->observers.empty()) scene->observers = {Observer{}};
  for (Observer& o : scene->observers) {
    if (o.monostatic) o.direction = scene->source.direction;
  }
  apply_detectors(options, scene);
}

/// A picture in one band has no colour, whatever its materials have.
void warn_of_lost_colour(Scene* scene) {
  const bool picture = std::any_of(scene->detectors.begin(), scene->detectors.end(),
                                   [](const DetectorSpec& d) { return d.kind == "rgb"; });
  if (!picture || bands_of(*scene).size() > 1) return;
  for (const Material& m : scene->materials) {
    if (m.spectra.empty()) continue;
    scene->warnings.push_back("the picture has one band, so the colour of material '" + m.name +
                              "' is lost: give a sun as [source] and bands = [[400, 500], [500, 600], [600, 700]]");
    return;
  }
}

}  // namespace

namespace {

/// What load_scene() does when a scene or a bare mesh is read.
Scene finished(Scene scene, bool mesh, const SceneOptions& options) {
  apply_options(options, &scene);
  if (mesh) light_for_pictures(options, &scene);
  check_scene(scene);
  warn_of_lost_colour(&scene);
  const std::vector<std::string> more = ranging_warnings(scene);
  scene.warnings.insert(scene.warnings.end(), more.begin(), more.end());
  return scene;
}

Scene read_and_finished(const std::string& text, const std::string& path, const SceneOptions& options) {
  try {
    return finished(read_scene_text(text, path, options), false, options);
  } catch (const Error& error) {
    throw placed_in_file(error, text, path);
  }
}

/// Of a bare mesh its only component can be at fault.
Scene mesh_and_finished(const std::string& path, const SceneOptions& options) {
  Scene scene = bare_mesh(path, options);
  try {
    return finished(std::move(scene), true, options);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input || error.context().rfind("components[0]", 0) != 0) throw;
    throw Error(error.code(), error.message(), path);
  }
}

void check_unit_of(const SceneOptions& options) {
  if (!(options.length_unit_m >= 0.0 && std::isfinite(options.length_unit_m))) {
    throw Error(ErrorCode::usage, "expected a positive number of metres", "--length-unit");
  }
}

}  // namespace

Scene parse_scene(const std::string& text, const std::string& path, const SceneOptions& options) {
  check_unit_of(options);
  return read_and_finished(text, path, options);
}

Error placed_in_file(const Error& error, const std::string& path) {
  if (extension_of(path) != ".toml" || !text::input_file_fault(path).empty()) return error;
  return placed_in_file(error, text::read_input_file(path), path);
}

Scene load_scene(const std::string& path, const SceneOptions& options) {
  check_unit_of(options);
  const std::string extension = extension_of(path);
  const bool mesh = extension == ".obj" || extension == ".ply" || extension == ".stl" || extension == ".off";
  if (!mesh && extension != ".toml") {
    const std::string foreign = foreign_format(path);
    throw Error(
        ErrorCode::input,
        (foreign.empty() ? "" : foreign + "; ") + "expected a scene file (.toml) or a mesh (.obj .ply .stl .off)",
        path);
  }
  if (const std::string fault = text::input_file_fault(path); !fault.empty())
    throw Error(ErrorCode::input, fault, path);
  return mesh ? mesh_and_finished(path, options) : read_and_finished(text::read_input_file(path), path, options);
}

}  // namespace clray
