// SPDX-License-Identifier: Apache-2.0
// The reference tracer's surface reflection: Lambert and Ashikhmin-Shirley in long double, written from the
// papers' own form (Ashikhmin & Shirley 2000; d/s weights of Wetterer, Hill & Jah 2014), not from kernels/.
#pragma once

#include "vector.hpp"

namespace clray_reference {

struct Material {
  enum class Model { lambert, ashikhmin_shirley };
  Model model = Model::lambert;
  Real rho = 1;           ///< diffuse reflectance
  Real d = 1, n = 0;      ///< diffuse fraction and exponent of Ashikhmin-Shirley
  Real f0 = 1;            ///< its reflectance at normal incidence
  bool two_sided = true;  ///< false: the back is black
};

/// f(wi, wo), 1/sr, on a surface with unit normal `n` (outward: counter-clockwise winding). Zero where the two
/// directions lie on different sides, along the surface, or on a black back.
Real reflect(const Material& material, V3 n, V3 wi, V3 wo);

}  // namespace clray_reference
