// SPDX-License-Identifier: Apache-2.0
// Which points lie in a small square of the unit square: the scrambles and directions of Sobol's first two dimensions
// are inverted, so that the index of a point follows from its place in a few shifts.
#ifndef CLRAY_SOBOL_PLACE_CL
#define CLRAY_SOBOL_PLACE_CL

#include "math/sobol.cl"

/// The superset sum mod 2: bit j of the result is the sum of the bits k of x of which j has no bit that k lacks. It
/// carries a point's index to its coordinate in Sobol's second dimension, bits reversed, and back.
static u32 superset_sum(u32 x) {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  return x ^ ((x >> 16) & 0x0000ffffu);
}

/// What scramble_reversed() makes into numbers whose first bits are those of `bits`, as far as `mask` (of low bits, as
/// reversed) goes.
static u32 unscramble_reversed(u32 bits, u32 seed, u32 mask) {
  const u32 y = reverse_bits(bits) & mask;
  u32 x = y;
  for (u32 known = mask; known != 0u; known >>= 2) x = y ^ (x * 0x53a22864u);
  const u32 z = x;
  for (u32 known = mask; known != 0u; known >>= 1) x = z ^ (x * 0x05526c56u);
  const u32 factor = (seed >> 16) | 1u;
  u32 inverse = factor;  // Newton's iteration doubles its 3 right bits
  for (u32 k = 0; k < 4u; ++k) inverse *= 2u - factor * inverse;
  x = x * inverse - seed;
  const u32 v = x;
  for (u32 known = mask; known != 0u; known >>= 1) x = v ^ (x * 0x3d20adeau);
  return x & mask;
}

/// The first of the 2^(bits - a - b) indices of a block of 2^bits points from `first` on (a multiple of their number)
/// whose first coordinate begins with the a bits of `cell_u`, the second with the b bits of `cell_v` (bits at the top
/// of the word). They differ from it by superset_sum(n << b) << a for n = 0, 1, …
/// In Sobol's first dimension the index is the coordinate, bits reversed. In its second the polynomial of the index's
/// bits, taken at 1 + x, is that of the coordinate. With index = low + x^a·high that is low(1 + x) + (1 + x)^a·high(1 +
/// x), and (1 + x)^32 is 1 up to x^31.
static u32 first_index(const Sampler* s, u32 first, u32 a, u32 b, u32 cell_u, u32 cell_v) {
  const u32 mask_a = (1u << a) - 1u, mask_b = (1u << b) - 1u;
  const u32 low = unscramble_reversed(cell_u, s->words[2], mask_a);
  u32 y = unscramble_reversed(cell_v, s->words[3], mask_b) ^ superset_sum(first | low);
  for (u32 k = 0; k < 5u; ++k) {
    if (((32u - a) >> k) & 1u) y ^= y << (1u << k);
  }
  return first | low | (superset_sum(y & mask_b) << a);
}

/// Bits 0, 2, 4, … of x, side by side.
static u32 even_bits(u32 x) {
  x &= 0x55555555u;
  x = (x | (x >> 1)) & 0x33333333u;
  x = (x | (x >> 2)) & 0x0f0f0f0fu;
  x = (x | (x >> 4)) & 0x00ff00ffu;
  return (x | (x >> 8)) & 0x0000ffffu;
}

/// The index of point `cell` of a block of points from `first` on, counted along Morton's curve of their places in the
/// unit square. Blocks that are no power of two, or do not begin at a multiple of their size, and random points keep
/// the order of their indices.
static u32 placed_index(const Sampler* s, u32 first, u32 points, u32 cell) {
  const u32 bits = 31u - clz(max(points, 1u));
  if (!CLRAY_SOBOL || points != 1u << bits || (first & (points - 1u)) != 0u || bits < 2u) return first + cell;
  const u32 a = (bits + 1u) / 2u, b = bits - a;
  const u32 even = even_bits(cell), odd = even_bits(cell >> 1);
  const u32 u = a == b ? odd : even, v = a == b ? even : odd;
  return first_index(s, first, a, b, u << (32u - a), v << (32u - b));
}

#endif
