// SPDX-License-Identifier: Apache-2.0
// Constants of mathematics and physics, each written once. c, h and k are exact in the SI of 2019. The Sun's are the
// nominal values of IAU 2015 Resolution B3. Kernels have shared/constants.h.
#pragma once

/// Constants of mathematics and physics.
namespace clray::constants {

inline constexpr double kPi = 3.14159265358979323846;   ///< pi
inline constexpr double kDegrees = 180.0 / kPi;         ///< of one radian
inline constexpr double kLightSpeed_m_s = 299792458.0;  ///< c
inline constexpr double kPlanck_J_s = 6.62607015e-34;   ///< h
inline constexpr double kBoltzmann_J_K = 1.380649e-23;  ///< k
inline constexpr double kSun_K = 5772.0;                ///< effective temperature of the Sun
inline constexpr double kSolarConstant_W_m2 = 1361.0;   ///< irradiance of the Sun at 1 au, all wavelengths
inline constexpr double kAbZero_W_m2_Hz = 3631e-26;     ///< of AB magnitude 0 (Oke & Gunn 1983)

}  // namespace clray::constants
