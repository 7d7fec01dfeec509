// SPDX-License-Identifier: Apache-2.0
// Scenes for tests and benchmarks, built by hand through the public structs. Body frame, m, rad.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "clray/device.hpp"
#include "clray/result.hpp"
#include "clray/scene.hpp"

namespace clray_test {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLightSpeed = 299792458.0;  ///< m/s
constexpr double radians(double degrees) {
  return degrees * (kPi / 180.0);
}

using MeshPtr = std::shared_ptr<const clray::Mesh>;

/// The one named by CLRAY_TEST_DEVICE, else "cpu".
std::string device_name();
/// The device of all tests of a program, opened once.
clray::Device& device();

// Materials.
clray::Material lambert(double rho);
clray::Material ashikhmin_shirley(double rho, double d, double n);
clray::Material mirror(double reflectance = 1.0);

// Meshes; faces look outward, one material slot.
MeshPtr plate_mesh(double a, double b);                       ///< a along x, b along y, in z = 0
MeshPtr box_mesh(double a, double b, double c);               ///< centred
MeshPtr prism_mesh(int sides, double radius, double height);  ///< about z, centred, closed
MeshPtr sphere_mesh(int slices, int stacks, double radius);   ///< inscribed, poles on z
/// The part of sphere_mesh's inside with polar angle from `low` to `high` rad (of z), seen from inside.
MeshPtr bowl_mesh(int slices, int stacks, double radius, double low, double high);
MeshPtr cone_mesh(int sides, double radius, double height);              ///< base in z = 0, closed
MeshPtr moved(const MeshPtr& mesh, clray::Vec3 by, double scale = 1.0);  ///< scale, then shift
MeshPtr merged(const std::vector<MeshPtr>& parts);

/// A vector at `theta` rad from +z toward `phi` rad of x; unit to rounding.
clray::Vec3 toward(double theta, double phi = 0.0);

/// One component of one material, monostatic from +z, one delay detector.
clray::Scene scene_of(const MeshPtr& mesh, const clray::Material& material);
clray::Scene scene_of(const std::string& shape, const std::map<std::string, double>& keys,
                      const clray::Material& material);
/// Adds a component to a scene and returns it.
clray::Component& add(clray::Scene& scene, const MeshPtr& mesh, const clray::Material& material);
clray::Component& add(clray::Scene& scene, const std::string& shape, const std::map<std::string, double>& keys,
                      const clray::Material& material);

clray::Scene& monostatic(clray::Scene& scene, clray::Vec3 s);
clray::Scene& bistatic(clray::Scene& scene, clray::Vec3 s, clray::Vec3 o);
/// Makes `kind` the only detector.
clray::Scene& detect(clray::Scene& scene, const std::string& kind, const std::map<std::string, double>& keys = {});
/// The delay detector's window, s.
clray::Scene& window(clray::Scene& scene, double first_s, double last_s, int bins);
/// 2^log2_rays rays. More than 2^15 only with CLRAY_LONG_TESTS: up to there CPUs compile without the optimiser, in half
/// the time.
clray::Scene& rays(clray::Scene& scene, int log2_rays, std::uint64_t seed = 1);
/// As many whatever is asked: for bounds of the error that few rays do not keep.
clray::Scene& many_rays(clray::Scene& scene, int log2_rays, std::uint64_t seed = 1);

/// Whether CLRAY_LONG_TESTS asks for what takes many minutes.
bool long_tests();

/// Traces on device().
clray::Result run(const clray::Scene& scene);

}  // namespace clray_test
