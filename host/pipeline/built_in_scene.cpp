// SPDX-License-Identifier: Apache-2.0
// See built_in_scene.hpp. Rows take the defaults of their keys, so that a new row needs nothing here.
#include "pipeline/built_in_scene.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "clray/error.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

constexpr std::size_t kFewest = 18;  // shapes in all: the BVH then has several levels

/// The place of the k-th component, on a spiral, so that no two places are alike.
Vec3 place(std::size_t k) {
  const double turn = 2.4 * static_cast<double>(k), out = 0.25 * std::sqrt(static_cast<double>(k));
  return {out * std::cos(turn), out * std::sin(turn), 0.3 * std::sin(1.7 * static_cast<double>(k))};
}

/// A ball of 6 by 4 cells.
std::shared_ptr<const Mesh> ball() {
  constexpr std::uint32_t kRound = 6, kRings = 3;
  constexpr double kTurn = 6.283185307179586;
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices = {{0, 0, -0.5}, {0, 0, 0.5}};
  for (std::uint32_t r = 0; r < kRings; ++r) {
    const double height = -0.35 + 0.35 * r, radius = std::sqrt(0.25 - height * height);
    for (std::uint32_t k = 0; k < kRound; ++k)
      mesh->vertices.push_back({radius * std::cos(kTurn * k / kRound), radius * std::sin(kTurn * k / kRound), height});
  }
  const auto at = [&](std::uint32_t r, std::uint32_t k) { return 2 + r * kRound + k % kRound; };
  for (std::uint32_t k = 0; k < kRound; ++k) {
    mesh->triangles.push_back({0, at(0, k + 1), at(0, k)});
    mesh->triangles.push_back({1, at(kRings - 1, k), at(kRings - 1, k + 1)});
    for (std::uint32_t r = 0; r + 1 < kRings; ++r) {
      mesh->triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k)});
      mesh->triangles.push_back({at(r, k + 1), at(r + 1, k + 1), at(r + 1, k)});
    }
  }
  mesh->triangle_slot.assign(mesh->triangles.size(), 0);
  mesh->material_slots = {""};
  return mesh;
}

std::shared_ptr<const BrdfTable> small_table() {
  auto table = std::make_shared<BrdfTable>();
  table->theta_i_rad = table->theta_o_rad = {0.0, 0.8, 1.5707963267948966};
  table->phi_rad = {0.0, 3.141592653589793};
  table->value = {0.2, 0.2, 0.15, 0.1, 0.1, 0.05, 0.15, 0.1, 0.25, 0.1, 0.05, 0.2, 0.1, 0.05, 0.05, 0.2, 0.1, 0.1};
  return table;
}

/// Makes lanes differ: the first number of each surface falls from lane to lane, toward half its value beyond the last
/// lane, if its key allows that.
void part_lanes(std::uint32_t lanes, MaterialTable* rows) {
  for (std::uint32_t l = 1; l < lanes; ++l) {
    for (std::uint32_t m = 0; m < rows->columns; ++m) {
      ClrayMaterial& material = rows->rows[l * rows->columns + m];
      const std::vector<TableKey>& keys = table("brdf")[material.model].keys;
      const double value = material.p[0] * (1.0 - 0.5 * l / lanes);
      if (!keys.empty() && !keys[0].is_switch && !keys[0].is_whole && key_accepts(keys[0], value))
        material.p[0] = value;
    }
  }
}

std::vector<Material> materials_of(const ProgramContent& content) {
  std::vector<Material> materials;
  for (const std::string& model : content.models) {
    const TableRow& row = table_row("brdf", model);
    Material material;
    material.name = model;
    material.model = model;
    if (row.file) material.table = small_table();
    materials.push_back(material);
    if (!content.one_sided) continue;
    material.name += " with a black back";
    material.two_sided = false;
    materials.push_back(material);
  }
  return materials;
}

std::vector<Component> components_of(const ProgramContent& content, std::size_t materials) {
  const std::shared_ptr<const Mesh> mesh = ball();
  std::vector<Component> components;
  const std::size_t all = (std::max(kFewest, content.shapes.size()) + content.shapes.size() - 1) /
                          content.shapes.size() * content.shapes.size();
  for (std::size_t k = 0; k < all; ++k) {
    const TableRow& row = table_row("shape", content.shapes[k % content.shapes.size()]);
    Component c;
    c.name = row.name + std::to_string(k);
    c.shape = row.name;
    if (row.file) c.mesh = mesh;
    c.materials = {static_cast<std::uint32_t>(k % materials)};
    c.transform.translate = place(k);
    c.transform.axis = {0.48, 0.6, 0.64};
    c.transform.angle_rad = 0.7 * static_cast<double>(k);
    c.transform.scale = 0.7;
    if (k == 0 && content.hinged) c.hinge = Hinge{{0, 0.6, 0.8}, {0.1, 0, 0}, 0.4, Hinge::Follow::none};
    components.push_back(c);
    if (!content.shared_planes || !row.flat || k + content.shapes.size() < all) continue;
    c.name += "b";  // at the same place
    c.materials = {static_cast<std::uint32_t>((k + 1) % materials)};
    components.push_back(c);
  }
  return components;
}

void add_light(const ProgramContent& content, Scene* scene) {
  scene->source.direction = glm::normalize(Vec3(0.3, -0.2, 0.9));
  for (std::uint32_t o = 0; o < content.connections; ++o) {
    Observer observer;
    observer.name = "o" + std::to_string(o);
    observer.monostatic = o == 0 && !content.pixels;
    observer.direction = glm::normalize(Vec3(0.1 + 0.3 * o, 0.5 - 0.1 * o, 0.8));
    observer.acceptance_rad = 0.4;
    scene->observers.push_back(observer);
  }
}

/// A request for this content.
PassRequest request_of(const ProgramContent& content, const Scene& scene) {
  PassRequest request;
  request.lanes.resize(content.lanes);
  request.pixels = content.pixels;
  request.mirrors = content.mirrors;
  request.replicates = content.walk == "packet" ? 16 : 2;
  request.picture = {4, 3, 0};
  for (std::size_t d = 0; d < scene.detectors.size(); ++d) request.detectors.push_back(static_cast<int>(d));
  for (std::size_t o = 0; o < scene.observers.size(); ++o) request.observers.push_back(static_cast<int>(o));
  for (const double tilt : {0.0, 0.7}) {
    Orientation orientation;
    orientation.source = glm::normalize(scene.source.direction + Vec3(0.0, tilt, -tilt));
    for (const Observer& observer : scene.observers)
      orientation.observers.push_back(observer.monostatic ? orientation.source : observer.direction);
    orientation.ranges_m.resize(scene.observers.size());
    request.orientations.push_back(orientation);
  }
  return request;
}

}  // namespace

ProgramContent content_of(const PassPlan& plan, bool specialised) {
  ProgramContent content;
  const ProgramOptions& options = plan.program.options;
  const auto has = [&](const char* name) { return options.defines.at(name) != "0"; };
  for (const int row : options.brdfs) content.models.push_back(table("brdf")[static_cast<std::size_t>(row)].name);
  for (const int row : options.shapes) content.shapes.push_back(table("shape")[static_cast<std::size_t>(row)].name);
  for (const PassDetector& d : plan.detectors) {
    const TableRow& row = table("detector")[static_cast<std::size_t>(d.row)];
    if (d.asked && !row.inner) content.detectors.push_back(row.name);
  }
  // A pass of mirrors is for a picture, whose own detectors look from pixels.
  for (const TableRow& row : table("detector")) {
    if (plan.request.mirrors && content.detectors.empty() && row.pixel && !row.inner) content.detectors = {row.name};
  }
  content.lanes = static_cast<std::uint32_t>(plan.request.lanes.size());
  content.connections = plan.traits.connections;
  content.components = plan.traits.components;
  content.pixels = plan.request.pixels;
  content.mirrors = plan.request.mirrors;
  content.scatter = has("CLRAY_SCATTER");
  content.sobol = has("CLRAY_SOBOL");
  content.strata = has("CLRAY_STRATA");
  content.hinged = has("CLRAY_INSTANCED");
  content.one_sided = has("CLRAY_ONE_SIDED");
  content.shared_planes = has("CLRAY_PLANES");
  content.pieces = has("CLRAY_PIECES");
  content.curved = has("CLRAY_CURVED");
  content.specialised = specialised;
  content.walk = table("walk")[static_cast<std::size_t>(options.walk)].name;
  return content;
}

namespace {

/// As if every other primitive were solved.
void leave_half_unsolved(const Geometry& geometry, PassPlan* plan) {
  UnsolvedPrimitives& unsolved = plan->unsolved;
  unsolved.words = static_cast<std::uint32_t>((geometry.primitives.size() + 31) / 32);
  unsolved.bits.assign(plan->beams.views.size() * unsolved.words, 0x55555555u);
  plan->constants.unsolved_words = unsolved.words;
}

}  // namespace

BuiltInScene built_in_scene(const ProgramContent& content) {
  Scene scene;
  scene.name = "built in";
  scene.materials = materials_of(content);
  scene.components = components_of(content, scene.materials.size());
  add_light(content, &scene);
  for (const std::string& kind : content.detectors) {
    DetectorSpec detector{kind, kind + std::to_string(scene.detectors.size()), {}};
    for (const TableKey& key : table_row("detector", kind).keys) {
      if (key.name == "bins") detector.parameters[key.name] = 16;
      if (key.name == "width") detector.parameters[key.name] = 4;
      if (key.name == "height") detector.parameters[key.name] = 3;
    }
    scene.detectors.push_back(detector);
  }
  scene.trace.max_bounces = content.scatter ? 3 : 1;
  scene.trace.sampler = !content.sobol   ? SamplerKind::random
                        : content.strata ? SamplerKind::strata
                                         : SamplerKind::sobol;
  scene.trace.specialise = content.specialised;
  scene.trace.walk = content.walk;
  BuiltInScene built{build_geometry(scene, content.pieces ? TreeFaces::pieces : TreeFaces::whole), {}};
  if (content.pieces) list_leaves(&built.geometry);  // which the program reads, whatever the scene
  for (ClrayPrimitive& primitive : built.geometry.primitives) primitive.component %= content.components;
  // Only the first, which may be hinged, is asked for again; their number is that of the sums.
  scene.components.resize(content.components, scene.components.back());
  built.plan = plan_pass(scene, built.geometry, request_of(content, scene), false);
  built.plan.constants.finest = 2;  // so few rays count as dense, and their shadow rays go in packets, too
  part_lanes(content.lanes, &built.plan.materials);
  if (content.curved) leave_half_unsolved(built.geometry, &built.plan);
  // Any table of directional reflectance will do, and true ones would take most of the test's time.
  for (ClrayMaterial& material : built.plan.materials.rows)
    material.reflectance = static_cast<std::uint32_t>(built.plan.materials.tables.size());
  for (const double number : {3.0, 0.0, 0.3, 1.0, 0.9, 0.7, 0.6}) built.plan.materials.tables.push_back(number);
  return built;
}

}  // namespace clray
