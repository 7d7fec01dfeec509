// SPDX-License-Identifier: Apache-2.0
// The delay camera's pictures: one pulse with its error band, and a map of delay and time of many.
#pragma once

#include <string>
#include <vector>

#include "io/writer.hpp"

namespace clray::io {

/// Words for titles: as Writer::title(), and the band.
std::string delay_title(const Writer& writer, const ResultKey& key);

void delay_pulse_picture(Writer& writer, const DelayResult& delay, const std::string& stem);

/// Of orientations whose bins are the same.
void delay_map_picture(Writer& writer, const std::vector<const DelayResult*>& group, const std::string& stem);

}  // namespace clray::io
