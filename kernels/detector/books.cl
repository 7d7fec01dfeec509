// SPDX-License-Identifier: Apache-2.0
// Energy books, there wherever paths scatter: what arrives, is absorbed, leaves, is won or lost at roulette, is cut
// off, and leaves mirrors toward nobody. Each is added up apart, so that their balance is a test (docs/physics.md,
// section 4).
#ifndef CLRAY_DETECTOR_BOOKS_CL
#define CLRAY_DETECTOR_BOOKS_CL

#include "detector/books.h"

/// Enters a share of the beam in a book of one lane.
static void books_enter(const Buffers* g, Tally* tally, u32 lane, u32 book, f64 share) {
  const u64 at = sum_row(g, CLRAY_FIRST_books, 0u, lane_row(g, tally, lane)) + book;
  keep(g, tally->kept + CLRAY_KEPT_books_books + lane * CLRAY_BOOKS + book, at, share, g->pass->unit_scale,
       CLRAY_UNIT_LIMIT);
}

static void books_enter_all(const Buffers* g, Tally* tally, u32 book, const Light* shares) {
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) books_enter(g, tally, lane, book, shares->lane[lane]);
}

static void detector_books_scatter(const Buffers* g, Tally* tally, u32 n, u32 bounce, const Surface* surface,
                                   const Path* path, const Scattering* s) {
  (void)n;
  (void)path;
  if (bounce == 0u) books_enter_all(g, tally, CLRAY_BOOK_INCIDENT, &s->before);
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane)
    books_enter(g, tally, lane, CLRAY_BOOK_ABSORBED,
                s->before.lane[lane] * (1.0 - surface_reflectance(g, lane, surface)));
  books_enter_all(g, tally, CLRAY_BOOK_ROULETTE, &s->gain);
}

static void detector_books_escape(const Buffers* g, Tally* tally, u32 n, const Path* path, u32 blind) {
  (void)n;
  books_enter_all(g, tally, CLRAY_BOOK_REFLECTED, &path->throughput);
  if (blind) books_enter_all(g, tally, CLRAY_BOOK_UNCONNECTED, &path->throughput);
}

static void detector_books_end(const Buffers* g, Tally* tally, u32 n, const Path* path) {
  (void)n;
  books_enter_all(g, tally, CLRAY_BOOK_TRUNCATED, &path->throughput);
}

static void detector_books_flush(const Buffers* g, const Tally* tally, u32 n) {
  (void)n;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) {
    const u64 at = sum_row(g, CLRAY_FIRST_books, 0u, lane_row(g, tally, lane));
    hand_over(g, at, tally->kept + CLRAY_KEPT_books_books + lane * CLRAY_BOOKS, CLRAY_BOOKS);
  }
}

#endif
