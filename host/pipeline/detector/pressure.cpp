// SPDX-License-Identifier: Apache-2.0
// Radiation pressure on the host: force and torque coefficients, with the shares of each component (docs/physics.md,
// section 4).
#include <cmath>

#include "pipeline/detector/books.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/detector/rooms.hpp"
#include "pipeline/estimate.hpp"
#include "scene/spectrum.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kPushes = 6;  // of a component: force (3), torque (3)

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

VectorEstimate vector_of(const RoomResults& x, std::size_t v, const LaneRecord& record, std::size_t first,
                         std::size_t last, std::uint64_t k) {
  VectorEstimate out;
  for (int axis = 0; axis < 3; ++axis) {
    const Estimate e =
        estimate_total(push(x.plan, x.detector, x.read, v, record, first, last, k + static_cast<std::uint64_t>(axis)),
                       rays_of(x.read, v));
    out.value[axis] = e.value;
    out.standard_error[axis] = e.standard_error;
    out.relative_variance_of_variance[axis] = e.relative_variance_of_variance;
  }
  return out;
}

PressureResult pressure_record(const RoomResults& x, std::size_t v, const LaneRecord& record) {
  const std::size_t components = x.plan.traits.components;
  PressureResult p;
  p.key = x.key(v, record.first);
  p.band = x.band(record.first);
  p.source_W_m2 = source_band_W_m2(x.scene.source, p.band) * x.plan.request.orientations[v].light;
  p.sun = x.plan.request.orientations[v].source;
  p.coefficient_m2 = vector_of(x, v, record, 0, components, 0);
  p.torque_coefficient_m3 = vector_of(x, v, record, 0, components, 3);
  for (std::size_t k = 0; k < components; ++k) {
    p.component_m2.push_back(vector_of(x, v, record, k, k + 1, 0));
    p.component_m3.push_back(vector_of(x, v, record, k, k + 1, 3));
  }
  p.absorbed_m2 = estimate_total(book(x.plan, x.read, v, record, CLRAY_BOOK_ABSORBED), rays_of(x.read, v));
  return p;
}

void add_vector(const VectorEstimate& more, VectorEstimate* total) {
  total->value += more.value;
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
      const VectorEstimate& force = p.coefficient_m2;
      x.note(p.key, force.value != Vec3(0.0) || force.standard_error != Vec3(0.0));
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
      target.components.push_back(push(x.plan, x.detector, x.read, x.view, record, 0, x.plan.traits.components, k));
      const double mean = k < 3 ? estimate_mean(target.components.back()).value : 0.0;
      square += mean * mean;
    }
    torque.scale = std::sqrt(square) * x.geometry.radius;
    targets->push_back(std::move(force));
    targets->push_back(std::move(torque));
  }
}

}  // namespace

const DetectorRoom kPressureRoom{"pressure", nullptr, nullptr, pressure_targets, pressure_results};

}  // namespace clray
