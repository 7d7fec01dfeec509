// SPDX-License-Identifier: Apache-2.0
// Walking the linear BVH as in walk/plain.cl. Work-items that run side by side on a GPU are given points that lie side
// by side in the beam (trace.cl, math/sobol_place.cl), so that they open the same boxes.
#ifndef CLRAY_WALK_PLACED_CL
#define CLRAY_WALK_PLACED_CL

#include "walk/plain.cl"

#endif
