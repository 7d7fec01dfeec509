// SPDX-License-Identifier: Apache-2.0
// Compiles the portable kernel files of all rows for the host (see portable_tables.hpp).
#include "body/portable_tables.hpp"

#include "clray/error.hpp"
#include "scene/tables.hpp"
#include "shared/elementary.h"

namespace clray {
namespace portable {

// Models stand before what calls them.
// clang-format off
#include "brdf/brdf.h"
#include "generated/brdf_all.inc"
#include "brdf/dispatch.cl"
#include "shape/shape.h"
#include "generated/shape_all.inc"
#include "shape/dispatch.cl"
// clang-format on

}  // namespace portable

double surface_reflectance(const ClrayMaterial& material, const std::vector<double>& tables, double mu) {
  return portable::brdf_reflectance(&material, tables.data(), mu);
}

double surface_bound(const ClrayMaterial& material, const std::vector<double>& tables, double cos_half_phase) {
  return portable::brdf_bound(&material, tables.data(), cos_half_phase);
}

double surface_weight(const ClrayMaterial& material, const std::vector<double>& tables, vec3 n, vec3 wi, vec3 wo) {
  const portable::BrdfAngles angles = portable::brdf_angles(n, wi, wo);
  return portable::brdf_eval(&material, tables.data(), angles) * angles.mu_o;
}

ReflectedMomentum reflected_momentum(const ClrayMaterial& material, const std::vector<double>& tables, double mu) {
  const double reflectance = surface_reflectance(material, tables, mu);
  const TableRow& model = table("brdf")[material.model];
  if (model.delta) return {2.0 * mu * reflectance, -reflectance};  // 2(n·s)n − s
  if (!model.even)
    throw Error(ErrorCode::bug, "no closed form for the momentum of " + model.name, "reflected_momentum");
  return {2.0 / 3.0 * reflectance, 0.0};  // ∫ f·mu·o dω of f = rho/π
}

double shape_support_of(int shape, const double* keys, const double direction[3]) {
  return portable::shape_support(static_cast<u32>(shape), keys, v3(direction[0], direction[1], direction[2]));
}

bool shape_hit_of(int shape, const double* keys, vec3 o, vec3 d, double* t, vec3* normal) {
  u32 part;
  if (!portable::shape_intersect(static_cast<u32>(shape), keys, o, d, HUGE_VAL, t, &part)) return false;
  *normal = portable::shape_surface(static_cast<u32>(shape), keys, o, d, *t, part).normal;
  return true;
}

double shape_area_of(int shape, const double* keys) {
  return portable::shape_area(static_cast<u32>(shape), keys);
}

int shape_traits_of(int shape, const double* keys) {
  return portable::shape_traits(static_cast<u32>(shape), keys);
}

bool shape_flat_part(int shape, const double* keys, std::uint32_t part, FlatPart* flat) {
  portable::ShapeFacet facet{};
  if (!portable::shape_facet(static_cast<u32>(shape), keys, part, &facet)) return false;
  *flat = {static_cast<int>(facet.axis), facet.side, facet.offset, facet.round != 0, facet.a, facet.b};
  return true;
}

std::array<double, 3> shape_point(const double* record, int axis, double along, double u, double v) {
  const double* d = record;
  std::array<double, 3> x, y;
  x[axis] = along * d[CLRAY_SHAPE_SCALE];
  x[(axis + 1) % 3] = u * d[CLRAY_SHAPE_SCALE];
  x[(axis + 2) % 3] = v * d[CLRAY_SHAPE_SCALE];
  for (int k = 0; k < 3; ++k)
    y[k] = std::fma(d[k], x[0], std::fma(d[3 + k], x[1], d[6 + k] * x[2])) + d[CLRAY_SHAPE_ORIGIN + k];
  return y;
}

std::array<std::array<double, 3>, 4> flat_part_corners(const double* record, const FlatPart& flat) {
  std::array<std::array<double, 3>, 4> corners;
  for (int k = 0; k < 4; ++k) {
    const double u = k == 0 || k == 3 ? flat.a : -flat.a, v = k < 2 ? flat.b : -flat.b;
    corners[k] = shape_point(record, flat.axis, flat.offset, flat.side * u, v);
  }
  return corners;
}

}  // namespace clray
