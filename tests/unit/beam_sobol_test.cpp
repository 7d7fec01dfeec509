// SPDX-License-Identifier: Apache-2.0
// The table of Sobol directions against what defines it: all primitive polynomials in order, Sobol's recurrence, the
// published first points, and properties that Joe & Kuo's numbers were chosen to have and a slip would break.
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "beam/sobol.hpp"

using namespace clray;

namespace {

constexpr int kDimensions = 64;

std::uint32_t mirrored(std::uint32_t x) {
  std::uint32_t out = 0;
  for (int k = 0; k < 32; ++k) out |= ((x >> k) & 1u) << (31 - k);
  return out;
}

/// Directions the right way round: [dimension][k], first bit = 1/2.
const std::vector<std::vector<std::uint32_t>>& directions() {
  static const std::vector<std::vector<std::uint32_t>> all = [] {
    const std::vector<std::uint32_t> stored = sobol_directions_reversed();
    REQUIRE(stored.size() == kDimensions * 32);
    std::vector<std::vector<std::uint32_t>> v(kDimensions);
    for (int d = 0; d < kDimensions; ++d)
      for (int k = 0; k < 32; ++k) v[d].push_back(mirrored(stored[32 * d + k]));
    return v;
  }();
  return all;
}

std::uint32_t point(int dimension, std::uint32_t index) {
  std::uint32_t x = 0;
  for (int k = 0; k < 32; ++k)
    if (index >> k & 1u) x ^= directions()[dimension][k];
  return x;
}

/// Primitive polynomials over GF(2) by degree, then by value: x generates all 2^degree - 1 non-zero residues.
std::vector<std::uint32_t> primitive_polynomials(std::size_t count) {
  std::vector<std::uint32_t> found;
  for (int degree = 1; found.size() < count; ++degree)
    for (std::uint32_t p = (1u << degree) | 1u; p < (2u << degree) && found.size() < count; p += 2) {
      std::uint32_t x = 1, order = 0;
      do {
        x <<= 1;
        if (x >> degree & 1u) x ^= p;
        ++order;
      } while (x != 1 && x != 0 && order <= (1u << degree));
      if (x == 1 && order == (1u << degree) - 1) found.push_back(p);
    }
  return found;
}

int degree_of(std::uint32_t p) {
  int degree = 0;
  while (p >>= 1) ++degree;
  return degree;
}

}  // namespace

TEST_CASE("the first points are those of Sobol's definition") {
  // Joe & Kuo's example in three dimensions, listed by Gray code: the point of index g is Gray's i ^ (i >> 1).
  const double expected[10][3] = {{0, 0, 0},
                                  {0.5, 0.5, 0.5},
                                  {0.75, 0.25, 0.25},
                                  {0.25, 0.75, 0.75},
                                  {0.375, 0.375, 0.625},
                                  {0.875, 0.875, 0.125},
                                  {0.625, 0.125, 0.875},
                                  {0.125, 0.625, 0.375},
                                  {0.1875, 0.3125, 0.9375},
                                  {0.6875, 0.8125, 0.4375}};
  for (std::uint32_t i = 0; i < 10; ++i)
    for (int d = 0; d < 3; ++d) CHECK(point(d, i ^ (i >> 1)) * 0x1p-32 == expected[i][d]);
}

TEST_CASE("dimension 0 mirrors the bits of the index; dimension 1 is Pascal's triangle modulo 2") {
  for (std::uint32_t i = 0; i < 5000; ++i) CHECK(point(0, i * 858993u) == mirrored(i * 858993u));
  for (int k = 0; k < 32; ++k)
    for (int j = 0; j <= k; ++j) {
      const bool odd = (k & j) == j;  // Lucas: binomial(k, j) is odd
      CHECK(((directions()[1][k] >> (31 - j)) & 1u) == (odd ? 1u : 0u));
    }
}

TEST_CASE("each dimension obeys the recurrence of its own primitive polynomial, in order") {
  const std::vector<std::uint32_t> polynomials = primitive_polynomials(kDimensions - 1);
  for (int d = 1; d < kDimensions; ++d) {
    CAPTURE(d);
    const std::uint32_t p = polynomials[d - 1];
    const int s = degree_of(p);
    // m_k = v_k·2^k (k from 1) is an odd integer below 2^k; m_k = XOR_j 2^j a_j m_{k-j} ^ m_{k-s}, j = 1 … s, where
    // the polynomial is x^s + a_1 x^(s-1) + … + a_s.
    std::vector<std::uint64_t> m(33);
    for (int k = 1; k <= 32; ++k) {
      const std::uint64_t v = directions()[d][k - 1];
      REQUIRE((v & ((1ull << (32 - k)) - 1)) == 0);
      m[k] = v >> (32 - k);
      CHECK(m[k] % 2 == 1);
    }
    int wrong = 0;
    for (int k = s + 1; k <= 32; ++k) {
      std::uint64_t expected = m[k - s];
      for (int j = 1; j <= s; ++j)
        if (p >> (s - j) & 1u) expected ^= m[k - j] << j;
      wrong += expected != m[k];
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("Sobol's property A: the first 2^n points lie one in each of the 2^n half-by-half cells of n dimensions") {
  // Joe & Kuo's numbers have it in up to 1111 dimensions: the matrix of first bits of the first n directions of the
  // first n dimensions is regular over GF(2), for every n that 32 bits of index allow.
  for (int n = 1; n <= 32; ++n) {
    CAPTURE(n);
    std::vector<std::uint64_t> rows;
    for (int d = 0; d < n; ++d) {
      std::uint64_t row = 0;
      for (int k = 0; k < n; ++k) row |= static_cast<std::uint64_t>(directions()[d][k] >> 31) << k;
      rows.push_back(row);
    }
    int rank = 0;
    for (int column = 0; column < n; ++column) {
      int pivot = rank;
      while (pivot < n && !(rows[pivot] >> column & 1u)) ++pivot;
      if (pivot == n) break;
      std::swap(rows[rank], rows[pivot]);
      for (int r = 0; r < n; ++r)
        if (r != rank && (rows[r] >> column & 1u)) rows[r] ^= rows[rank];
      ++rank;
    }
    CHECK(rank == n);
  }
}

TEST_CASE("the initial numbers are Joe and Kuo's") {
  // Sum h = 31 h + m over m_1 … m_degree of dimensions 1 to 63, worked out from a second copy of new-joe-kuo-6.21201
  // than the one the table was made of: no property tells these numbers from others that are as odd and as small.
  const std::vector<std::uint32_t> polynomials = primitive_polynomials(kDimensions - 1);
  std::uint64_t h = 0;
  for (int d = 1; d < kDimensions; ++d)
    for (int k = 1; k <= degree_of(polynomials[d - 1]); ++k) h = 31 * h + (directions()[d][k - 1] >> (32 - k));
  CHECK(h == 0xdc018e1919185caull);
}

TEST_CASE("every dimension alone fills 2^k cells once, at every k; no two dimensions are alike") {
  std::set<std::vector<std::uint32_t>> distinct(directions().begin(), directions().end());
  CHECK(distinct.size() == kDimensions);
  for (int d = 0; d < kDimensions; ++d)
    for (int bits : {1, 2, 5, 10}) {
      std::vector<int> cells(1u << bits, 0);
      for (std::uint32_t i = 0; i < (1u << bits); ++i) ++cells[point(d, i) >> (32 - bits)];
      CHECK(std::set<int>(cells.begin(), cells.end()) == std::set<int>{1});
    }
}

TEST_CASE("the beam's two dimensions are a (0, m, 2)-net") {
  const int m = 12;
  for (int a = 0; a <= m; ++a) {
    std::vector<int> cells(1u << m, 0);
    for (std::uint32_t i = 0; i < (1u << m); ++i) {
      const std::uint32_t x = a == 0 ? 0 : point(0, i) >> (32 - a), y = a == m ? 0 : point(1, i) >> (32 - (m - a));
      ++cells[(static_cast<std::size_t>(x) << (m - a)) | y];
    }
    CHECK(std::set<int>(cells.begin(), cells.end()) == std::set<int>{1});
  }
}
