// SPDX-License-Identifier: Apache-2.0
// Stage 2, intersect: the nearest hit of a ray, or whether anything is in its way. fp32 boxes cull, fp64 decides. Among
// faces at equal distance the one whose lit side looks at the ray wins, then the smaller canonical id. With hinged
// parts the top level of the BVH holds instances, each with a tree of its own in its own frame; motions are rigid, so
// distances are common to all frames.
#ifndef CLRAY_INTERSECT_CL
#define CLRAY_INTERSECT_CL

/// The ray in the frame of an instance (or as it is).
typedef struct LocalRay {
  vec3 o, d;
  u32 skip_plane;
#if CLRAY_TRIANGLES
  RayShear shear;
#endif
} LocalRay;

static LocalRay local_ray(vec3 o, vec3 d, u32 skip_plane) {
  LocalRay r;
  r.o = o;
  r.d = d;
  r.skip_plane = skip_plane;
#if CLRAY_TRIANGLES
  r.shear = triangle_shear(o, d);
#endif
  return r;
}

static vec3 rotate(const __global f64* m, vec3 a) {
  return v3(fma(m[0], a.x, fma(m[1], a.y, m[2] * a.z)), fma(m[3], a.x, fma(m[4], a.y, m[5] * a.z)),
            fma(m[6], a.x, fma(m[7], a.y, m[8] * a.z)));
}

static vec3 rotate_back(const __global f64* m, vec3 a) {
  return v3(fma(m[0], a.x, fma(m[3], a.y, m[6] * a.z)), fma(m[1], a.x, fma(m[4], a.y, m[7] * a.z)),
            fma(m[2], a.x, fma(m[5], a.y, m[8] * a.z)));
}

CLRAY_FN vec3 to_instance(const __global ClrayInstance* instance, vec3 point) {
  return v3_add(rotate(instance->rotation, point), v3_load(instance->translation));
}

CLRAY_FN vec3 shape_to_local(const __global f64* data, vec3 point) {
  const f64 scale = data[CLRAY_SHAPE_SCALE];
  const vec3 moved = rotate(data, v3_sub(point, v3_load(data + CLRAY_SHAPE_ORIGIN)));
  return v3(moved.x / scale, moved.y / scale, moved.z / scale);
}

/// Whether a material's back reflects; lanes that differ in it are never in one pass.
CLRAY_FN u32 two_sided(const Buffers* g, u32 material) {
  return !CLRAY_ONE_SIDED || (g->materials[material].flags & CLRAY_MATERIAL_TWO_SIDED) != 0u;
}

/// Moves a hit of a face that shares its plane to where the ray meets the plane. Returns 0 if the ray leaves that
/// plane.
CLRAY_FN i32 meet_plane(const Buffers* g, const LocalRay* ray, const __global ClrayPrimitive* primitive, u32 part,
                        f64* t, u32* plane, u32* rank) {
  const __global f64* p = g->shapes + primitive->planes + CLRAY_PLANE_SIZE * part;
  *plane = (u32)p[CLRAY_PLANE_NUMBER];
  if (*plane == 0u) return 1;
  if (*plane == ray->skip_plane) return 0;
  const vec3 normal = v3_load(p);
  const f64 along = v3_dot(normal, ray->d);
  *t = (p[CLRAY_PLANE_OFFSET] - v3_dot(normal, ray->o)) / along;
  *rank = along * p[CLRAY_PLANE_FACING] < 0.0 ? 2u : 1u;
  if (*rank == 1u && !two_sided(g, primitive->material)) *rank = 0u;
  return *t > 0.0;
}

/// The numbers of a primitive. Where all are triangles, theirs follow one another: no record need be read for their
/// place.
CLRAY_FN const __global f64* primitive_numbers(const Buffers* g, u32 index) {
  return g->shapes + (CLRAY_ANALYTIC ? g->primitives[index].data : 9u * index);
}

/// Tests one primitive. A nearer hit replaces *hit, and so does one at equal distance that has precedence.
CLRAY_WAY void test_primitive(const Buffers* g, const LocalRay* ray, u32 index, u32 instance, Hit* hit) {
  const __global ClrayPrimitive* primitive = g->primitives + index;
  const __global f64* data = primitive_numbers(g, index);
  f64 t, t_max = hit->t;
  u32 part = 0u, plane = 0u, rank = 0u;
  vec3 weights = v3(0.0, 0.0, 0.0);
  i32 found;
  // The t of the plane decides; that of the face may be rounded otherwise.
  if (CLRAY_PLANES && primitive->planes != CLRAY_NO_PLANES) t_max = INFINITY;
#if CLRAY_ANALYTIC
#if CLRAY_TRIANGLES
  if (primitive->shape == CLRAY_SHAPE_triangle) {
    found = triangle_intersect(data, &ray->shear, t_max, &t, &weights);
  } else
#endif
  {
    const f64 scale = data[CLRAY_SHAPE_SCALE];
    found = shape_intersect(primitive->shape, data + CLRAY_SHAPE_KEYS, shape_to_local(data, ray->o),
                            rotate(data, ray->d), t_max / scale, &t, &part);
    if (found) t *= scale;
  }
#else
  found = triangle_intersect(data, &ray->shear, t_max, &t, &weights);
#endif
  if (CLRAY_PLANES && found && primitive->planes != CLRAY_NO_PLANES)
    found = meet_plane(g, ray, primitive, part, &t, &plane, &rank);
  if (!found || t > hit->t) return;
  if (t == hit->t && (rank != hit->rank ? rank < hit->rank : primitive->id >= hit->id)) return;
  hit->t = t;
  hit->primitive = index;
  hit->instance = instance;
  hit->id = primitive->id;
  hit->part = part;
  hit->plane = plane;
  hit->rank = rank;
  hit->weights = weights;
}

/// The primitive at a place of a leaf. One that is cut into pieces stands in several.
CLRAY_FN u32 leaf_primitive(const Buffers* g, u32 place) { return CLRAY_PIECES ? g->leaves[place] : place; }

/// Walks one tree; with `any` it stops at the first hit of all.
CLRAY_WAY void intersect_tree(const Buffers* g, const Ray* ray, const LocalRay* placed, vec3 centre, f64 scale,
                              u32 root, u32 instance, u32 any, Hit* hit) {
  BvhWalk walk;
  u32 first, count;
  bvh_begin(&walk, root, placed->o, placed->d, centre, scale);
  while (bvh_next(&walk, g->nodes, hit->t, &first, &count, g->counters)) {
    for (u32 k = first; k < first + count; ++k) {
      const u32 index = leaf_primitive(g, k);
      if (index == ray->skip_primitive && instance == ray->skip_instance) continue;
      test_primitive(g, placed, index, instance, hit);
    }
    if (any && hit->primitive != 0xffffffffu) return;
  }
}

/// No hit so far.
static void hit_clear(Hit* hit) {
  hit->t = INFINITY;
  hit->primitive = 0xffffffffu;
  hit->id = 0xffffffffu;
  hit->instance = 0u;
  hit->part = 0u;
  hit->plane = 0u;
  hit->rank = 0u;
  hit->weights = v3(0.0, 0.0, 0.0);
}

/// The nearest hit (or, with `any`, some hit): 1, or 0 when the ray escapes.
static i32 intersect(const Buffers* g, const Ray* ray, u32 view, u32 any, Hit* hit) {
  const __global ClrayView* from = g->views + view;
  const vec3 centre = v3_load(from->box_centre);
  hit_clear(hit);
  if (!CLRAY_INSTANCED) {
    const LocalRay placed = local_ray(ray->o, ray->d, ray->skip_plane);
    intersect_tree(g, ray, &placed, centre, from->box_scale, from->root, 0u, any, hit);
    return hit->primitive != 0xffffffffu;
  }
  BvhWalk walk;
  u32 first, count;
  bvh_begin(&walk, from->root, ray->o, ray->d, centre, from->box_scale);
  while (bvh_next(&walk, g->nodes, hit->t, &first, &count, g->counters)) {
    for (u32 k = first; k < first + count; ++k) {
      const __global ClrayInstance* instance = g->instances + k;
      const LocalRay placed = instance->moved ? local_ray(to_instance(instance, ray->o),
                                                          rotate(instance->rotation, ray->d), ray->skip_plane)
                                              : local_ray(ray->o, ray->d, ray->skip_plane);
      intersect_tree(g, ray, &placed, v3_load(instance->box_centre), instance->box_scale, instance->root, k, any, hit);
      if (any && hit->primitive != 0xffffffffu) return 1;
    }
  }
  return hit->primitive != 0xffffffffu;
}

static f64 size_of(vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }

/// Point, normal and material of a hit.
static Surface hit_surface(const Buffers* g, const Ray* ray, const Hit* hit) {
  const __global ClrayPrimitive* primitive = g->primitives + hit->primitive;
  const __global f64* data = primitive_numbers(g, hit->primitive);
  ShapeSurface s;
#if CLRAY_ANALYTIC
#if CLRAY_TRIANGLES
  if (primitive->shape == CLRAY_SHAPE_triangle) {
    s = triangle_surface(data, hit->weights);
  } else
#endif
  {
    vec3 o = ray->o, d = ray->d;
    const __global ClrayInstance* instance = g->instances + hit->instance;
    if (CLRAY_INSTANCED && instance->moved) {
      o = to_instance(instance, o);
      d = rotate(instance->rotation, d);
    }
    const f64 scale = data[CLRAY_SHAPE_SCALE];
    const vec3 origin = v3_load(data + CLRAY_SHAPE_ORIGIN);
    s = shape_surface(primitive->shape, data + CLRAY_SHAPE_KEYS, shape_to_local(data, o), rotate(data, d),
                      hit->t / scale, hit->part);
    s.point = v3_add(rotate_back(data, v3_scale(scale, s.point)), origin);
    s.normal = rotate_back(data, s.normal);
    // Carrying the point out of the local frame rounds it again.
    s.error = fma(scale, s.error, 8.0e-16 * (size_of(s.point) + size_of(origin)));
  }
#else
  s = triangle_surface(data, hit->weights);
#endif
  if (CLRAY_INSTANCED && g->instances[hit->instance].moved) {
    const __global ClrayInstance* instance = g->instances + hit->instance;
    const vec3 moved = v3_load(instance->translation);
    s.point = rotate_back(instance->rotation, v3_sub(s.point, moved));
    s.normal = rotate_back(instance->rotation, s.normal);
    s.error = fma(8.0e-16, size_of(s.point) + size_of(moved), s.error);
  }
  Surface surface;
  surface.point = s.point;
  surface.normal = s.normal;
  surface.error = s.error;
  surface.toward = v3_neg(ray->d);
  surface.mu = v3_dot(surface.normal, surface.toward);
  surface.material = primitive->material;
  surface.component = primitive->component;
  surface.primitive = hit->primitive;
  surface.instance = hit->instance;
  surface.flat = primitive->flags & CLRAY_PRIMITIVE_PLANE;
  surface.plane = hit->plane;
  surface.lit = 1u;
  if (surface.mu < 0.0) {
    surface.normal = v3_neg(surface.normal);
    surface.mu = -surface.mu;
    surface.lit = two_sided(g, primitive->material);
  }
  return surface;
}

/// The stage: 1 and what the ray hits first, or 0.
static i32 stage_intersect(const Buffers* g, const Ray* ray, u32 view, Hit* hit) {
  return intersect(g, ray, view, 0u, hit);
}

/// The surface that a ray has hit.
static Surface stage_surface(const Buffers* g, const Ray* ray, const Hit* hit) {
  Surface surface = hit_surface(g, ray, hit);
  if (!(surface.mu >= 0.0 && surface.mu <= 2.0)) {
    count_event(g->counters, CLRAY_COUNT_LOST);
    surface.lit = 0u;
    surface.mu = 0.0;
  }
  return surface;
}

/// A ray that leaves a surface toward d, started off the surface by more than the point's error.
static Ray ray_from(const Surface* surface, vec3 d) {
  Ray ray;
  ray.o = v3_fma(surface->error, surface->normal, surface->point);
  ray.d = d;
  ray.skip_primitive = surface->flat ? surface->primitive : 0xffffffffu;
  ray.skip_instance = surface->instance;
  ray.skip_plane = surface->plane;
  return ray;
}

/// Whether anything lies between a surface and infinity in direction d.
CLRAY_FN i32 shadowed(const Buffers* g, const Surface* surface, u32 view, vec3 d) {
  const Ray ray = ray_from(surface, d);
  Hit hit;
  return intersect(g, &ray, view, 1u, &hit);
}

#endif
