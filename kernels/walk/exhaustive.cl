// SPDX-License-Identifier: Apache-2.0
// Walking the linear BVH without looking at a box: hands out every leaf. Slow, and right whatever the boxes are; other
// walks, and compilers, are checked against it.
#ifndef CLRAY_WALK_EXHAUSTIVE_CL
#define CLRAY_WALK_EXHAUSTIVE_CL

typedef struct BvhWalk {
  i32 top;
  u32 stack[CLRAY_STACK];
} BvhWalk;

static void bvh_begin(BvhWalk* walk, u32 root, vec3 o, vec3 d, vec3 centre, f64 scale) {
  (void)o;
  (void)d;
  (void)centre;
  (void)scale;
  walk->stack[0] = node_child(root, 0u);
  walk->top = 1;
}

static i32 bvh_next(BvhWalk* walk, const __global ClrayNode* nodes, f64 t_max, u32* first, u32* count,
                    volatile __global i64* counters) {
  (void)t_max;
  while (walk->top > 0) {
    const u32 child = walk->stack[--walk->top];
    *first = child_index(child);
    *count = child_count(child);
    if (*count != 0u) return 1;
    for (u32 k = 0; k < 4u; ++k) {
      if (nodes[*first].child[k] == CLRAY_NO_CHILD) continue;
      if (walk->top >= CLRAY_STACK) {
        count_event(counters, CLRAY_COUNT_STACK);
        return 0;
      }
      walk->stack[walk->top++] = nodes[*first].child[k];
    }
  }
  return 0;
}

#endif
