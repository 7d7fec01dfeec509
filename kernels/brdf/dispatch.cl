// SPDX-License-Identifier: Apache-2.0
// Calls the surface model of a row of brdf.def. The program builder defines CLRAY_BRDF_<id> (row numbers) and
// CLRAY_BRDFS(X) with X(id) for each model of the scene, and includes their files before this one; with one model
// alone it defines CLRAY_BRDF_ONLY as its id, and no choice is left to make. Directions below the surface (mu <= 0)
// reflect nothing. What a model gives is described in brdf.h.
#ifndef CLRAY_BRDF_DISPATCH_CL
#define CLRAY_BRDF_DISPATCH_CL

#define CLRAY_BRDF_PASTE(id, function) brdf_##id##_##function
#define CLRAY_BRDF_CALL(id, function) CLRAY_BRDF_PASTE(id, function)

/// f, 1/sr.
CLRAY_FN f64 brdf_eval(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  if (!(a.mu_i > 0.0 && a.mu_o > 0.0)) return 0.0;
#ifdef CLRAY_BRDF_ONLY
  return CLRAY_BRDF_CALL(CLRAY_BRDF_ONLY, eval)(m, tables, a);
#else
  switch (m->model) {
#define CLRAY_BRDF_CASE(id) \
  case CLRAY_BRDF_##id:     \
    return brdf_##id##_eval(m, tables, a);
    CLRAY_BRDFS(CLRAY_BRDF_CASE)
#undef CLRAY_BRDF_CASE
    default:
      return 0.0;
  }
#endif
}

/// Density of brdf_sample, 1/sr.
CLRAY_FN f64 brdf_pdf(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, BrdfAngles a) {
  if (!(a.mu_i > 0.0 && a.mu_o > 0.0)) return 0.0;
#ifdef CLRAY_BRDF_ONLY
  return CLRAY_BRDF_CALL(CLRAY_BRDF_ONLY, pdf)(m, tables, a);
#else
  switch (m->model) {
#define CLRAY_BRDF_CASE(id) \
  case CLRAY_BRDF_##id:     \
    return brdf_##id##_pdf(m, tables, a);
    CLRAY_BRDFS(CLRAY_BRDF_CASE)
#undef CLRAY_BRDF_CASE
    default:
      return 0.0;
  }
#endif
}

/// A direction drawn for wi (local frame, wi.z > 0) from u in (0,1).
CLRAY_FN BrdfSample brdf_sample(const CLRAY_GLOBAL ClrayMaterial* m, const CLRAY_GLOBAL f64* tables, vec3 wi,
                                f64 u_lobe, f64 u1, f64 u2) {
#ifdef CLRAY_BRDF_ONLY
  return CLRAY_BRDF_CALL(CLRAY_BRDF_ONLY, sample)(m, tables, wi, u_lobe, u1, u2);
#else
  BrdfSample none;
  switch (m->model) {
#define CLRAY_BRDF_CASE(id) \
  case CLRAY_BRDF_##id:     \
    return brdf_##id##_sample(m, tables, wi, u_lobe, u1, u2);
    CLRAY_BRDFS(CLRAY_BRDF_CASE)
#undef CLRAY_BRDF_CASE
    default:
      break;
  }
  none.wo = v3(0.0, 0.0, 1.0);
  none.weight = 0.0;
  none.pdf = 0.0;
  none.ok = 0;
  none.delta = 0;
  return none;
#endif
}

#ifndef __OPENCL_VERSION__
/// Directional-hemispherical reflectance at cosine mu, on the host; devices read the table made of it.
CLRAY_FN f64 brdf_reflectance(const ClrayMaterial* m, const f64* tables, f64 mu) {
  switch (m->model) {
#define CLRAY_BRDF_CASE(id) \
  case CLRAY_BRDF_##id:     \
    return brdf_##id##_reflectance(m, tables, mu);
    CLRAY_BRDFS(CLRAY_BRDF_CASE)
#undef CLRAY_BRDF_CASE
    default:
      return 0.0;
  }
}

/// Upper bound of f·mu_o over all normals, for the cosine of half the phase angle. The scale of the sums is made of it,
/// so it is finite and at least 2^-20. Weights above it go into the second accumulator.
CLRAY_FN f64 brdf_bound(const ClrayMaterial* m, const f64* tables, f64 cos_half_phase) {
  const f64 least = 9.5367431640625e-07;
  switch (m->model) {
#define CLRAY_BRDF_CASE(id) \
  case CLRAY_BRDF_##id:     \
    return f64_max(brdf_##id##_bound(m, tables, cos_half_phase), least);
    CLRAY_BRDFS(CLRAY_BRDF_CASE)
#undef CLRAY_BRDF_CASE
    default:
      return least;
  }
}
#endif

#endif
