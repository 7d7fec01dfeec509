// SPDX-License-Identifier: Apache-2.0
// What the pressure detector finds: force, torque and absorbed power per unit irradiance, in SI units.
#pragma once

#include <vector>

#include "clray/export.hpp"
#include "clray/result/estimate.hpp"

CLRAY_API_BEGIN
namespace clray {

/// Radiation force and torque per unit irradiance, net of all bounces.
struct PressureResult {
  ResultKey key;                             ///< which member of the run it is
  Band band;                                 ///< of the light that pushes
  double source_W_m2 = 0.0;                  ///< of the source inside the band
  Vec3 sun{0.0, 0.0, 1.0};                   ///< toward the source, body frame
  VectorEstimate coefficient_m2;             ///< C = F c / E
  VectorEstimate torque_coefficient_m3;      ///< about the reference point
  std::vector<VectorEstimate> component_m2;  ///< shares of C, one per Scene::components
  std::vector<VectorEstimate> component_m3;  ///< shares of the torque coefficient, the same
  Estimate absorbed_m2;                      ///< absorbed power over irradiance
};

}  // namespace clray
CLRAY_API_END
