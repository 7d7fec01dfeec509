// SPDX-License-Identifier: Apache-2.0
// Files for tests of ephemerides, and circular orbits to fill them with.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <string>

#include "clray/scene.hpp"

namespace clray::test {

/// A file in a folder of this test's own, removed with it.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("clray-ephemeris-{}", static_cast<const void*>(this));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return (path / name).string();
  }
};

constexpr double kOrbitRate = 2.0 * 3.14159265358979323846 / 5829.0, kOrbitRadius_m = 7.0e6;

/// A circular orbit of 7000 km, inclined, one turn in 5829 s.
inline Vec3 orbit(double t) {
  const double w = kOrbitRate, a = kOrbitRadius_m;
  return {a * std::cos(w * t), a * std::sin(w * t) * 0.6, a * std::sin(w * t) * 0.8};
}
inline Vec3 orbit_velocity(double t) {
  const double w = kOrbitRate, a = kOrbitRadius_m * kOrbitRate;
  return {-a * std::sin(w * t), a * std::cos(w * t) * 0.6, a * std::cos(w * t) * 0.8};
}

}  // namespace clray::test
