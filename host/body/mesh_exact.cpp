// SPDX-License-Identifier: Apache-2.0
// Expansions: sums of doubles that do not overlap, each exact. A determinant is first taken in plain doubles; only
// where its error bound does not settle the sign is it taken exactly. See mesh_exact.hpp.
#include "body/mesh_exact.hpp"

#include <algorithm>
#include <cmath>

#include "shared/portable.h"

namespace clray {

namespace {

// 192 components hold the determinant: two a difference, eight a product, sixteen a minor, 64 a minor times a
// difference.
class Expansion {
 public:
  Expansion() = default;

  /// a − b, exactly.
  static Expansion difference(double a, double b) {
    Expansion e;
    const double x = a - b, b_virtual = a - x, a_virtual = x + b_virtual;
    e.append((a - a_virtual) + (b_virtual - b));
    e.append(x);
    return e;
  }

  void add(const Expansion& other, double sign) {
    for (int i = 0; i < other.count_; ++i) grow(sign * other.part_[i]);
  }

  Expansion times(const Expansion& other) const {
    Expansion e;
    for (int j = 0; j < other.count_; ++j) {
      for (int i = 0; i < count_; ++i) {
        const double product = part_[i] * other.part_[j];
        e.grow(std::fma(part_[i], other.part_[j], -product));
        e.grow(product);
      }
    }
    return e;
  }

  double largest() const { return count_ == 0 ? 0.0 : part_[count_ - 1]; }
  int sign() const { return (largest() > 0.0) - (largest() < 0.0); }

  /// Times a power of two.
  void scale(int exponent) {
    for (int i = 0; i < count_; ++i) part_[i] = std::ldexp(part_[i], exponent);
  }

 private:
  void append(double part) {
    if (part != 0.0) part_[count_++] = part;
  }

  // Adds one number: each sum keeps its rounding as a part of its own.
  void grow(double b) {
    const int n = count_;
    count_ = 0;
    for (int i = 0; i < n; ++i) {
      const double e = part_[i], sum = b + e, virtual_e = sum - b;
      append((b - (sum - virtual_e)) + (e - virtual_e));
      b = sum;
    }
    append(b);
  }

  double part_[192];
  int count_ = 0;
};

struct Difference {
  Expansion x[3];

  Difference(const Vec3& a, const Vec3& b) {
    for (int k = 0; k < 3; ++k) x[k] = Expansion::difference(a[k], b[k]);
  }
};

// Component `k` of u × v.
Expansion cross(const Difference& u, const Difference& v, int k) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  Expansion sum = u.x[i].times(v.x[j]);
  sum.add(u.x[j].times(v.x[i]), -1.0);
  return sum;
}

// Brings a difference near to 1, so that no product underflows.
void normalise(Difference& d) {
  double most = 0.0;
  for (const Expansion& e : d.x) most = std::max(most, std::fabs(e.largest()));
  if (most == 0.0) return;
  for (Expansion& e : d.x) e.scale(-std::ilogb(most));
}

}  // namespace

int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  double sum = 0.0, most = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    sum += (u[i] * v[j] - u[j] * v[i]) * w[k];
    most += (std::fabs(u[i] * v[j]) + std::fabs(u[j] * v[i])) * std::fabs(w[k]);
  }
  // Shewchuk's bound of orient3d, doubled; below 1e-280 the products may have lost digits.
  if (most > 1e-280 && std::fabs(sum) > 16.0 * 0x1p-53 * most) return sum > 0.0 ? 1 : -1;
  for (int k = 0; k < 3; ++k) {
    if (a[k] == b[k] && a[k] == c[k] && a[k] == d[k]) return 0;
  }
  Difference p(b, a), q(c, a), r(d, a);
  normalise(p);
  normalise(q);
  normalise(r);
  Expansion total;
  for (int k = 0; k < 3; ++k) total.add(cross(p, q, k).times(r.x[k]), 1.0);
  return total.sign();
}

int turn_sign(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double left = (b[i] - a[i]) * (c[j] - a[j]), right = (b[j] - a[j]) * (c[i] - a[i]);
  const double sum = left - right, most = std::fabs(left) + std::fabs(right);
  if (most > 1e-280 && std::fabs(sum) > 8.0 * 0x1p-53 * most) return sum > 0.0 ? 1 : -1;
  Difference p(b, a), q(c, a);
  normalise(p);
  normalise(q);
  return cross(p, q, axis).sign();
}

int area_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a;
  const double size[3] = {std::fabs(difference_of_products(u.y, v.z, u.z, v.y)),
                          std::fabs(difference_of_products(u.z, v.x, u.x, v.z)),
                          std::fabs(difference_of_products(u.x, v.y, u.y, v.x))};
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int i, int j) { return size[i] > size[j]; });
  for (const int axis : order) {
    if (turn_sign(a, b, c, axis) != 0) return axis;
  }
  return -1;
}

}  // namespace clray
