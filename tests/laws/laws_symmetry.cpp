// SPDX-License-Identifier: Apache-2.0
// Symmetries of light as laws: scale, turn, reciprocity, what is split, hidden or a hair apart, pictures against beams.
// Each is tried on one member of a random scene (one observer, variant, band and orientation), under every detector
// whose rays start at the beam, so that few programs are compiled.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "laws/laws.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"
#include "support/scenes.hpp"

namespace clray_test {

using clray::Component;
using clray::Result;
using clray::Scene;
using clray::Vec3;

namespace {

/// One of every row of detector.def on that side, with defaults but for sizes.
std::vector<clray::DetectorSpec> detectors_of(const std::string& side) {
  std::vector<clray::DetectorSpec> all;
  for (const clray::TableRow& row : clray::table("detector")) {
    if (row.inner || !(side == "beam" ? row.beam : row.pixel)) continue;
    clray::DetectorSpec d{row.name, row.name, {}};
    for (const clray::TableKey& key : row.keys) {
      if (key.is_whole && key.low >= 1.0) d.parameters[key.name] = 12.0;
    }
    all.push_back(d);
  }
  return all;
}

/// One member of the scene, alone.
Scene member(const RandomScene& random, const Result& combined, Draw& draw) {
  const Scene& scene = random.scene;
  Pick pick;
  Names names;
  pick.observer = draw.whole(0, static_cast<int>(scene.observers.size()) - 1);
  if (!scene.variants.empty()) pick.variant = draw.whole(0, static_cast<int>(scene.variants.size()) - 1);
  pick.band = draw.whole(0, static_cast<int>(clray::bands_of(scene).size()) - 1);
  if (scene.motion || scene.pass) pick.orientation = 0;
  Scene one = alone(scene, combined, pick, &names);
  if (pick.observer > 0) {  // a hinge would follow another observer now, which changes the scene but no law
    for (Component& c : one.components) {
      if (c.hinge) c.hinge->follow = clray::Hinge::Follow::none;
    }
  }
  one.station.reset();
  one.detectors = detectors_of("beam");
  return one;
}

/// Lengths times 2^k: exact, whatever the shapes.
Trial scaled(const Scene& scene, int k) {
  Trial t;
  t.law = "lengths times a power of two";
  t.first = t.second = scene;
  t.same_bits = true;
  const double factor = std::ldexp(1.0, k);
  for (Component& c : t.second.components) {
    c.transform.scale *= factor;
    c.transform.translate *= factor;
    if (c.hinge) c.hinge->point *= factor;
  }
  t.second.reference_point *= factor;
  t.adjust = [k](const Records& records) {
    Records back = records;
    for (auto& [name, r] : back) {
      const int power = r.kind == "moment" || r.kind == "window" ? 1
                        : r.kind == "torque"                     ? 3
                        : r.kind == "exact"                      ? 0
                                                                 : 2;
      r.value = std::ldexp(r.value, -power * k);
      r.error = std::ldexp(r.error, -power * k);
    }
    return back;
  };
  t.only = [](const std::string&, const Record& r) { return r.kind != "power"; };
  return t;
}

/// The scene turned as a whole; vectors come back turned, and so do bounds of their errors.
Trial turned(const Scene& scene, Draw& draw) {
  Trial t;
  t.law = "the whole scene turned";
  t.first = t.second = scene;
  const Vec3 axis = draw.direction();
  const glm::dquat q = glm::angleAxis(draw.between(0.5, 3.0), axis);
  const auto unit = [](const Vec3& v) { return glm::normalize(v); };
  Scene& s = t.second;
  for (Component& c : s.components) {
    const glm::dquat all = glm::normalize(q * glm::angleAxis(c.transform.angle_rad, c.transform.axis));
    const double sine = std::sqrt(all.x * all.x + all.y * all.y + all.z * all.z);
    if (sine > 0.0) c.transform.axis = unit(Vec3(all.x, all.y, all.z));
    c.transform.angle_rad = 2.0 * std::atan2(sine, all.w);
    c.transform.translate = q * c.transform.translate;
    if (!c.hinge) continue;
    c.hinge->axis = unit(q * c.hinge->axis);
    c.hinge->point = q * c.hinge->point;
  }
  s.reference_point = q * s.reference_point;
  s.source.direction = unit(q * s.source.direction);
  for (clray::Observer& o : s.observers) o.direction = o.monostatic ? s.source.direction : unit(q * o.direction);
  t.adjust = [q](const Records& records) {
    Records back = records;
    const glm::dmat3 m = glm::mat3_cast(glm::conjugate(q));
    for (auto& [name, r] : back) {
      if ((r.kind != "force" && r.kind != "torque") || name.back() != 'x') continue;
      const std::string stem = name.substr(0, name.size() - 1);
      Record* axes[3] = {&r, &back.at(stem + "y"), &back.at(stem + "z")};
      const Vec3 value(axes[0]->value, axes[1]->value, axes[2]->value);
      const Vec3 error(axes[0]->error, axes[1]->error, axes[2]->error);
      for (int i = 0; i < 3; ++i) {
        // How the axes' errors go together is not known: their sum bounds the error across.
        axes[i]->value = m[0][i] * value.x + m[1][i] * value.y + m[2][i] * value.z;
        axes[i]->error = std::fabs(m[0][i]) * error.x + std::fabs(m[1][i]) * error.y + std::fabs(m[2][i]) * error.z;
        axes[i]->kind = "turned " + axes[i]->kind;
      }
    }
    return back;
  };
  return t;
}

/// Light takes every path both ways: A and A(t) stay where source and observer change places. A delta is left out: what
/// comes by way of it is seen within a cone, and lit without one.
Trial swapped(const Scene& scene, Draw& draw) {
  Trial t;
  t.law = "source and observer swapped";
  t.first = scene;
  if (t.first.observers[0].monostatic) t.first.observers[0].direction = draw.direction();
  t.first.observers[0].monostatic = false;
  t.second = t.first;
  std::swap(t.second.source.direction, t.second.observers[0].direction);
  for (Component& c : t.second.components) {
    if (!c.hinge || c.hinge->follow == clray::Hinge::Follow::none) continue;
    c.hinge->follow =
        c.hinge->follow == clray::Hinge::Follow::source ? clray::Hinge::Follow::observer : clray::Hinge::Follow::source;
  }
  t.only = [](const std::string& name, const Record& r) {
    return (r.kind == "total" && name.find("/intensity") != std::string::npos) || r.kind == "moment" || r.kind == "bin";
  };
  return t;
}

bool no_components(const std::string& name, const Record&) {
  return name.find(" on ") == std::string::npos;
}

/// A mesh as two parts of the body.
Trial split(const Scene& scene, Draw& draw) {
  Trial t;
  t.law = "a mesh split into parts";
  t.first = scene;
  Component& whole = t.first.components[1];
  t.first.components.resize(2);
  if (!whole.mesh) {
    whole.shape = "mesh";
    whole.parameters.clear();
    whole.mesh = prism_mesh(draw.whole(3, 6), 0.5, 0.8);
  }
  if (whole.mesh->triangles.size() < 2) whole.mesh = plate_mesh(0.8, 1.1);
  while (whole.materials.size() > whole.mesh->material_slots.size()) whole.materials.pop_back();
  t.second = t.first;
  auto a = std::make_shared<clray::Mesh>(*whole.mesh), b = std::make_shared<clray::Mesh>(*whole.mesh);
  for (auto* part : {a.get(), b.get()}) part->triangles.clear(), part->triangle_slot.clear();
  for (std::size_t k = 0; k < whole.mesh->triangles.size(); ++k) {
    clray::Mesh* part = k == 0 ? a.get() : k == 1 || draw.chance(0.5) ? b.get() : a.get();
    part->triangles.push_back(whole.mesh->triangles[k]);
    part->triangle_slot.push_back(whole.mesh->triangle_slot[k]);
  }
  t.second.components[1].mesh = a;
  t.second.components.push_back(t.second.components[1]);
  t.second.components.back().mesh = b;
  t.second.components.back().name = "rest";
  t.same_bits = !whole.hinge;
  t.only = no_components;
  return t;
}

/// What stands inside a closed box is never seen.
Trial hidden(const Scene& scene, Draw& draw) {
  Trial t;
  t.law = "an object hidden in a box";
  t.first = scene;
  t.first.components.resize(2);
  Component& box = t.first.components[1];
  const Component inner = scene.components[2];
  box = Component();
  box.name = "box";
  box.shape = "box";
  for (const char* key : {"size_x", "size_y", "size_z"}) box.parameters[key] = draw.between(0.6, 1.2);
  box.materials = {static_cast<std::uint32_t>(draw.whole(0, kMaterials - 1))};
  box.transform.translate = draw.place(0.8);
  box.transform.axis = draw.direction();
  box.transform.angle_rad = draw.between(-3.0, 3.0);
  t.second = t.first;
  t.second.components.push_back(inner);
  // Shapes reach less than 2.5 m from their origin before their scale: less than 0.25 m, and the box holds 0.3 m.
  t.second.components.back().transform.scale = 0.1;
  t.second.components.back().transform.translate = box.transform.translate;
  t.second.components.back().hinge.reset();
  t.same_bits = true;
  t.only = no_components;
  return t;
}

/// Sheets in one place, each looking away from the other, against the same sheets a hair apart.
Trial hair(const Scene& scene) {
  Trial t;
  t.law = "coincident sheets against sheets a hair apart";
  t.first = t.second = scene;
  constexpr double kHair = 1e-7;  // m: the light that enters between them is as small a share
  for (const std::size_t c : {std::size_t{1}, std::size_t{2}}) {
    clray::Transform& place = t.second.components[c].transform;
    const glm::dquat q = glm::angleAxis(place.angle_rad, place.axis);
    const double up = c == 2 && scene.components[2].mesh ? -1.0 : 1.0;  // the mesh behind is wound the other way
    place.translate += q * Vec3(0, 0, up * kHair);
  }
  // The hair itself moves light and surfaces by up to 1e-6 of the body's size, where all rays agree to the last bit.
  t.adjust = [](const Records& records) {
    Records moved = records;
    for (auto& [name, r] : moved) r.error = std::hypot(r.error, 1e-6 * r.scale);
    return moved;
  };
  return t;
}

/// What a picture's pixels send is what the observer receives. Not so under mirrors: what they show is in the picture
/// as it is, in the beam's total through the cone.
Trial pictured(const Scene& scene) {
  Trial t;
  t.law = "a picture's sum against the beam's total";
  t.first = t.second = scene;
  t.second.detectors = detectors_of("pixel");
  t.adjust = [](const Records& records) {
    Records renamed;
    for (const auto& [name, r] : records) {
      if (r.kind == "picture") renamed["spectrometer" + name.substr(name.find('/'))] = r;
    }
    return renamed;
  };
  return t;
}

}  // namespace

std::vector<Trial> symmetry_trials(const RandomScene& random, const Result& combined, Draw& draw) {
  const Scene scene = member(random, combined, draw);
  std::vector<Trial> trials;
  trials.push_back(scaled(scene, draw.chance(0.5) ? draw.whole(1, 20) : -draw.whole(1, 20)));
  // Sheets that a turn of one and of the other rounds differently are in one place no more.
  if (!random.coincident) trials.push_back(turned(scene, draw));
  if (!has_delta(scene)) trials.push_back(swapped(scene, draw));
  trials.push_back(split(scene, draw));
  trials.push_back(hidden(scene, draw));
  if (random.coincident) trials.push_back(hair(scene));
  if (!has_delta(scene)) trials.push_back(pictured(scene));
  return trials;
}

}  // namespace clray_test
