// SPDX-License-Identifier: Apache-2.0
// Random surfaces, meshes and components. See generator.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "body/portable_tables.hpp"
#include "laws/generator.hpp"
#include "scene/file/material.hpp"
#include "scene/scene_parts.hpp"
#include "scene/tables.hpp"
#include "shape/shape.h"
#include "support/scenes.hpp"

namespace clray_test {

using clray::Component;
using clray::Material;
using clray::Mesh;
using clray::Scene;
using clray::TableKey;
using clray::TableRow;
using clray::Vec3;

void draw_components(Draw& draw, RandomScene* out);

namespace {

/// Constant within each band, so that a band's mean is one of these values, whatever the light; nothing in some.
clray::Spectrum draw_spectrum(Draw& draw, const TableKey& key, const std::vector<clray::Band>& bands) {
  std::vector<clray::Band> sorted(bands);
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.low_nm < b.low_nm; });
  clray::Spectrum s;
  for (const clray::Band& band : sorted) {
    const double value = key.low == 0.0 && key.low_included && draw.chance(0.3) ? 0.0 : draw.key(key);
    s.wavelength_nm.push_back(band.low_nm);
    s.value.push_back(value);
    if (band.high_nm <= band.low_nm) continue;
    s.wavelength_nm.push_back(band.high_nm);
    s.value.push_back(value);
  }
  return s;
}

/// A table that is as reciprocal as a BRDF must be, and reflects less than all: f < 1/π.
std::shared_ptr<const clray::BrdfTable> draw_table(Draw& draw) {
  auto t = std::make_shared<clray::BrdfTable>();
  t->theta_i_rad = {0.0, 0.6, 0.7, kPi / 2.0};
  t->theta_o_rad = t->theta_i_rad;
  t->phi_rad = {0.0, 2.0, kPi};
  const std::size_t n = t->theta_i_rad.size(), m = t->phi_rad.size();
  t->value.assign(n * n * m, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t o = i; o < n; ++o) {
      for (std::size_t p = 0; p < m; ++p)
        t->value[(i * n + o) * m + p] = t->value[(o * n + i) * m + p] = draw.between(0.0, 0.3);
    }
  }
  return t;
}

bool is_plane(const TableRow& row, const std::map<std::string, double>& parameters) {
  const std::vector<double> values = clray::row_values(row, parameters);
  const int index = clray::table_index("shape", row.name);
  return (clray::shape_traits_of(index, values.data()) & CLRAY_SHAPE_PLANE) != 0;
}

std::map<std::string, double> draw_shape_keys(Draw& draw, const TableRow& row) {
  Component c;
  c.shape = row.name;
  do {
    c.parameters.clear();
    for (const TableKey& key : row.keys) {
      if (draw.chance(0.8)) c.parameters[key.name] = draw.key(key);
    }
  } while (!clray::shape_fault(c).empty());
  return c.parameters;
}

std::uint32_t draw_material_index(Draw& draw) {
  return static_cast<std::uint32_t>(draw.whole(0, kMaterials - 1));
}

void set_mesh(Draw& draw, std::shared_ptr<const Mesh> mesh, Component* c) {
  c->shape = "mesh";
  c->parameters.clear();
  c->mesh = std::move(mesh);
  c->materials.clear();
  for (std::size_t s = 0; s < c->mesh->material_slots.size(); ++s) c->materials.push_back(draw_material_index(draw));
}

Component draw_component(Draw& draw, int number, bool flat) {
  std::vector<TableRow> rows;
  for (const TableRow& row : clray::table("shape")) {
    if (row.flat || !flat) rows.push_back(row);
  }
  Component c;
  c.name = fmt::format("c{}", number);
  const TableRow& row = draw.of(rows);
  // Meshes as often as all shapes together.
  if (row.file || draw.chance(0.5)) {
    set_mesh(draw, draw_mesh(draw), &c);
  } else {
    c.shape = row.name;
    c.parameters = draw_shape_keys(draw, row);
    c.materials = {draw_material_index(draw)};
  }
  c.transform.translate = draw.place(0.8);
  c.transform.axis = draw.direction();
  c.transform.angle_rad = draw.between(-kPi, kPi);
  c.transform.scale = draw.between(0.5, 1.5);
  if (draw.chance(0.2)) {
    clray::Hinge h;
    h.axis = draw.direction();
    h.point = draw.place(0.5);
    h.angle_rad = draw.between(-3.0, 3.0);
    const int follow = draw.whole(0, 2);
    h.follow = follow == 0   ? clray::Hinge::Follow::none
               : follow == 1 ? clray::Hinge::Follow::source
                             : clray::Hinge::Follow::observer;
    c.hinge = h;
  }
  return c;
}

/// Makes `back` the sheet behind `front`: in one place with it, looking the other way.
void put_back_to_back(Draw& draw, Component* front, Component* back) {
  front->hinge.reset();
  std::vector<std::pair<const TableRow*, std::map<std::string, double>>> planes;
  for (const TableRow& row : clray::table("shape")) {
    if (row.file) continue;
    const auto keys = draw_shape_keys(draw, row);
    if (is_plane(row, keys)) planes.emplace_back(&row, keys);
  }
  const std::string name = back->name;
  if (draw.chance(0.5)) {
    set_mesh(draw, plate_mesh(draw.between(0.5, 1.5), draw.between(0.5, 1.5)), front);
    *back = *front;
    back->mesh = reversed(*front->mesh);
  } else {
    const auto& plane = draw.of(planes);
    front->shape = plane.first->name;
    front->mesh.reset();
    front->parameters = plane.second;
    front->materials = {draw_material_index(draw)};
    // Half a turn about x of a sheet that lies in z = const: the same plane exactly.
    front->transform.axis = {1, 0, 0};
    front->transform.angle_rad = 0.0;
    *back = *front;
    back->transform.angle_rad = kPi;
  }
  back->name = name;
  for (std::uint32_t& m : back->materials) m = draw_material_index(draw);
}

}  // namespace

Material draw_material(Draw& draw, const std::string& name, const std::vector<clray::Band>& bands) {
  const TableRow& row = draw.of(clray::table("brdf"));
  Material m;
  m.name = name;
  m.model = row.name;
  for (const TableKey& key : row.keys) {
    if (draw.chance(0.4) && !key.is_switch && bands.size() > 1)
      m.spectra[key.name] = draw_spectrum(draw, key, bands);
    else if (draw.chance(0.8))
      m.parameters[key.name] = draw.key(key);
  }
  m.two_sided = !draw.chance(0.3);
  if (draw.chance(0.3)) m.infrared_reflectance = draw.share();
  if (row.file) m.table = draw_table(draw);
  return m;
}

bool is_delta(const Material& material) {
  return clray::table_row("brdf", material.model).delta;
}

bool has_delta(const Scene& scene) {
  bool any = false;
  for (const Material& m : scene.materials) any = any || is_delta(m);
  for (const clray::Variant& v : scene.variants) {
    for (const Material& m : v.materials) any = any || is_delta(m);
  }
  return any;
}

std::shared_ptr<const Mesh> draw_mesh(Draw& draw) {
  MeshPtr mesh;
  switch (draw.whole(0, 6)) {
    case 0:
      mesh = plate_mesh(draw.between(0.5, 1.5), draw.between(0.5, 1.5));
      break;
    case 1:
      mesh = box_mesh(draw.between(0.3, 1.2), draw.between(0.3, 1.2), draw.between(0.3, 1.2));
      break;
    case 2:
      mesh = prism_mesh(draw.whole(3, 7), draw.between(0.3, 0.8), draw.between(0.3, 1.2));
      break;
    case 3:
      mesh = sphere_mesh(draw.whole(5, 12), draw.whole(3, 8), draw.between(0.3, 0.8));
      break;
    case 4:
      mesh = bowl_mesh(draw.whole(5, 12), draw.whole(3, 6), draw.between(0.4, 0.9), kPi / 2.0, kPi);
      break;
    case 5:
      mesh = cone_mesh(draw.whole(3, 9), draw.between(0.3, 0.8), draw.between(0.3, 1.2));
      break;
    default: {  // triangles anywhere, through each other too
      std::vector<MeshPtr> parts;
      for (int k = draw.whole(1, 4); k > 0; --k) {
        auto one = std::make_shared<Mesh>(*plate_mesh(1.0, 1.0));
        one->triangles = {{0, 1, 2}};
        for (Vec3& v : one->vertices) v = draw.place(0.7);
        parts.push_back(one);
      }
      mesh = merged(parts);
    }
  }
  auto own = std::make_shared<Mesh>(*mesh);
  if (draw.chance(0.3)) {
    own->material_slots = {"first", "second"};
    for (auto& slot : own->triangle_slot) slot = draw.chance(0.5) ? 1u : 0u;
  }
  return own;
}

std::shared_ptr<const Mesh> reversed(const Mesh& mesh) {
  auto other = std::make_shared<Mesh>(mesh);
  for (auto& t : other->triangles) std::swap(t[1], t[2]);
  return other;
}

void draw_components(Draw& draw, RandomScene* out) {
  Scene& scene = out->scene;
  for (int c = 0; c < kComponents; ++c) scene.components.push_back(draw_component(draw, c, out->flat));
  out->coincident = draw.chance(0.3);
  if (out->coincident) put_back_to_back(draw, &scene.components[1], &scene.components[2]);
}

}  // namespace clray_test
