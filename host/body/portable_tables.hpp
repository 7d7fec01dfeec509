// SPDX-License-Identifier: Apache-2.0
// The models of kernels/brdf and kernels/shape on the host: the same portable code that devices run, for bounds,
// areas and directional reflectances.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/abi.h"

namespace clray {

/// Directional-hemispherical reflectance at mu (by quadrature where there is no closed form).
double surface_reflectance(const ClrayMaterial& material, const std::vector<double>& tables, double mu);

/// Upper bound of f·mu_o over all normals at cos(phase/2); 1/sr.
double surface_bound(const ClrayMaterial& material, const std::vector<double>& tables, double cos_half_phase);

/// f·mu_o at a surface with unit normal n, of light from wi toward wo; 1/sr.
double surface_weight(const ClrayMaterial& material, const std::vector<double>& tables, vec3 n, vec3 wi, vec3 wo);

/// The mean momentum that a surface's reflected light takes along, per unit of arriving light: `normal` along the
/// surface's normal and `source` along the direction to the source. Of models that are even or delta (brdf.def) alone.
struct ReflectedMomentum {
  double normal = 0.0, source = 0.0;
};
ReflectedMomentum reflected_momentum(const ClrayMaterial& material, const std::vector<double>& tables, double mu);

/// max over the shape of x·direction in its local frame, m. `keys`: the row's values in order.
double shape_support_of(int shape, const double* keys, const double direction[3]);
/// Nearest hit of the local ray o + t·d with t > 0: true, t and the outward unit normal.
bool shape_hit_of(int shape, const double* keys, vec3 o, vec3 d, double* t, vec3* normal);
/// Area of one side, m².
double shape_area_of(int shape, const double* keys);
/// CLRAY_SHAPE_CLOSED | CLRAY_SHAPE_CONVEX | CLRAY_SHAPE_PLANE
int shape_traits_of(int shape, const double* keys);

/// A flat part of a shape in its local frame: see ShapeFacet in kernels/shape/shape.h.
struct FlatPart {
  int axis = 2;
  double side = 1.0, offset = 0.0;
  bool round = false;
  double a = 0.0, b = 0.0;
};
/// Whether `part` of a shape is flat and there, and where.
bool shape_flat_part(int shape, const double* keys, std::uint32_t part, FlatPart* flat);
/// Parts that an analytic shape has at most: a box's faces.
constexpr std::uint32_t kMostShapeParts = 6;
/// A point at `along` on an axis of a shape's local frame, u and v on the two axes after it, in the frame of its part
/// of the body; `record` is the shape's in Geometry::shapes.
std::array<double, 3> shape_point(const double* record, int axis, double along, double u, double v);
/// The corners of a flat part that is a rectangle, counter-clockwise from its front.
std::array<std::array<double, 3>, 4> flat_part_corners(const double* record, const FlatPart& flat);

}  // namespace clray
