// SPDX-License-Identifier: Apache-2.0
// Results and scenes made by hand for the tests of host/io, and a folder of one's own.
#pragma once

#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "clray/result.hpp"

namespace io_test {

/// A temporary folder, removed at the end of a test.
struct Scratch {
  std::filesystem::path path;
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "clray-io-XXXXXX").string();
    path = ::mkdtemp(name.data());
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::permissions(path, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(path, ignored);
  }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path), {}));
  }
};

inline std::string slurp(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void spit(const std::string& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

inline clray::Scene scene(const std::string& kind = "delay") {
  clray::Scene scene;
  scene.path = "meshes/plate.toml";
  scene.name = "plate";
  scene.materials.push_back({});
  scene.components.push_back({});
  scene.components.front().shape = "rectangle";
  scene.components.front().materials = {0};
  scene.detectors.push_back({kind, kind, {}});
  scene.observers.push_back({});
  return scene;
}

/// A delay result whose numbers need all 17 digits.
inline clray::DelayResult delay(std::size_t bins = 8, std::size_t orientation = 0) {
  clray::DelayResult d;
  d.key.detector = "delay";
  d.key.orientation = orientation;
  d.intensity_m2_per_sr = {1.0 / 3.0, 1e-3 / 7.0, 0.33, 0.34, 0.1};
  d.mean_delay_s = {-1e-9 / 3.0, 1e-13 / 7.0, 0.0, 0.0, 0.0};
  d.rms_width_s = {2e-9 / 3.0, 1e-13 / 9.0, 0.0, 0.0, 0.0};
  d.first_bin_start_s = -4e-9 / 3.0;
  d.bin_width_s = 1e-9 / 3.0;
  for (std::size_t i = 0; i < bins; ++i) {
    d.bin_m2_per_sr.push_back(std::sqrt(static_cast<double>(i + orientation)) / 7.0);
    d.bin_standard_error.push_back(0.01 / static_cast<double>(i + 3));
    d.bin_upper_bound.push_back(0.2);
    d.hits.push_back(i * 5);
    d.resolved.push_back(i * 5 >= 10);
  }
  return d;
}

inline clray::Result result() {
  clray::Result r;
  r.device.name = "test device";
  r.seed = 18446744073709551615ull;
  r.rays = 1 << 20;
  r.digest = 0x00000000deadbeefull;
  r.replicates = 16;
  r.orientations.push_back({});
  r.errors.push_back({"search", 16384, 0.01, 0.03, 0.34});
  r.errors.push_back({"search", 32768, 0.02, 0.02, 0.335});
  r.errors.push_back({"confirm", 32768, 0.02, 0.021, 1.0 / 3.0});
  return r;
}

}  // namespace io_test
