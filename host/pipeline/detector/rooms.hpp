// SPDX-License-Identifier: Apache-2.0
// The detectors that mean more than the sums their rows state.
#pragma once

#include "pipeline/detector/room.hpp"

namespace clray {

extern const DetectorRoom kDelayRoom, kIntensityRoom, kSpectrometerRoom, kPressureRoom, kBooksRoom, kRgbRoom,
    kHyperspectralRoom, kPixelsRoom, kCausticsRoom;

}  // namespace clray
