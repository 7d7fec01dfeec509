// SPDX-License-Identifier: Apache-2.0
// A work-item of packets. It carries points of all replicates that are neighbours in the unit square, puts them in the
// order of their places in the beam, and cuts that order into packets that are no wider than the beam's points and the
// body's faces make worth while. Shadow rays from the first surfaces go in packets, too; what follows goes alone.
#ifndef CLRAY_PACKET_ITEM_CL
#define CLRAY_PACKET_ITEM_CL

#if CLRAY_PACKET

/// Finds which connections something hides from the surfaces that the rays of a packet have met (`hits`: a bit each):
/// a bit of hidden[k] for each of the first CLRAY_HIDDEN. Asks where stage_shade() would, surface by surface, since
/// some first hits may be solved and others not. The packet that came was as wide as `width` of the beam; shadow rays
/// go together that start no farther from each other, across their direction, than twice that.
static void packet_shadows(const Buffers* g, u32 view, const Surface* met, u32 hits, f64 width, u32* hidden) {
  for (u32 k = 0; k < CLRAY_PACKET_RAYS; ++k) hidden[k] = 0u;
#if CLRAY_SHADOW && CLRAY_CONNECT
  const __global ClrayView* from = g->views + view;
  const f64 reach = 2.0 * width * f64_max(v3_length(v3_load(from->edge_u)), v3_length(v3_load(from->edge_v)));
  Packet p;
  p.any = 1u;
  u32 of[CLRAY_PACKET_RAYS];
  for (u32 c = 0; c < CLRAY_CONNECTIONS && c < CLRAY_HIDDEN; ++c) {
    const __global ClrayConnection* connection = g->connections + view * CLRAY_CONNECTIONS + c;
    if (!connection->shadow) continue;
    const vec3 o = v3_load(connection->direction);
    u32 left = 0u;
    for (u32 k = 0; k < CLRAY_PACKET_RAYS; ++k) {
      if (((hits >> k) & 1u) == 0u || counts_elsewhere(g, view, met[k].primitive)) continue;
      left |= faces(&met[k], o) ? 1u << k : 0u;
    }
    while (left != 0u) {
      p.rays = 0u;
      for (u32 k = 0; k < CLRAY_PACKET_RAYS; ++k) {
        if (((left >> k) & 1u) == 0u) continue;
        p.ray[p.rays] = ray_from(&met[k], o);
        if (p.rays != 0u && packet_across(&p, p.ray[p.rays].o) > reach) continue;
        of[p.rays++] = k;
        left &= ~(1u << k);
      }
      packet_intersect(g, view, &p);
      for (u32 k = 0; k < p.rays; ++k) hidden[of[k]] |= p.hit[k].primitive != 0xffffffffu ? 1u << c : 0u;
    }
  }
#endif
}

/// A work-item of packets: part `part` of a block of points, up to `chunk` of them, of all replicates of a view.
static void trace_packets(const Buffers* g, u32 view, u32 first_point, u32 points, u32 part, u32 chunk) {
  const u32 replicates = min(g->pass->replicates, CLRAY_PACKET_REPLICATES);
  const u32 cells = min(chunk, points - part * chunk);
  const __global ClrayView* from = g->views + view;
  Buffers own = *g;
  own.counters += CLRAY_COUNTERS * view;
  Tally tally[CLRAY_PACKET_REPLICATES];
  Sampler sampler[CLRAY_PACKET_REPLICATES];
  BeamPoint point[CLRAY_PACKET_ITEM];
  u32 place[CLRAY_PACKET_ITEM], order[CLRAY_PACKET_ITEM];
  for (u32 r = 0; r < replicates; ++r) {
    tally[r].view = view;
    tally[r].replicate = r;
    tally[r].stream = 0u;
    tally_clear(&tally[r]);
    const Sampler s = {g->pass->key0 ^ from->key0, g->pass->key1 ^ from->key1, g->pass->epoch, r, 0u, 0u};
    sampler[r] = s;
    sampler_begin(&sampler[r], g->directions, first_point);
    packet_points(&own, &sampler[r], view, first_point, points, part, chunk, point + CLRAY_PACKET_CELLS * r,
                  place + CLRAY_PACKET_CELLS * r);
  }
  const u32 count = cells * replicates;
  packet_sort(place, replicates, cells, order);
  const f64 widest = f64_min(8.0 / sqrt((f64)points), 1.0 / (f64)max(g->pass->finest, 1u));
  const f64 dense_width = 0.25 / (f64)max(g->pass->finest, 1u);  // where rays are denser than faces
  Packet packet;
  packet.any = 0u;
  Surface met[CLRAY_PACKET_RAYS];
  u32 hidden[CLRAY_PACKET_RAYS];
  for (u32 begin = 0; begin < count; begin += packet.rays) {
    f64 low_u = 1.0, high_u = 0.0, low_v = 1.0, high_v = 0.0, width = 0.0;
    packet.rays = 0u;
    while (packet.rays < CLRAY_PACKET_RAYS && begin + packet.rays < count) {
      const BeamPoint* next = point + order[begin + packet.rays];
      low_u = f64_min(low_u, next->u);
      high_u = f64_max(high_u, next->u);
      low_v = f64_min(low_v, next->v);
      high_v = f64_max(high_v, next->v);
      const f64 with_next = f64_max(high_u - low_u, high_v - low_v);
      if (with_next > (packet.rays < CLRAY_PACKET_RAYS / 2u ? widest : dense_width)) break;
      width = with_next;
      packet.ray[packet.rays++] = primary_ray(from, next->u, next->v);
    }
    packet_intersect(&own, view, &packet);
    u32 hits = 0u;
    for (u32 k = 0; k < packet.rays; ++k) {
      if (packet.hit[k].primitive == 0xffffffffu) continue;
      hits |= 1u << k;
      met[k] = stage_surface(&own, &packet.ray[k], &packet.hit[k]);
    }
    // Where rays are sparser than faces, packets of shadow rays touch more than their rays alone would.
    const u32 dense = width < dense_width;
    if (dense) packet_shadows(&own, view, met, hits, width, hidden);
    for (u32 k = 0; k < packet.rays; ++k) {
      const BeamPoint* start = point + order[begin + k];
      const u32 r = order[begin + k] / CLRAY_PACKET_CELLS;
      Path path = path_of(start->share);
      path.known = dense;
      path.hidden = dense ? hidden[k] : 0u;
      sampler[r].index = start->index;
      follow_path(&own, &sampler[r], &tally[r], &path, packet.ray[k], 1u, (hits >> k) & 1u, &met[k]);
    }
  }
  for (u32 r = 0; r < replicates; ++r) tally_flush(&own, &tally[r]);
}

#endif

#endif
