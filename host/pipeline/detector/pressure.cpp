// SPDX-License-Identifier: Apache-2.0
// Radiation pressure on the host: force and torque coefficients, with the shares of each component (docs/physics.md,
// section 4).
#include <cmath>

#include "pipeline/detector/books.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/detector/rooms.hpp"
#include "pipeline/estimate.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kPushes = 6;  // of a component: force (3), torque (3)

/// Force (k = 0 … 2, m²) or torque (3 … 5, m³) of components first … last - 1, per replicate.
std::vector<double> push(const PassPlan& plan, const PassDetector& d, const SumReader& read, std::size_t v,
                         std::size_t l, std::size_t first, std::size_t last, std::uint64_t k) {
  return per_replicate(plan, [&](std::uint32_t r) {
    double sum = 0.0;
    for (std::size_t part = first; part < last; ++part)
      sum += read.value(d.first_block, v, l, 0, r, part * kPushes + k);
    return sum * (k >= 3 ? plan.scales.lever_m : 1.0);
  });
}

VectorEstimate vector_of(const RoomResults& x, std::size_t v, std::size_t l, std::size_t first, std::size_t last,
                         std::uint64_t k) {
  VectorEstimate out;
  for (int axis = 0; axis < 3; ++axis) {
    const Estimate e =
        estimate_mean(push(x.plan, x.detector, x.read, v, l, first, last, k + static_cast<std::uint64_t>(axis)));
    out.value[axis] = e.value;
    out.standard_error[axis] = e.standard_error;
    out.relative_variance_of_variance[axis] = e.relative_variance_of_variance;
  }
  return out;
}

void pressure_results(const RoomResults& x) {
  const std::size_t components = x.plan.traits.components;
  for (std::size_t v = 0; v < x.plan.layout.shape.views; ++v) {
    for (std::size_t l = 0; l < x.plan.layout.shape.lanes; ++l) {
      PressureResult p;
      p.key = x.key(v, l);
      p.sun = x.plan.request.orientations[v].source;
      p.coefficient_m2 = vector_of(x, v, l, 0, components, 0);
      p.torque_coefficient_m3 = vector_of(x, v, l, 0, components, 3);
      for (std::size_t k = 0; k < components; ++k) {
        p.component_m2.push_back(vector_of(x, v, l, k, k + 1, 0));
        p.component_m3.push_back(vector_of(x, v, l, k, k + 1, 3));
      }
      p.absorbed_m2 = estimate_mean(book(x.plan, x.read, v, l, CLRAY_BOOK_ABSORBED));
      x.out.pressure.push_back(std::move(p));
    }
  }
}

/// |F|, and the torque against |F| at the body's radius.
void pressure_targets(const PassPlan& plan, const PassDetector& d, const SumReader& read, const Geometry& geometry,
                      std::vector<Target>* targets) {
  for (std::size_t v = 0; v < plan.layout.shape.views; ++v) {
    for (std::size_t l = 0; l < plan.layout.shape.lanes; ++l) {
      Target force, torque;
      double square = 0.0;
      for (std::uint64_t k = 0; k < kPushes; ++k) {
        Target& target = k < 3 ? force : torque;
        target.components.push_back(push(plan, d, read, v, l, 0, plan.traits.components, k));
        const double mean = k < 3 ? estimate_mean(target.components.back()).value : 0.0;
        square += mean * mean;
      }
      torque.scale = std::sqrt(square) * geometry.radius;
      targets->push_back(std::move(force));
      targets->push_back(std::move(torque));
    }
  }
}

}  // namespace

const DetectorRoom kPressureRoom{"pressure", nullptr, nullptr, pressure_targets, pressure_results};

}  // namespace clray
