// SPDX-License-Identifier: Apache-2.0
// What every surface-reflection model is given and gives. Portable subset (shared/portable.h).
// wi and wo are unit vectors away from the surface, toward the light and toward the viewer, n the normal on
// their side. Isotropic models need only the angles below. All models are called with mu_i > 0 and mu_o > 0.
#ifndef CLRAY_BRDF_H
#define CLRAY_BRDF_H

#include "shared/abi.h"
#include "shared/elementary.h"

typedef struct BrdfAngles {
  f64 mu_i;         // n·wi
  f64 mu_o;         // n·wo
  f64 cos_phase;    // wi·wo
  f64 half_length;  // |wi + wo| = 2 cos(phase/2)
  f64 cos_half;     // n·h, h = (wi + wo)/|wi + wo|
  f64 sin2_half;    // |n × h|², accurate for small angles
} BrdfAngles;

typedef struct BrdfSample {
  vec3 wo;     // local frame: normal = +z
  f64 weight;  // f·mu_o/pdf (for a delta: its reflectance)
  f64 pdf;     // 1/sr of the whole model, not only of the chosen lobe (0 for a delta)
  i32 ok;      // 0: the sampler failed (direction below the surface): the path ends, weight 0
  i32 delta;   // 1: an ideal reflection, invisible to eval and pdf
} BrdfSample;

/// The angles of a pair of directions on a surface with normal n (all unit vectors, any common frame).
CLRAY_FN BrdfAngles brdf_angles(vec3 n, vec3 wi, vec3 wo) {
  BrdfAngles a;
  const vec3 h = v3_add(wi, wo);
  const vec3 nxh = v3_cross(n, h);
  const f64 h2 = v3_dot(h, h);
  a.mu_i = v3_dot(n, wi);
  a.mu_o = v3_dot(n, wo);
  a.cos_phase = v3_dot(wi, wo);
  a.half_length = sqrt(h2);
  a.cos_half = h2 > 0.0 ? (a.mu_i + a.mu_o) / a.half_length : 0.0;
  a.sin2_half = h2 > 0.0 ? v3_dot(nxh, nxh) / h2 : 1.0;
  return a;
}

// A model X is one file brdf/X.cl that defines, for a material m whose p[] holds the row's keys in order:
//   f64 brdf_X_eval(m, tables, a)                     f, 1/sr
//   BrdfSample brdf_X_sample(m, tables, wi, u_lobe, u1, u2)   wi in the local frame; u in (0,1)
//   f64 brdf_X_pdf(m, tables, a)                      of sample, 1/sr
//   f64 brdf_X_reflectance(m, tables, mu)             directional-hemispherical reflectance (host; may integrate)
//   f64 brdf_X_bound(m, tables, cos_half_phase)       upper bound of f·mu_o over all normals at that phase angle
// with `const CLRAY_GLOBAL ClrayMaterial *m, const CLRAY_GLOBAL f64 *tables`.

#endif
