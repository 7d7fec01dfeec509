// SPDX-License-Identifier: Apache-2.0
// The sample points: Owen-scrambled Sobol sequences with Joe-Kuo (2008) directions in dimensions 0 … 63, Philox
// beyond them and for the plain random sampler. Dimensions 0-1 are the beam or the pixel; bounce k = 0, 1, … takes
// 2+4k … 5+4k (lobe, two for the direction, roulette).
// Scramble: hash-based nested uniform scramble of the bit-reversed number (Burley 2020, "Practical hash-based Owen
// scrambling", with Vegdahl's 2021 constants), seeded by Philox(seed ^ key of the view; replicate, group, epoch,
// stream), where
// dimension d takes word (d+2) mod 4 of group (d+2)/4.
#ifndef CLRAY_SOBOL_CL
#define CLRAY_SOBOL_CL

#include "shared/philox.h"

#define CLRAY_SOBOL_DIMENSIONS 64

/// Who draws: everything that selects a stream of samples, and the point's index in it.
typedef struct Sampler {
  u32 key0, key1, epoch;
  u32 replicate;
  u32 stream;  // 0 for a beam, 1 + pixel for pixels
  u32 index;
  u32 words[4];  // of group 0, which all points of a Sobol stream share
  u32 origin;    // the index of a point
  u32 base[2];   // dimensions 0 and 1 of that point, unscrambled, bits reversed
} Sampler;

/// Four seeds (or random words) of dimensions 4·group-2 … 4·group+1.
static void sampler_words(const Sampler* s, u32 group, u32 index, u32 out[4]) {
  const u32 counter[4] = {s->replicate, group | (s->epoch << 24), index, s->stream};
  philox4x32(s->key0, s->key1, counter, out);
}

static u32 reverse_bits(u32 x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

/// Owen scramble of a number given with its bits reversed; the result is the right way round.
static u32 scramble_reversed(u32 x, u32 seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return reverse_bits(x);
}

/// Point `index` of Sobol dimension `dimension`, bits reversed (as the directions are stored).
static u32 sobol_reversed(const __global u32* directions, u32 dimension, u32 index) {
  const __global u32* column = directions + 32u * dimension;
  u32 x = 0;
  while (index != 0u) {
    const u32 bit = 31u - clz(index);
    x ^= column[bit];
    index ^= 1u << bit;
  }
  return x;
}

/// The middle of the bits' cell: in (0, 1), never an end.
static f64 unit_from_bits(u32 bits) { return ((f64)bits + 0.5) * CLRAY_TWO_TO_MINUS_32; }

/// `count` coordinates of dimensions 4·group-2+skip …, of the sampler's current point.
static void sampler_draw(const Sampler* s, const __global u32* directions, u32 group, u32 skip, u32 count, f64* out) {
  u32 words[4];
  const u32 first = 4u * group + skip - 2u;
  if (CLRAY_SOBOL && first + count <= CLRAY_SOBOL_DIMENSIONS) {
    sampler_words(s, group, 0xffffffffu, words);
    for (u32 k = 0; k < count; ++k)
      out[k] = unit_from_bits(scramble_reversed(sobol_reversed(directions, first + k, s->index), words[skip + k]));
    return;
  }
  sampler_words(s, group, s->index, words);
  for (u32 k = 0; k < count; ++k) out[k] = unit_from_bits(words[skip + k]);
}

/// Prepares a sampler for points near `origin`: those whose indices differ from it in few bits cost least.
static void sampler_begin(Sampler* s, const __global u32* directions, u32 origin) {
  s->index = s->origin = origin;
  sampler_words(s, 0u, 0xffffffffu, s->words);
  for (u32 k = 0; CLRAY_SOBOL && k < 2u; ++k) s->base[k] = sobol_reversed(directions, k, origin);
}

/// Dimensions 0 and 1 of the current point, as sampler_draw gives them, from what it shares with the origin.
static void sampler_draw_first(Sampler* s, const __global u32* directions, f64* out) {
  if (!CLRAY_SOBOL) {
    sampler_draw(s, directions, 0u, 2u, 2u, out);
    return;
  }
  for (u32 k = 0; k < 2u; ++k) {
    const u32 x = s->base[k] ^ sobol_reversed(directions, k, s->index ^ s->origin);
    out[k] = unit_from_bits(scramble_reversed(x, s->words[2u + k]));
  }
}

#endif
