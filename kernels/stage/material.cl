// SPDX-License-Identifier: Apache-2.0
// The surface that a lane sees: its row of the material table, and its directional reflectance.
#ifndef CLRAY_MATERIAL_CL
#define CLRAY_MATERIAL_CL

CLRAY_FN const __global ClrayMaterial* lane_material(const Buffers* g, u32 lane, u32 material) {
  return g->materials + lane * g->pass->materials + material;
}

/// Directional reflectance from the material's table, linear between its nodes (docs/physics.md, section 2).
CLRAY_FN f64 lane_reflectance(const Buffers* g, const __global ClrayMaterial* m, f64 mu) {
  const __global f64* nodes = g->tables + m->reflectance + 1;
  const u32 count = (u32)nodes[-1];
  u32 low = 0u, high = count - 1u;
  while (high - low > 1u) {
    const u32 middle = (low + high) / 2u;
    if (nodes[middle] <= mu)
      low = middle;
    else
      high = middle;
  }
  const __global f64* values = nodes + count;
  const f64 share = f64_min(f64_max((mu - nodes[low]) / (nodes[high] - nodes[low]), 0.0), 1.0);
  return fma(share, values[high] - values[low], values[low]);
}

/// Share of the light that a hit surface sends on, in all directions together; 0 on a black back.
CLRAY_FN f64 surface_reflectance(const Buffers* g, u32 lane, const Surface* surface) {
  return surface->lit ? lane_reflectance(g, lane_material(g, lane, surface->material), surface->mu) : 0.0;
}

#endif
