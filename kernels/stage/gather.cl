// SPDX-License-Identifier: Apache-2.0
// What the work-items of a group kept is added up in local memory, and handed over once for each replicate: on a GPU
// many items would add to the same few numbers. Sums are integers, so nobody can tell. Items side by side have
// different replicates (CLRAY_PLACED). Kept numbers below CLRAY_KEPT_SUMS are sums, those after them the greatest of
// what was seen, as numbers of 32 bits. What is kept of a pixel is few items' own.
#ifndef CLRAY_GATHER_CL
#define CLRAY_GATHER_CL

#define CLRAY_GATHER 0
#if CLRAY_PLACED
#ifndef CLRAY_NO_INT64_ATOMICS
#if CLRAY_KEPT <= 64 && !CLRAY_PIXELS
#undef CLRAY_GATHER
#define CLRAY_GATHER 1
#endif
#endif
#endif

#if CLRAY_GATHER

#define CLRAY_GATHER_REPLICATES 16u
#define CLRAY_GATHER_EVENTS 4u

typedef struct Gathered {
  i64 sums[CLRAY_GATHER_REPLICATES * CLRAY_KEPT];
  u32 greatest[CLRAY_GATHER_REPLICATES * CLRAY_KEPT];
  u32 events[CLRAY_GATHER_EVENTS];
} Gathered;

#define CLRAY_NO_VIEW 0xffffffffu

/// The view that all items first … end - 1 belong to, if its replicates have room; or CLRAY_NO_VIEW.
static u32 gather_view(const Buffers* g, const __global u32* asked, u64 first, u64 end, u32 parts) {
  const u32 replicates = g->pass->replicates;
  const u64 of_a_view = max((u64)replicates * parts, (u64)1);
  if (replicates > CLRAY_GATHER_REPLICATES || end <= first) return CLRAY_NO_VIEW;
  return first / of_a_view == (end - 1u) / of_a_view ? asked[first / of_a_view] : CLRAY_NO_VIEW;
}

/// The group clears what it gathers. A barrier must follow.
static void gather_begin(__local Gathered* all) {
  const u32 step = get_local_size(0);
  for (u32 k = get_local_id(0); k < CLRAY_GATHER_REPLICATES * CLRAY_KEPT; k += step) {
    all->sums[k] = 0;
    all->greatest[k] = 0u;
  }
  for (u32 k = get_local_id(0); k < CLRAY_GATHER_EVENTS; k += step) all->events[k] = 0u;
}

/// An item adds what it kept. A barrier must follow when all have.
static void gather_add(__local Gathered* all, const Tally* tally) {
  const u32 row = CLRAY_KEPT * tally->replicate;
  for (u32 k = 0; k < CLRAY_KEPT; ++k) {
    if (tally->kept[k] == 0) continue;
    if (k < CLRAY_KEPT_SUMS)
      atom_add(all->sums + row + k, tally->kept[k]);
    else
      atomic_max(all->greatest + row + k, (u32)tally->kept[k]);
  }
  const u32 events[CLRAY_GATHER_EVENTS] = {tally->started, tally->escaped, tally->killed, tally->capped};
  for (u32 k = 0; k < CLRAY_GATHER_EVENTS; ++k) {
    if (events[k] != 0u) atomic_add(all->events + k, events[k]);
  }
}

/// The group hands over what its items of a view kept.
static void gather_flush(const Buffers* g, const __local Gathered* all, u32 view) {
  Buffers own = *g;
  own.counters += CLRAY_COUNTERS * view;
  Tally tally;
  tally.view = view;
  tally.stream = 0u;
  tally_clear(&tally);
  if (get_local_id(0) == 0u) {
    tally.started = all->events[0];
    tally.escaped = all->events[1];
    tally.killed = all->events[2];
    tally.capped = all->events[3];
  }
  for (u32 r = get_local_id(0); r < g->pass->replicates; r += get_local_size(0)) {
    tally.replicate = r;
    for (u32 k = 0; k < CLRAY_KEPT; ++k)
      tally.kept[k] = k < CLRAY_KEPT_SUMS ? all->sums[CLRAY_KEPT * r + k] : (i64)all->greatest[CLRAY_KEPT * r + k];
    tally_flush(&own, &tally);
    tally.started = tally.escaped = tally.killed = tally.capped = 0u;
  }
}

#endif

#endif
