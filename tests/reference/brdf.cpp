// SPDX-License-Identifier: Apache-2.0
// See brdf.hpp.
#include "brdf.hpp"

#include <algorithm>

namespace clray_reference {
namespace {

Real ashikhmin_shirley(const Material& m, V3 n, V3 wi, V3 wo) {
  const Real k1 = dot(n, wi), k2 = dot(n, wo);
  const V3 h = unit(wi + wo);
  const Real kh = dot(wo, h), nh = dot(n, h);
  const Real s = 1 - m.d;
  const Real s_f0 = s * m.f0;
  const Real s_fresnel = s_f0 + (1 - s_f0) * std::pow(1 - kh, 5);
  const Real specular = (m.n + 1) / (8 * kPi) * std::pow(nh, m.n) / (kh * std::max(k1, k2)) * s_fresnel;
  const Real diffuse =
      28 * m.rho / (23 * kPi) * (1 - s_f0) * (1 - std::pow(1 - k1 / 2, 5)) * (1 - std::pow(1 - k2 / 2, 5));
  return m.d * diffuse + specular;
}

}  // namespace

Real reflect(const Material& material, V3 n, V3 wi, V3 wo) {
  const Real i = dot(n, wi), o = dot(n, wo);
  if (i < 0 && o < 0) return material.two_sided ? reflect(material, -n, wi, wo) : 0;
  if (i <= 0 || o <= 0) return 0;
  return material.model == Material::Model::lambert ? material.rho / kPi : ashikhmin_shirley(material, n, wi, wo);
}

}  // namespace clray_reference
