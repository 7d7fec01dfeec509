// SPDX-License-Identifier: Apache-2.0
// Random scenes for the laws: what is in them comes from the rows of brdf.def, shape.def and detector.def with the
// ranges of their keys, so that a new row is drawn with no new test code. Body frame, m, about 1 m in size.
#pragma once

#include <cstdint>

#include "clray/scene.hpp"
#include "laws/draw.hpp"

namespace clray_test {

/// What a program is compiled for even if it is not specialised: scenes of one frame share their programs. Drawn from
/// its number, so that a few frames give few programs and many give every combination.
struct Frame {
  int bounces = 1, variants = 0, bands = 1, observers = 1;
  bool sobol = true;
  std::vector<std::string> detectors;  ///< kinds, several times and in any order
};
Frame draw_frame(int number);

/// A scene and what the laws need to know of its making.
struct RandomScene {
  std::uint64_t seed = 0;
  int frame = 0;
  clray::Scene scene;
  /// Components 1 and 2 are sheets in one place that look opposite ways.
  bool coincident = false;
  bool flat = false;  ///< only shapes of flat faces, so that single scattering can be solved
};

/// The orbit of scenes with a pass: a body over the Sun's side of the Earth, which no shadow reaches.
constexpr const char* kOrbitStates =
    "time_s,x_km,y_km,z_km\n-1,-3351.417,-6161.518,-2662.5\n5,-3312.915,-6182.41,-2662.5\n"
    "11,-3274.413,-6203.302,-2662.5\n";

constexpr int kComponents = 3, kMaterials = 4;  // of every scene

/// The scene of this seed: one of `frames` frames and a scene of it.
RandomScene draw_scene(std::uint64_t seed, int frames, bool flat = false);

clray::Material draw_material(Draw& draw, const std::string& name, const std::vector<clray::Band>& bands);
/// Whether a model's reflection is a delta, which no connection meets: it reflects, but sends nothing anywhere.
bool is_delta(const clray::Material& material);
/// Whether any surface of the scene, in any variant, reflects so.
bool has_delta(const clray::Scene& scene);

/// A mesh made in memory: open, closed or neither, now and then of two materials.
std::shared_ptr<const clray::Mesh> draw_mesh(Draw& draw);
/// The same faces seen from the other side.
std::shared_ptr<const clray::Mesh> reversed(const clray::Mesh& mesh);

}  // namespace clray_test
