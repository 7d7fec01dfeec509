// SPDX-License-Identifier: Apache-2.0
// What the four stages hand to each other, and the buffers they read and write. Options (see host/pipeline/plan.cpp)
// are CLRAY_* macros; each is 0 or absent for what the scene does not need.
#ifndef CLRAY_STATE_CL
#define CLRAY_STATE_CL

/// Every buffer of a pass.
typedef struct Buffers {
  const __global ClrayPass *pass;
  const __global ClrayView *views;
  const __global ClrayConnection *connections;  // [view][connection]
  const __global ClrayNode *nodes;
  const __global ClrayPrimitive *primitives;
  const __global f64 *shapes;
  const __global ClrayInstance *instances;
  const __global ClrayMaterial *materials;      // [lane][material]
  const __global f64 *tables;
  const __global u32 *directions;               // Sobol, bits reversed
  const __global ClrayDelay *delays;            // [detector][connection]
  const __global ClrayStratum *strata;          // of the views' beams
  volatile __global i64 *sums;
  volatile __global i64 *wide;
  volatile __global u32 *hits;
  volatile __global i64 *counters;
} Buffers;

typedef struct Ray {
  vec3 o, d;
  u32 skip_primitive, skip_instance;  // a plane primitive that the ray leaves, and so cannot hit
  u32 skip_plane;                     // the shared plane that it leaves (0: none): none of its faces can be hit
} Ray;

/// The nearest hit of a ray.
typedef struct Hit {
  f64 t;
  u32 primitive, instance;
  u32 id;
  u32 part;      // of an analytic shape
  u32 plane;     // number of the shared plane it lies in; 0: none
  u32 rank;      // among faces in one plane: 2 its front is hit, 1 a lit back, 0 a black back
  vec3 weights;  // barycentric, of a triangle
} Hit;

/// A hit with what shading needs; body frame. The normal is on the side that was hit.
typedef struct Surface {
  vec3 point;
  vec3 normal;
  f64 error;     // m, bound of the point's distance from the true surface
  vec3 toward;   // back along the ray that came
  f64 mu;        // normal·toward
  u32 material;  // column of the material table
  u32 component;
  u32 primitive, instance;
  u32 flat;      // no ray that leaves the primitive can hit it
  u32 plane;     // number of the shared plane it lies in; 0: none
  u32 lit;       // 0: the black back of a one-sided material
} Surface;

/// A path between its start and its current surface. Lanes share its directions: one of them, drawn evenly, samples all
/// (hero wavelengths, Wilkie et al. 2014). Lane l is worth f_l/((1/L)·sum_m p_m), with f and p the products of f·mu_o and
/// of the densities along the path. Both are kept over the density of the lane that samples.
typedef struct Path {
  f64 length;                   // m, from the start plane through the reference point
  f64 share;                    // of the beam (or pixel) that the path stands for
  f64 throughput[CLRAY_LANES];  // share of the light that is still on its way
#if CLRAY_SCATTER && CLRAY_LANES > 1
  u32 hero;                     // the lane that samples
  f64 product[CLRAY_LANES];     // f_l over the density of the hero
  f64 density[CLRAY_LANES];     // p_l over the density of the hero
#endif
  u32 delta;                    // the last reflection was ideal: only a cone connects it
} Path;

/// Where a work-item adds: the slot of (view, lane 0, connection 0) and its replicate, and its own sums.
typedef struct Tally {
  u32 view, replicate, stream;
#if CLRAY_BEAM
  i64 totals[CLRAY_LANES * CLRAY_CONNECTIONS * 3];  // w, w·tau, w·tau²
  u32 largest[CLRAY_LANES * CLRAY_CONNECTIONS];     // bits of the largest weight, fp32 rounded up
#endif
#if CLRAY_PIXELS
  i64 totals[CLRAY_LANES];
  u32 covered;
#endif
#if CLRAY_ENERGY
  i64 books[CLRAY_LANES * CLRAY_BOOKS];
#endif
#if CLRAY_PRESSURE && CLRAY_COMPONENTS * CLRAY_LANES <= 4
#define CLRAY_PRESSURE_PRIVATE 1
  i64 pressure[CLRAY_LANES * CLRAY_COMPONENTS * 6];
#endif
  u32 started, escaped, killed, capped;
} Tally;

#endif
