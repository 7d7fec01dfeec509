// SPDX-License-Identifier: Apache-2.0
// The bodies of clray-bench end. Body frame, m.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench.hpp"
#include "support/scenes.hpp"

namespace clray_bench {

struct EndBody {
  std::string name;
  std::function<clray_test::MeshPtr()> mesh;
};

/// A box with two canted wings (36 triangles), the meshes that options.meshes names, an assembly of 201,028 triangles
/// with slivers and rods, and a bumpy sphere of 1,002,252.
std::vector<EndBody> end_bodies(const Options& options);

}  // namespace clray_bench
