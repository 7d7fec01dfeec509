// SPDX-License-Identifier: Apache-2.0
// Packets: up to 32 rays of one direction that start near each other meet the body together. Which ray hits what has
// the same bits as for a ray alone (stage/intersect.cl): the walk hands out every leaf that one of them touches, and
// the fp64 test of triangles is that of shape/triangle.cl, four rays at a time. Packets of shadow rays ask only whether
// anything is hit.
#ifndef CLRAY_PACKET_CL
#define CLRAY_PACKET_CL

#if CLRAY_PACKET

#define CLRAY_PACKET_RAYS 32u  // a set of them is a bit each of a u32
#define CLRAY_PACKET_WIDE 8u   // rays that the fp32 test takes at once: a packet is filled up to a multiple of it
#define CLRAY_PACKET_FEW 4u    // rays that go alone rather than as a packet are fewer

/// Rays of a packet and what they have hit so far. Coordinates of origins as in triangle_permute().
typedef struct Packet {
  f64 x[CLRAY_PACKET_RAYS], y[CLRAY_PACKET_RAYS], z[CLRAY_PACKET_RAYS];
  f64 t[CLRAY_PACKET_RAYS];
  Ray ray[CLRAY_PACKET_RAYS];
  Hit hit[CLRAY_PACKET_RAYS];
  u32 rays;    // those after it stand where the first does and hit nothing
  u32 filled;  // number of rays with those
  u32 any;     // a ray that has hit something looks for nothing else
  // The rectangle across the rays that they start in, in the frame of shape/triangle.cl: its middle as a point, half
  // its sizes, and a bound of what rounding may move a vertex across.
  vec3 middle;
  f64 half_x, half_y, margin;
  f64 loss, unit;  // of edge functions: a bound of their rounding; what brings them near 1
  f32 loss_here;   // in that unit, rounded up
  f32 px[CLRAY_PACKET_RAYS], py[CLRAY_PACKET_RAYS];  // places in the rectangle, -1 to 1
} Packet;

static double4 products_difference4(double4 a, double4 b, double4 c, double4 d) {
  const double4 w = c * d;
  return fma(a, b, -w) + fma(-c, d, w);
}

/// Tests a primitive against ray k of a packet alone. `as_all`: what it shares with all of them.
static void packet_test_one(const Buffers* g, Packet* p, const LocalRay* as_all, u32 k, u32 index) {
  if (index == p->ray[k].skip_primitive) return;
  LocalRay placed = *as_all;
  placed.o = p->ray[k].o;
  placed.skip_plane = p->ray[k].skip_plane;
#if CLRAY_TRIANGLES
  placed.shear.ox = p->x[k];
  placed.shear.oy = p->y[k];
  placed.shear.oz = p->z[k];
#endif
  test_primitive(g, &placed, index, 0u, &p->hit[k]);
  p->t[k] = p->any && p->hit[k].primitive != 0xffffffffu ? -INFINITY : p->hit[k].t;
}

#if CLRAY_TRIANGLES
/// The rays of a packet (a bit each) that may hit a triangle: all but those that lie beyond one of its edges for
/// certain. In x and y across the rays, from the middle of the packet, vertices a, b, c stand in .s012. The edge
/// function of b and c at (x, y) is (c - (x, y)) × (b - (x, y)) = c × b + x·(c.y - b.y) + y·(b.x - c.x), and so on
/// round; a ray inside has the sign of their sum (which does not depend on x and y) in all three, or zero.
/// Errors: vertices are off by `margin` at most. They, and the places of rays, are no farther from the middle than the
/// body and the rays are large, so an edge function is off by less than `loss`, 8·margin times that. The fp64 test's
/// own vertices are no farther off: a ray beyond an edge by more than `loss` is outside for it, too. In fp32, with
/// places in units of half_x and half_y, the three terms of an edge function are rounded, the places are, and so are
/// the two sums: seven times 2^-24 of the sum of the terms' sizes at most. 2^-20 of it is added.
// lint: box test
static u32 packet_may_hit(const Packet* p, const RayShear* r, const __global f64* data) {
  const u32 ix = r->ix, iy = r->iy, iz = r->iz;
  const double4 z = (double4)(data[iz], data[3u + iz], data[6u + iz], 0.0) - p->middle.z;
  const double4 x = fma((double4)(-r->sx), z, (double4)(data[ix], data[3u + ix], data[6u + ix], 0.0) - p->middle.x);
  const double4 y = fma((double4)(-r->sy), z, (double4)(data[iy], data[3u + iy], data[6u + iy], 0.0) - p->middle.y);
  const double4 x1 = x.s2013, x2 = x.s1203, y1 = y.s2013, y2 = y.s1203;
  const double4 edge = x1 * y2 - y1 * x2;
  const f64 det = edge.s0 + edge.s1 + edge.s2;
  if (fabs(det) <= 4.0 * p->loss) return 0xffffffffu;
  const f64 unit = det < 0.0 ? -p->unit : p->unit;
  const float4 along_x = convert_float4((y1 - y2) * (unit * p->half_x));
  const float4 along_y = convert_float4((x2 - x1) * (unit * p->half_y));
  const float4 rest = convert_float4(edge * unit);
  const float4 start = rest + (fabs(rest) + fabs(along_x) + fabs(along_y)) * 9.5367431640625e-7f + p->loss_here;
  u32 mask = 0u;
  for (u32 k = 0; k < p->filled / CLRAY_PACKET_WIDE; ++k) {
    const float8 px = vload8(k, p->px), py = vload8(k, p->py);
    const float8 u = fma((float8)(along_x.s0), px, fma((float8)(along_y.s0), py, (float8)(start.s0)));
    const float8 v = fma((float8)(along_x.s1), px, fma((float8)(along_y.s1), py, (float8)(start.s1)));
    const float8 w = fma((float8)(along_x.s2), px, fma((float8)(along_y.s2), py, (float8)(start.s2)));
    const float8 uv = u < v ? u : v, least = uv < w ? uv : w;
    const int8 bits = ~(least < (float8)(0.0f)) & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
    const int4 four = bits.lo | bits.hi;
    const int2 two = four.lo | four.hi;
    mask |= (u32)(two.s0 | two.s1) << (CLRAY_PACKET_WIDE * k);
  }
  return mask;
}
// lint: end box test

/// Tests a triangle against all rays of a packet: triangle_intersect() for four at a time, or, where it shares its
/// plane with other faces, ray by ray.
static void packet_triangle(const Buffers* g, Packet* p, const LocalRay* as_all, u32 index) {
  const __global ClrayPrimitive* primitive = g->primitives + index;
  const __global f64* data = primitive_numbers(g, index);
  const RayShear* r = &as_all->shear;
  const u32 mask = packet_may_hit(p, r, data);
  if (mask == 0u) return;
#if CLRAY_PLANES
  if (primitive->planes != CLRAY_NO_PLANES) {
    for (u32 k = 0; k < p->rays; ++k) {
      if ((mask >> k) & 1u) packet_test_one(g, p, as_all, k, index);
    }
    return;
  }
#endif
  const vec3 pa = triangle_permute(v3_load(data), r->iz);
  const vec3 pb = triangle_permute(v3_load(data + 3), r->iz);
  const vec3 pc = triangle_permute(v3_load(data + 6), r->iz);
  const double4 sx = (double4)(-r->sx), sy = (double4)(-r->sy);
  for (u32 q = 0; q < p->filled / 4u; ++q) {
    if (((mask >> (4u * q)) & 15u) == 0u) continue;
    const double4 ox = vload4(q, p->x), oy = vload4(q, p->y), oz = vload4(q, p->z);
    const double4 a_along = pa.z - oz, b_along = pb.z - oz, c_along = pc.z - oz;
    const double4 ax = fma(sx, a_along, pa.x - ox), ay = fma(sy, a_along, pa.y - oy);
    const double4 bx = fma(sx, b_along, pb.x - ox), by = fma(sy, b_along, pb.y - oy);
    const double4 cx = fma(sx, c_along, pc.x - ox), cy = fma(sy, c_along, pc.y - oy);
    const double4 u = products_difference4(cx, by, cy, bx);
    const double4 v = products_difference4(ax, cy, ay, cx);
    const double4 w = products_difference4(bx, ay, by, ax);
    const long4 below = (u < 0.0) | (v < 0.0) | (w < 0.0), above = (u > 0.0) | (v > 0.0) | (w > 0.0);
    const double4 det = u + v + w;
    const long4 in = ~(below & above) & (det != 0.0);
    if ((in.s0 | in.s1 | in.s2 | in.s3) == 0) continue;
    const double4 az = r->sz * a_along, bz = r->sz * b_along, cz = r->sz * c_along;
    const double4 t = fma(u, az, fma(v, bz, w * cz)) / det;
    const long4 ok = in & (t > 0.0) & (t <= vload4(q, p->t));
    if ((ok.s0 | ok.s1 | ok.s2 | ok.s3) == 0) continue;
    f64 ts[4], us[4], vs[4], ws[4];
    i64 oks[4];
    vstore4(t, 0, ts);
    vstore4(u / det, 0, us);
    vstore4(v / det, 0, vs);
    vstore4(w / det, 0, ws);
    vstore4(ok, 0, oks);
    for (u32 k = 0; k < 4u; ++k) {
      if (oks[k] == 0) continue;
      if (index == p->ray[4u * q + k].skip_primitive) continue;
      Hit* hit = &p->hit[4u * q + k];
      if (ts[k] == hit->t && (hit->rank != 0u || primitive->id >= hit->id)) continue;
      hit->t = ts[k];
      hit->primitive = index;
      hit->id = primitive->id;
      hit->part = 0u;
      hit->plane = 0u;
      hit->rank = 0u;
      hit->weights = v3(us[k], vs[k], ws[k]);
      p->t[4u * q + k] = p->any ? -INFINITY : ts[k];
    }
  }
}
#endif

#if CLRAY_TRIANGLES
// lint: box test
/// Finds the rectangle that the rays of a packet start in. Coordinates across the rays come from a few roundings of
/// numbers no larger than the body's and the rays' own: 2^-44 of these is more than all of them.
static void packet_frame(const __global ClrayView* from, const RayShear* r, vec3 low, vec3 high, Packet* p) {
  const f64 size = size_of(v3_load(from->box_centre)) + size_of(low) + size_of(high) + 4.0 / from->box_scale;
  p->margin = size * 5.684341886080802e-14;
  const vec3 middle =
      triangle_permute(v3(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)), r->iz);
  p->middle = middle;
  double4 half_x = (double4)(0.0), half_y = half_x;
  for (u32 q = 0; q < p->filled / 4u; ++q) {
    const double4 z = vload4(q, p->z) - middle.z;
    const double4 x = fabs(fma((double4)(-r->sx), z, vload4(q, p->x) - middle.x));
    const double4 y = fabs(fma((double4)(-r->sy), z, vload4(q, p->y) - middle.y));
    half_x = half_x > x ? half_x : x;
    half_y = half_y > y ? half_y : y;
  }
  p->half_x = f64_max(f64_max(half_x.s0, half_x.s1), f64_max(half_x.s2, half_x.s3)) + p->margin;
  p->half_y = f64_max(f64_max(half_y.s0, half_y.s1), f64_max(half_y.s2, half_y.s3)) + p->margin;
  const vec3 centre = v3_load(from->box_centre);
  p->loss = 8.0 * p->margin * (size_of(v3_sub(low, centre)) + size_of(v3_sub(high, centre)) + 4.0 / from->box_scale);
  p->unit = from->box_scale * from->box_scale;
  p->loss_here = (f32)(p->loss * p->unit) * 1.001f + 1.0e-30f;
  for (u32 q = 0; q < p->filled / 4u; ++q) {
    const double4 z = vload4(q, p->z) - middle.z;
    const double4 x = fma((double4)(-r->sx), z, vload4(q, p->x) - middle.x) / p->half_x;
    const double4 y = fma((double4)(-r->sy), z, vload4(q, p->y) - middle.y) / p->half_y;
    vstore4(convert_float4(x), q, p->px);
    vstore4(convert_float4(y), q, p->py);
  }
}
// lint: end box test

#endif

/// How far along the rays of a packet a point lies beyond the start of the first.
static f64 packet_along(const Packet* p, vec3 o) { return v3_dot(v3_sub(o, p->ray[0].o), p->ray[0].d); }

/// How far across the rays of a packet a point lies from the start of the first: at least that, at most 1.8 times.
static f64 packet_across(const Packet* p, vec3 o) {
  return size_of(v3_fma(-packet_along(p, o), p->ray[0].d, v3_sub(o, p->ray[0].o)));
}

/// A box around the starts of all rays of a packet. Where they look for no nearest hit, all are moved back along their
/// direction to where the first of them starts, so that the box is as narrow as the packet. Rounding moves them by a
/// few roundings of numbers no larger than the body is and is far off: 2^-44 of these is more.
static void packet_box(const __global ClrayView* from, const Packet* p, vec3* low, vec3* high) {
  f64 least = 0.0;
  for (u32 k = 1; p->any && k < p->rays; ++k) least = f64_min(least, packet_along(p, p->ray[k].o));
  for (u32 k = 0; k < p->rays; ++k) {
    vec3 o = p->ray[k].o;
    if (p->any) o = v3_fma(least - packet_along(p, o), p->ray[0].d, o);
    if (k == 0u) *low = *high = o;
    *low = v3(f64_min(low->x, o.x), f64_min(low->y, o.y), f64_min(low->z, o.z));
    *high = v3(f64_max(high->x, o.x), f64_max(high->y, o.y), f64_max(high->z, o.z));
  }
  if (!p->any) return;
  const f64 room = (size_of(*low) + size_of(*high) + 4.0 / from->box_scale) * 5.684341886080802e-14;
  *low = v3(low->x - room, low->y - room, low->z - room);
  *high = v3(high->x + room, high->y + room, high->z + room);
}

/// Puts the rays of a packet side by side, with nothing hit.
static void packet_fill(Packet* p, u32 axis) {
  p->filled = (p->rays + CLRAY_PACKET_WIDE - 1u) / CLRAY_PACKET_WIDE * CLRAY_PACKET_WIDE;
  for (u32 k = p->rays; k < p->filled; ++k) p->ray[k] = p->ray[0];
  for (u32 k = 0; k < p->filled; ++k) {
#if CLRAY_TRIANGLES
    const vec3 placed = triangle_permute(p->ray[k].o, axis);
    p->x[k] = placed.x;
    p->y[k] = placed.y;
    p->z[k] = placed.z;
#endif
    hit_clear(&p->hit[k]);
    p->t[k] = k < p->rays ? INFINITY : -INFINITY;
  }
}

/// Finds what each ray of a packet hits first, or (`any`) whether it hits anything.
static void packet_intersect(const Buffers* g, u32 view, Packet* p) {
  const __global ClrayView* from = g->views + view;
  if (p->rays < CLRAY_PACKET_FEW) {
    for (u32 k = 0; k < p->rays; ++k) intersect(g, &p->ray[k], view, p->any, &p->hit[k]);
    return;
  }
  vec3 low, high;
  packet_box(from, p, &low, &high);
  const LocalRay as_all = local_ray(p->ray[0].o, p->ray[0].d, 0u);
#if CLRAY_TRIANGLES
  packet_fill(p, as_all.shear.iz);
  packet_frame(from, &as_all.shear, low, high, p);
#else
  packet_fill(p, 0u);
#endif
  BvhWalk walk;
  u32 first, count;
  f64 t_max = INFINITY;
  bvh_begin_between(&walk, from->root, low, high, p->ray[0].d, v3_load(from->box_centre), from->box_scale);
  while (bvh_next(&walk, g->nodes, t_max, &first, &count, g->counters)) {
    for (u32 place = first; place < first + count; ++place) {
      const u32 index = leaf_primitive(g, place);
#if CLRAY_TRIANGLES
      if (!CLRAY_ANALYTIC || g->primitives[index].shape == CLRAY_SHAPE_triangle) {
        packet_triangle(g, p, &as_all, index);
        continue;
      }
#endif
      for (u32 k = 0; k < p->rays; ++k) packet_test_one(g, p, &as_all, k, index);
    }
    double4 far = vload4(0, p->t);
    for (u32 q = 1; q < p->filled / 4u; ++q) {
      const double4 t = vload4(q, p->t);
      far = far > t ? far : t;
    }
    t_max = f64_max(f64_max(far.s0, far.s1), f64_max(far.s2, far.s3));
  }
}

#endif

#endif
