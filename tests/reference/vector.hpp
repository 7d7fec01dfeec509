// SPDX-License-Identifier: Apache-2.0
// Vectors of three long doubles for the reference tracer, which shares no code with kernels/ or host/.
#pragma once

#include <cmath>

namespace clray_reference {

using Real = long double;
constexpr Real kPi = 3.14159265358979323846264338327950288L;
constexpr Real kLightSpeed = 299792458.0L;  ///< m/s

struct V3 {
  Real x = 0, y = 0, z = 0;
};

inline V3 operator+(V3 a, V3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline V3 operator-(V3 a, V3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline V3 operator-(V3 a) {
  return {-a.x, -a.y, -a.z};
}
inline V3 operator*(Real k, V3 a) {
  return {k * a.x, k * a.y, k * a.z};
}
inline Real dot(V3 a, V3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline V3 cross(V3 a, V3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real length(V3 a) {
  return std::sqrt(dot(a, a));
}
inline V3 unit(V3 a) {
  return (1 / length(a)) * a;
}

/// `a` turned by `angle` rad about the unit vector `axis`, right-handed (Rodrigues 1840).
inline V3 rotated(V3 a, V3 axis, Real angle) {
  const Real c = std::cos(angle), s = std::sin(angle);
  return c * a + s * cross(axis, a) + (dot(axis, a) * (1 - c)) * axis;
}

}  // namespace clray_reference
