// SPDX-License-Identifier: Apache-2.0
// Pictures as PNG (8-bit sRGB with straight alpha, libpng) and as linear EXR (32-bit float, OpenEXR).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clray::io {

/// 8-bit RGBA, rows from the top.
struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Throws Error(output). `description` is stored as text in the file.
void write_png(const std::string& path, const Pixels& pixels, const std::string& description);

/// One channel of an EXR file, rows from the top.
struct Channel {
  std::string name;
  std::vector<float> values;
};

/// Throws Error(output).
void write_exr(const std::string& path, int width, int height, const std::vector<Channel>& channels,
               const std::string& description);

}  // namespace clray::io
