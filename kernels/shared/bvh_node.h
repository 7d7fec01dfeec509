// SPDX-License-Identifier: Apache-2.0
// A node of the linear BVH, as the host writes it (host/body) and walks read it (kernels/walk). Nothing else knows what
// a child's number means.
#ifndef CLRAY_BVH_NODE_H
#define CLRAY_BVH_NODE_H

#include "shared/portable.h"

/// Four children with fp32 boxes rounded outward, in the box frame (x − box_centre)·box_scale.
typedef struct ClrayNode {
  f32 bounds[6][4];  // low x, high x, low y, high y, low z, high z of the four children
  u32 child[4];      // node_child(), or CLRAY_NO_CHILD
} ClrayNode;
#define CLRAY_NO_CHILD 0xffffffffu
#define CLRAY_LEAF_LARGEST 15u  // primitives

/// A leaf holds the `count` primitives from `index` on; with count 0 it is the inner node `index`.
CLRAY_FN u32 node_child(u32 index, u32 count) { return (index << 4) | count; }
CLRAY_FN u32 child_index(u32 child) { return child >> 4; }
CLRAY_FN u32 child_count(u32 child) { return child & 15u; }

#endif
