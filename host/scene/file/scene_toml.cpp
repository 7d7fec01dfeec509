// SPDX-License-Identifier: Apache-2.0
// Reads a scene file (TOML): the top of the file, materials, components and variants; scene_toml_light.cpp has the
// rest. Keys of shapes and models come from shape.def and brdf.def. Lengths in m, angles in degrees in the file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "clray/error.hpp"
#include "clray/keys.hpp"
#include "scene/file/material.hpp"
#include "scene/file/value_checks.hpp"
#include "scene/scene_parts.hpp"
#include "scene/tables.hpp"
#include "shared/portable.h"

namespace clray {
namespace {

namespace fs = std::filesystem;

/// To radians. Whole turns are taken off before, while that is exact.
double radians(double degrees) {
  return std::fmod(degrees, 360.0) / 180.0 * CLRAY_PI;
}

double length_unit(TomlTable& root) {
  const toml::node* value = root.node("length_unit");
  if (value == nullptr) return 1.0;
  if (!value->is_string()) return root.number("length_unit", kPositive);
  std::vector<std::string> names;
  for (const auto& [name, metres] : length_units()) names.push_back(name);
  const std::string unit = root.choice("length_unit", names);
  return length_units()[static_cast<std::size_t>(std::find(names.begin(), names.end(), unit) - names.begin())].second;
}

void read_materials(TomlTable& root, MaterialBook* book) {
  for (TomlTable& t : root.tables("material")) {
    Material m = read_material(t);
    if (book->find(m.name) >= 0) t.fail("name", "a second material of the name \"" + m.name + "\"");
    book->add(std::move(m));
  }
  book->close();
}

std::vector<std::string> material_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const Material& m : scene.materials) names.push_back(m.name);
  return names;
}

/// A material's name, which a [[material]] must have.
std::string known_material(TomlTable& t, const std::string& key, const Scene& scene, const MaterialBook& book) {
  std::string name = t.text(key);
  if (book.find(name) < 0) {
    t.fail(key, "nobody defines a material \"" + name + "\"" + did_you_mean(name, material_names(scene)));
  }
  return name;
}

constexpr Range kAngle_deg{-kLargestAngle_deg, kLargestAngle_deg, true, true};

/// A place within the limits of a scene.
Vec3 read_place(TomlTable& t, const std::string& key, const Vec3& fallback) {
  const Vec3 place = t.vector(key, fallback);
  const std::string fault = place_fault(place);
  if (!fault.empty()) t.fail(key, fault);
  return place;
}

Transform read_transform(TomlTable& t) {
  Transform r;
  r.translate = read_place(t, "translate", r.translate);
  r.axis = t.direction("axis", r.axis);
  r.angle_rad = radians(t.number("angle_deg", kAngle_deg, 0.0));
  r.scale = t.number("scale", kPositive, 1.0);
  t.finish();
  return r;
}

Hinge read_hinge(TomlTable& t) {
  Hinge h;
  h.axis = t.direction("axis");
  h.point = read_place(t, "point", h.point);
  h.angle_rad = radians(t.number("angle_deg", kAngle_deg, 0.0));
  const std::string follow = t.choice("follow", {"none", "source", "observer"}, "none");
  h.follow = follow == "source"     ? Hinge::Follow::source
             : follow == "observer" ? Hinge::Follow::observer
                                    : Hinge::Follow::none;
  t.finish();
  return h;
}

/// Keys named X_x, X_y(, X_z) may be given together, as X = [a, b(, c)].
void read_grouped(TomlTable& t, const TableRow& row, Component* c) {
  std::vector<const TableKey*> group;
  for (const TableKey& key : row.keys) {
    const std::size_t n = key.name.size();
    if (n > 2 && key.name[n - 2] == '_' && key.name[n - 1] >= 'x' && key.name[n - 1] <= 'z') group.push_back(&key);
  }
  if (group.empty()) return;
  const std::string name = group[0]->name.substr(0, group[0]->name.size() - 2);
  const toml::node* value = t.node(name);
  if (value == nullptr) return;
  const toml::array* array = value->as_array();
  if (array == nullptr || array->size() != group.size()) {
    t.fail(name, fmt::format("expected an array of {} numbers, found {}", group.size(), found(*value)));
  }
  for (std::size_t i = 0; i < group.size(); ++i) {
    const TableKey& key = *group[i];
    if (t.has(key.name)) t.fail(key.name, "given twice, here and in " + name);
    const Range range{key.low, key.high, key.low_included, key.high_included};
    c->parameters[key.name] = t.number_of(*array->get(i), name, range);
  }
}

void read_shape(TomlTable& t, Component* c) {
  c->shape = t.choice("shape", row_names("shape"), "mesh");
  const TableRow& row = table_row("shape", c->shape);
  read_grouped(t, row, c);
  for (const TableKey& key : row.keys) {
    if (const std::optional<double> value = t.row_key(key)) c->parameters[key.name] = *value;
  }
  const std::string fault = shape_fault(*c);
  if (!fault.empty()) throw Error(ErrorCode::input, "component." + fault, t.place());
}

/// Meshes by their canonical path, so that components that name one file share it.
using MeshCache = std::map<std::string, std::shared_ptr<const Mesh>>;

void read_mesh(TomlTable& t, double unit_m, const SceneOptions& options, MeshCache* cache, Scene* scene, Component* c) {
  if (!options.meshes.empty()) {
    const auto in_memory = options.meshes.find(t.text("file"));
    if (in_memory != options.meshes.end()) {
      if (in_memory->second == nullptr) t.fail("file", "is no mesh, but null");
      c->mesh = in_memory->second;
      return;
    }
  }
  const std::string file = t.file("file");
  std::shared_ptr<const Mesh>& mesh = (*cache)[fs::weakly_canonical(file).string()];
  if (!mesh) {
    mesh = load_mesh(file, unit_m);
    scene->warnings.insert(scene->warnings.end(), mesh->warnings.begin(), mesh->warnings.end());
  }
  c->mesh = mesh;
}

void read_component_materials(TomlTable& t, Scene* scene, MaterialBook* book, Component* c) {
  const std::string common = t.has("material") ? known_material(t, "material", *scene, *book) : "";
  std::map<std::string, std::string> by_slot;
  if (c->mesh) {
    if (std::optional<TomlTable> map = t.table("materials")) {
      const std::vector<std::string>& slots = c->mesh->material_slots;
      const std::set<std::string_view> known(slots.begin(), slots.end());
      for (const std::string& slot : map->keys()) {
        if (known.count(slot) == 0) {
          map->fail(slot, "the mesh has no material of this name" + did_you_mean(slot, slots) + "; it has " +
                              fmt::format("{}", fmt::join(slots, ", ")));
        }
        by_slot[slot] = known_material(*map, slot, *scene, *book);
      }
    }
  }
  if (book->assign(c, by_slot, common)) {
    scene->warnings.push_back(
        fmt::format("{}: component '{}' has no material for all of its surface: lambert, rho 0.5", t.place(), c->name));
  }
}

/// Names of components: given ones, and ones made of the shape that no earlier component has.
class ComponentNames {
 public:
  std::string next(TomlTable& t, const std::string& shape) {
    std::string name = t.has("name") ? t.name("name") : shape;
    if (taken_.insert(name).second) return name;
    if (t.has("name")) t.fail("name", "a second component of the name \"" + name + "\"");
    int& number = last_.emplace(shape, 1).first->second;
    do {
      name = fmt::format("{}-{}", shape, ++number);
    } while (!taken_.insert(name).second);
    return name;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> last_;  // number given to a component of each shape
};

void read_variants(TomlTable& root, Scene* scene, const MaterialBook& book) {
  std::set<std::string> taken;
  for (TomlTable& t : root.tables("variant")) {
    Variant v;
    v.name = t.name("name");
    if (!taken.insert(v.name).second) t.fail("name", "a second variant of the name \"" + v.name + "\"");
    std::set<std::string> replaced;
    for (TomlTable& m : t.tables("material")) {
      const std::string name = known_material(m, "name", *scene, book);
      if (!replaced.insert(name).second)
        m.fail("name", "a second material of the name \"" + name + "\" in this variant");
      const auto base = static_cast<std::size_t>(book.find(name));
      v.materials.push_back(read_material(m, &scene->materials[base]));
    }
    t.finish();
    if (v.materials.empty()) t.fail("material", "missing; expected at least one material to replace");
    scene->variants.push_back(std::move(v));
  }
}

/// [[component]] tables: shapes, meshes (shared by file), transforms, hinges, materials.
void read_components(TomlTable& root, const SceneOptions& options, double length_unit_m, Scene* scene,
                     MaterialBook* book) {
  MeshCache cache;
  ComponentNames names;
  for (TomlTable& t : root.tables("component")) {
    Component c;
    read_shape(t, &c);
    c.name = names.next(t, c.shape);
    if (std::optional<TomlTable> transform = t.table("transform")) c.transform = read_transform(*transform);
    if (std::optional<TomlTable> hinge = t.table("hinge")) c.hinge = read_hinge(*hinge);
    t.know({"material"});
    if (table_row("shape", c.shape).file) {
      t.know({"file", "materials"});
      read_mesh(t, length_unit_m, options, &cache, scene, &c);
    }
    read_component_materials(t, scene, book, &c);
    t.finish();
    if (const std::string fault = distance_fault(c); !fault.empty())
      throw Error(ErrorCode::input, "component." + fault, t.place());
    scene->components.push_back(std::move(c));
  }
  if (scene->components.empty()) {
    root.finish();
    root.fail("component", "missing; expected at least one [[component]]");
  }
}

}  // namespace

Scene read_scene_text(const std::string& text, const std::string& path, const SceneOptions& options) {
  const toml::table parsed = parse_toml(text, path);
  TomlTable root(parsed, "", path, &options.files);
  root.know({"length_unit", "reference_point", "material", "component", "variant", "source", "observer", "motion",
             "pass", "station", "detector", "trace"});
  Scene scene;
  scene.path = path;
  scene.name = fs::path(path).stem().string();
  const double unit_m = length_unit(root);
  scene.reference_point = read_place(root, "reference_point", scene.reference_point);
  root.finish();
  MaterialBook book(&scene);
  read_materials(root, &book);
  read_components(root, options, options.length_unit_m > 0.0 ? options.length_unit_m : unit_m, &scene, &book);
  read_variants(root, &scene, book);
  read_detectors(root, &scene);
  read_pass(root, &scene);
  read_source(root, &scene);
  read_observers(root, &scene);
  read_pass_directions(root, &scene);
  read_motion(root, &scene);
  read_station(root, &scene);
  read_trace(root, &scene);
  return scene;
}

}  // namespace clray
