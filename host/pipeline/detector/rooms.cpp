// SPDX-License-Identifier: Apache-2.0
// See rooms.hpp and room.hpp.
#include "pipeline/detector/rooms.hpp"

namespace clray {

const DetectorRoom& room_of(const std::string& id) {
  static const DetectorRoom plain{""};
  for (const DetectorRoom* room : {&kDelayRoom, &kIntensityRoom, &kSpectrometerRoom, &kPressureRoom, &kBooksRoom,
                                   &kRgbRoom, &kHyperspectralRoom, &kPixelsRoom, &kCausticsRoom}) {
    if (id == room->id) return *room;
  }
  return plain;
}

}  // namespace clray
