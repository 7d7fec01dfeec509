// SPDX-License-Identifier: Apache-2.0
// Pictures of light curves: against time and, where the phase angle changes, against phase.
#pragma once

#include <string>

#include "io/detector/lightcurve.hpp"

namespace clray::io {

void light_curve_picture(Writer& writer, const LightCurve& curve, const std::string& stem);

}  // namespace clray::io
