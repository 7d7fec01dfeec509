// SPDX-License-Identifier: Apache-2.0
// What the stages pass to each other, and the buffers that they read and write. Options are CLRAY_* macros, made by
// host/pipeline/specialise.cpp; an option that the scene does not need is 0 or absent.
#ifndef CLRAY_STATE_CL
#define CLRAY_STATE_CL

#include "light/light.cl"
#include "shared/buffers.h"

/// Every buffer of a pass.
typedef struct Buffers {
#define CLRAY_BUFFER(type, name) type* name;
  CLRAY_BUFFERS(CLRAY_BUFFER)
#undef CLRAY_BUFFER
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
  u32 flat;   // no ray that leaves the primitive can hit it
  u32 plane;  // number of the shared plane it lies in; 0: none
  u32 lit;    // 0: the black back of a one-sided material
} Surface;

/// A path between its start and its current surface. Lanes share its directions: one of them, drawn evenly, samples all
/// (hero wavelengths, Wilkie et al. 2014). Lane l is worth f_l/((1/L)·sum_m p_m), with f and p the products of f·mu_o
/// and of the densities along the path. Both are kept over the density of the lane that samples.
typedef struct Path {
  f64 length;        // m, from the start plane through the reference point
  f64 share;         // of the beam (or pixel) that the path stands for
  Light throughput;  // share of the light that is still on its way
  u32 hero;          // the lane that samples
  Light product;     // f_l over the density of the hero
  Light density;     // p_l over the density of the hero
  u32 delta;         // the last reflection was ideal: only a cone connects it
  u32 mirrors;       // all were
  u32 known;         // packets found which connections something hides from its first surface
  u32 hidden;        // then a bit of each
} Path;

#define CLRAY_HIDDEN 32u  // connections that Path::hidden has bits for

/// What became of the light that a surface received.
typedef struct Scattering {
  Light before;  // throughput that arrived
  Light gain;    // what roulette won or lost
  vec3 out;      // where it goes on
  f64 roulette;  // the number that decides it
  u32 goes_on;   // 0: all that is left is absorbed
} Scattering;

#ifndef CLRAY_KEPT_ROOM  // as CLRAY_LANE_ROOM
#define CLRAY_KEPT_ROOM CLRAY_KEPT
#endif

// Neighbouring paths add to few bins. In packets what they add waits in rows of a few bins, so that one addition to
// memory, which other work-items may add to, serves many paths. Passes with more rows add each at once.
#define CLRAY_HELD_BINS 16u
#define CLRAY_HELD_ROWS (CLRAY_COUNT_delay * CLRAY_LANES * CLRAY_CONNECTIONS)
#define CLRAY_HOLD 0
#if CLRAY_PACKET
#if CLRAY_HELD_ROWS >= 1 && CLRAY_HELD_ROWS <= 4
#undef CLRAY_HOLD
#define CLRAY_HOLD 1
#endif
#endif

/// What waits to be added to bins of one row: `hits` weights, whose integers have the sum `sum`.
typedef struct HeldBins {
  u32 bin[CLRAY_HELD_BINS], hits[CLRAY_HELD_BINS];
  i64 sum[CLRAY_HELD_BINS];
} HeldBins;

/// Where a work-item adds: its view, its replicate, its pixel (stream = 1 + pixel; 0: a beam), and the sums it keeps.
typedef struct Tally {
  u32 view, replicate, stream;
  u32 started, escaped, killed, capped;
  i64 kept[CLRAY_KEPT_ROOM];
#if CLRAY_HOLD
  HeldBins held[CLRAY_HELD_ROWS];
#endif
} Tally;

#endif
