// SPDX-License-Identifier: Apache-2.0
// Radiation pressure on the host: force and torque coefficients, with the shares of each component (docs/physics.md,
// section 4).
#include <cmath>

#include "body/portable_tables.hpp"
#include "pipeline/detector/books.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/detector/rooms.hpp"
#include "pipeline/estimate.hpp"
#include "scene/spectrum.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kPushes = 6;   // of a component: force (3), torque (3)
constexpr std::uint32_t kThermal = 2;  // key
constexpr double kMostPush = 2.0;      // that light hands over of its momentum: with heat five thirds

/// What one unit of light that a face receives does to it: the momentum that it hands over, less that of what is
/// reflected, and of heat that goes along the normal.
vec3 push_of(const SolvedContext& x, std::size_t face, std::size_t lane) {
  const ClrayFace& f = x.solved.beam.faces[face];
  const FaceOrigin& origin = x.solved.beam.origins[face];
  const ClrayMaterial& m = x.plan.materials.of(lane, origin.material);
  const vec3 n = v3_load(f.normal), s = x.solved.beam.toward;
  ReflectedMomentum sent;
  double reflectance = 0.0;
  if (origin.lit) {
    sent = reflected_momentum(m, x.plan.materials.tables, origin.mu);
    reflectance = surface_reflectance(m, x.plan.materials.tables, origin.mu);
  }
  double along_normal = -sent.normal;
  if (x.detector.settings[kThermal] != 0.0) along_normal -= 2.0 / 3.0 * (1.0 - reflectance) * m.emissivity;
  return v3_fma(along_normal, n, v3_scale(-1.0 - sent.source, s));
}

/// Where the visible part of a face has its centre, times its area; from the reference point.
vec3 lever_of(const SolvedContext& x, std::size_t face) {
  const ClrayFace& f = x.solved.beam.faces[face];
  const VisibleFace& v = x.solved.visible[face];
  const BeamFaces& beam = x.solved.beam;
  const double *r = x.plan.constants.reference, *c = x.geometry.centre.data();
  const vec3 corner = v3(f.body[0] + (c[0] - r[0]), f.body[1] + (c[1] - r[1]), f.body[2] + (c[2] - r[2]));
  const vec3 across = v3_fma(v.x_m3, beam.axis_x, v3_fma(v.y_m3, beam.axis_y, v3_scale(-0.5 * v.path_m3, beam.toward)));
  return v3_fma(v.area_m2, corner, across);
}

/// Force and torque of a view, from its visible faces.
void pressure_solved(const SolvedContext& x, Sums* sums) {
  if (!x.solved.from_source) return;
  const SumShape& shape = x.plan.layout.shape;
  const SumBlock& block = x.plan.layout.blocks[x.detector.first_block];
  const double scale = x.plan.constants.unit_scale / x.plan.beams.area_m2[x.solved.view];
  for (std::size_t l = 0; l < shape.lanes; ++l) {
    const std::uint64_t row = block.offset + (x.solved.view * shape.lanes + l) * block.width;
    for (std::size_t f = 0; f < x.solved.beam.faces.size(); ++f) {
      const double area = x.solved.visible[f].area_m2;
      if (area == 0.0) continue;
      const vec3 push = push_of(x, f, l);
      const vec3 torque = v3_cross(v3_scale(x.plan.constants.inv_lever_per_m, lever_of(x, f)), push);
      const double values[kPushes] = {area * push.x, area * push.y, area * push.z, torque.x, torque.y, torque.z};
      const std::uint64_t own = row + kPushes * x.geometry.primitives[x.solved.beam.origins[f].primitive].component;
      for (std::uint64_t k = 0; k < kPushes; ++k) sums->values.add(own + k, std::llrint(values[k] * scale));
    }
  }
}

/// Force (k = 0 … 2, m²) or torque (3 … 5, m³) of components first … last - 1 in a record's light, per replicate.
std::vector<double> push(const PassPlan& plan, const PassDetector& d, const SumReader& read, std::size_t v,
                         const LaneRecord& record, std::size_t first, std::size_t last, std::uint64_t k) {
  return per_replicate_of(plan, record, [&](std::size_t l, std::uint32_t r) {
    double sum = 0.0;
    for (std::size_t part = first; part < last; ++part)
      sum += read.value(d.first_block, v, l, 0, r, part * kPushes + k);
    return sum * (k >= 3 ? plan.scales.lever_m : 1.0);
  });
}

/// What a solved first bounce adds to each of them.
double solved_push(const PassPlan& plan, const PassDetector& d, const SumReader& read, std::size_t v,
                   const LaneRecord& record, std::size_t first, std::size_t last, std::uint64_t k) {
  double sum = 0.0;
  for (std::size_t l = record.first; l < record.end; ++l) {
    for (std::size_t part = first; part < last; ++part)
      sum += plan.request.lanes[l].share * read.solved(d.first_block, v, l, 0, part * kPushes + k);
  }
  return sum * (k >= 3 ? plan.scales.lever_m : 1.0);
}

/// Whether any light pushes these components, found or solved.
bool is_pushed(const RoomResults& x, std::size_t v, const LaneRecord& record, std::size_t first, std::size_t last) {
  for (std::uint64_t k = 0; k < 3; ++k) {
    if (solved_push(x.plan, x.detector, x.read, v, record, first, last, k) != 0.0) return true;
    for (const double one : push(x.plan, x.detector, x.read, v, record, first, last, k)) {
      if (one != 0.0) return true;
    }
  }
  return false;
}

VectorEstimate vector_of(const RoomResults& x, std::size_t v, const LaneRecord& record, std::size_t first,
                         std::size_t last, std::uint64_t k, bool pushed) {
  VectorEstimate out;
  const double lever_m = k >= 3 ? x.plan.scales.lever_m : 1.0;
  // Where rays found nothing, they may have missed what hands over all that light can.
  const double most = pushed ? 0.0 : kMostPush * x.plan.beams.area_m2[v] * lever_m;
  const bool first_exact = x.read.adds_to(x.detector.first_block);
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint64_t number = k + static_cast<std::uint64_t>(axis);
    const double solved = solved_push(x.plan, x.detector, x.read, v, record, first, last, number);
    const Estimate e = estimate_total(push(x.plan, x.detector, x.read, v, record, first, last, number),
                                      rays_of(x.read, v), solved, most);
    if (first_exact) out.exact_part[axis] = solved;
    out.value[axis] = e.value;
    out.standard_error[axis] = e.standard_error;
    out.relative_variance_of_variance[axis] = e.relative_variance_of_variance;
  }
  if (x.plan.request.exact() || first_exact) out.rounding_bound = kMostPush * x.read.area_rounding(v) * lever_m;
  return out;
}

PressureResult pressure_record(const RoomResults& x, std::size_t v, const LaneRecord& record) {
  const std::size_t components = x.plan.traits.components;
  PressureResult p;
  p.key = x.key(v, record.first);
  p.band = x.band(record.first);
  p.source_W_m2 = source_band_W_m2(x.scene.source, p.band) * x.plan.request.orientations[v].light;
  p.sun = x.plan.request.orientations[v].source;
  const bool pushed = is_pushed(x, v, record, 0, components);
  x.note(p.key, pushed);
  p.coefficient_m2 = vector_of(x, v, record, 0, components, 0, pushed);
  p.torque_coefficient_m3 = vector_of(x, v, record, 0, components, 3, pushed);
  for (std::size_t k = 0; k < components; ++k) {
    const bool of_part = is_pushed(x, v, record, k, k + 1);
    p.component_m2.push_back(vector_of(x, v, record, k, k + 1, 0, of_part));
    p.component_m3.push_back(vector_of(x, v, record, k, k + 1, 3, of_part));
  }
  p.absorbed_m2 = estimate_total(book(x.plan, x.read, v, record, CLRAY_BOOK_ABSORBED), rays_of(x.read, v), 0.0,
                                 pushed ? 0.0 : x.plan.beams.area_m2[v]);
  if (x.plan.request.exact()) p.absorbed_m2.rounding_bound = x.read.area_rounding(v);
  return p;
}

void add_vector(const VectorEstimate& more, VectorEstimate* total) {
  total->value += more.value;
  total->exact_part += more.exact_part;
  total->rounding_bound += more.rounding_bound;
  total->standard_error += more.standard_error;
  for (int axis = 0; axis < 3; ++axis) {
    double& doubt = total->relative_variance_of_variance[axis];
    doubt = std::fmax(doubt, more.relative_variance_of_variance[axis]);
  }
}

/// Parts of the light whose surfaces are mirrors come in passes of their own.
void add_pressure(const PressureResult& more, PressureResult* total) {
  add_vector(more.coefficient_m2, &total->coefficient_m2);
  add_vector(more.torque_coefficient_m3, &total->torque_coefficient_m3);
  for (std::size_t k = 0; k < total->component_m2.size(); ++k) {
    add_vector(more.component_m2[k], &total->component_m2[k]);
    add_vector(more.component_m3[k], &total->component_m3[k]);
  }
  total->absorbed_m2 = sum_of_parts(total->absorbed_m2, more.absorbed_m2);
}

void pressure_results(const RoomResults& x) {
  for (std::size_t v = 0; v < x.plan.layout.shape.views; ++v) {
    for (const LaneRecord& record : lane_records(x.plan.request.lanes)) {
      PressureResult p = pressure_record(x, v, record);
      PressureResult* known = x.known(x.out.pressure, p.key, record);
      if (known != nullptr) {
        add_pressure(p, known);
      } else {
        x.out.pressure.push_back(std::move(p));
      }
    }
  }
}

/// |F|, and the torque against |F| at the body's radius.
void pressure_targets(const TargetContext& x, std::vector<Target>* targets) {
  for (const LaneRecord& record : lane_records(x.plan.request.lanes)) {
    Target force, torque;
    double square = 0.0;
    for (std::uint64_t k = 0; k < kPushes; ++k) {
      Target& target = k < 3 ? force : torque;
      const std::size_t components = x.plan.traits.components;
      target.components.push_back(push(x.plan, x.detector, x.read, x.view, record, 0, components, k));
      target.solved.push_back(solved_push(x.plan, x.detector, x.read, x.view, record, 0, components, k));
      const double mean = k < 3 ? estimate_mean(target.components.back()).value + target.solved.back() : 0.0;
      square += mean * mean;
    }
    torque.scale = std::sqrt(square) * x.geometry.radius;
    targets->push_back(std::move(force));
    targets->push_back(std::move(torque));
  }
}

}  // namespace

const DetectorRoom kPressureRoom{"pressure",       nullptr, nullptr,         pressure_targets,
                                 pressure_results, nullptr, pressure_solved, nullptr};

}  // namespace clray
