// SPDX-License-Identifier: Apache-2.0
// Walking the linear BVH, a ray at a time: hands out, nearest first, the leaves whose boxes it may hit before t_max.
// Boxes only cull: they are fp32, rounded outward in the box frame, and the ray is widened by more than its own
// rounding, so no box that the fp64 ray touches is ever missed. Slab test after Kay & Kajiya (1986); widening after Ize
// (2013), "Robust BVH ray traversal".
#ifndef CLRAY_WALK_PLAIN_CL
#define CLRAY_WALK_PLAIN_CL

// lint: box test
typedef struct BvhWalk {
  f32 near_x, near_y, near_z, far_x, far_y, far_z;  // the ray's origin, widened toward each slab
  f32 inv_x, inv_y, inv_z;
  u32 row_x, row_y, row_z;  // rows of ClrayNode::bounds of the near slabs
  f64 scale;
  i32 top;
  u32 stack[CLRAY_STACK];
  f32 stack_t[CLRAY_STACK];
} BvhWalk;

/// 1/d, finite: components below 2^-60 move the ray less over any scene than it was widened by.
static f32 bvh_inverse(f64 d) {
  const f64 smallest = 8.673617379884035e-19;
  if (fabs(d) < smallest) return d < 0.0 ? -1.152921504606847e18f : 1.152921504606847e18f;
  return (f32)(1.0 / d);
}

/// Of a coordinate between `low` and `high`, what reaches a slab first and what leaves it last.
static void bvh_axis(f64 low, f64 high, f64 d, u32 axis, f32* near, f32* far, f32* inv, u32* row) {
  const f32 least = (f32)low, most = (f32)high;
  const f32 below = least - (fabs(least) + 1.0f) * 2.384185791015625e-7f;  // 2^-22
  const f32 above = most + (fabs(most) + 1.0f) * 2.384185791015625e-7f;
  const bool negative = d < 0.0;
  *near = negative ? below : above;
  *far = negative ? above : below;
  *inv = bvh_inverse(d);
  *row = 2u * axis + (negative ? 1u : 0u);
}

/// Starts at `root` with all rays o + t·d (d a unit vector) whose origins have each coordinate between those of `low`
/// and `high`, in a frame whose boxes are (x − centre)·scale.
/// A box that one of the rays touches is opened. With fp32's rounding and this padding each t_near of the ray alone is
/// at most its true value, each t_far at least its own. Rounding keeps order: (x - centre)·scale, its fp32 value and
/// that value with its padding grow with x. So for d > 0 `near` is at least, and `far` at most, what that ray alone
/// would have, and (bound - near)·inv is at most, (bound - far)·inv at least, what it would compute; for d < 0 the
/// roles of `low` and `high` change, and so does the sign of inv.
static void bvh_begin_between(BvhWalk* walk, u32 root, vec3 low, vec3 high, vec3 d, vec3 centre, f64 scale) {
  const vec3 a = v3_scale(scale, v3_sub(low, centre)), b = v3_scale(scale, v3_sub(high, centre));
  bvh_axis(a.x, b.x, d.x, 0u, &walk->near_x, &walk->far_x, &walk->inv_x, &walk->row_x);
  bvh_axis(a.y, b.y, d.y, 1u, &walk->near_y, &walk->far_y, &walk->inv_y, &walk->row_y);
  bvh_axis(a.z, b.z, d.z, 2u, &walk->near_z, &walk->far_z, &walk->inv_z, &walk->row_z);
  walk->scale = scale;
  walk->stack[0] = node_child(root, 0u);
  walk->stack_t[0] = 0.0f;
  walk->top = 1;
}

static void bvh_begin(BvhWalk* walk, u32 root, vec3 o, vec3 d, vec3 centre, f64 scale) {
  bvh_begin_between(walk, root, o, o, d, centre, scale);
}

/// Opens one inner node: pushes the children that may be hit before t_max, the nearest last.
static void bvh_open(BvhWalk* walk, const __global ClrayNode* node, f32 t_max, volatile __global i64* counters) {
  const __global f32* bounds = &node->bounds[0][0];
  const float4 nx = (vload4(walk->row_x, bounds) - walk->near_x) * walk->inv_x;
  const float4 ny = (vload4(walk->row_y, bounds) - walk->near_y) * walk->inv_y;
  const float4 nz = (vload4(walk->row_z, bounds) - walk->near_z) * walk->inv_z;
  const float4 fx = (vload4(walk->row_x ^ 1u, bounds) - walk->far_x) * walk->inv_x;
  const float4 fy = (vload4(walk->row_y ^ 1u, bounds) - walk->far_y) * walk->inv_y;
  const float4 fz = (vload4(walk->row_z ^ 1u, bounds) - walk->far_z) * walk->inv_z;
  const float4 nxy = nx > ny ? nx : ny;
  const float4 nz0 = nz > (float4)(0.0f) ? nz : (float4)(0.0f);
  const float4 t_near = (nxy > nz0 ? nxy : nz0) * 0.99999952316284f;  // 1 - 2^-21
  const float4 fxy = fx < fy ? fx : fy;
  const float4 fzt = fz < (float4)(t_max) ? fz : (float4)(t_max);
  const float4 t_far = (fxy < fzt ? fxy : fzt) * 1.00000047683716f;  // 1 + 2^-21
  const int4 hit = t_near <= t_far;
  f32 t[4];
  i32 hits[4];
  vstore4(t_near, 0, t);
  vstore4(hit, 0, hits);
  const i32 floor_top = walk->top;
  for (i32 k = 0; k < 4; ++k) {
    if (hits[k] == 0) continue;
    if (walk->top >= CLRAY_STACK) {
      count_event(counters, CLRAY_COUNT_STACK);
      return;
    }
    i32 at = walk->top++;
    for (; at > floor_top && walk->stack_t[at - 1] < t[k]; --at) {
      walk->stack[at] = walk->stack[at - 1];
      walk->stack_t[at] = walk->stack_t[at - 1];
    }
    walk->stack[at] = node->child[k];
    walk->stack_t[at] = t[k];
  }
}

/// The next leaf that the ray may hit at t <= t_max: 1 and its range of primitives, or 0 when there is none.
static i32 bvh_next(BvhWalk* walk, const __global ClrayNode* nodes, f64 t_max, u32* first, u32* count,
                    volatile __global i64* counters) {
  const f32 limit = (f32)(t_max * walk->scale) * 1.00000095367432f + 9.5367431640625e-7f;
  while (walk->top > 0) {
    const i32 at = --walk->top;
    if (walk->stack_t[at] > limit) continue;
    const u32 child = walk->stack[at];
    *first = child_index(child);
    *count = child_count(child);
    if (*count != 0u) return 1;
    bvh_open(walk, nodes + *first, limit, counters);
  }
  return 0;
}
// lint: end box test

#endif
