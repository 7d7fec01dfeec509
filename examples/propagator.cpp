// SPDX-License-Identifier: Apache-2.0
// A propagator's steps with the force and the torque of sunlight: a sail of two halves of different reflectance, held
// by nothing, is pushed and turned. Each step asks clray for the exact coefficients of the Sun's direction in the body
// frame, F = C E / c and T = D E / c, and integrates position, velocity, attitude and rate (symplectic Euler). With
// the Sun on +z and the sail still facing it, C_z = -(A_1 (1 + rho_1 2/3) + A_2 (1 + rho_2 2/3)), Lambert's law.
// Usage: propagator [DEVICE [STEPS]]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "clray/constants.hpp"
#include "clray/device.hpp"
#include "clray/error.hpp"
#include "clray/prepared.hpp"

namespace {

using clray::Quaternion;
using clray::Vec3;

constexpr double kHalf_m2 = 2.0, kRho[2] = {0.2, 0.8};
constexpr double kMass_kg = 1.0, kInertia_kg_m2 = 0.5, kStep_s = 60.0;

clray::Scene sail() {
  clray::Scene scene;
  scene.name = "sail";
  for (int half = 0; half < 2; ++half) {
    clray::Material material;
    material.name = half == 0 ? "dark" : "bright";
    material.parameters["rho"] = kRho[half];
    scene.materials.push_back(material);
    clray::Component plate;
    plate.name = material.name + " half";
    const double x = half == 0 ? -1.0 : 0.0;  // 1 m along x, 2 m along y
    plate.mesh = clray::make_mesh({{x, -1.0, 0.0}, {x + 1.0, -1.0, 0.0}, {x + 1.0, 1.0, 0.0}, {x, 1.0, 0.0}},
                                  {{{0, 1, 2}}, {{0, 2, 3}}});
    plate.materials = {static_cast<std::uint32_t>(half)};
    scene.components.push_back(plate);
  }
  scene.source.kind = clray::Source::Kind::sun;
  scene.observers.push_back({});
  scene.detectors.push_back({"pressure", "", {}});
  scene.trace.method = clray::Method::exact;
  return scene;
}

Vec3 turned(const Quaternion& q, const Vec3& v) {
  const Vec3 u(q.x, q.y, q.z);
  const auto cross = [](const Vec3& a, const Vec3& b) {
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  };
  return v + 2.0 * cross(u, cross(u, v) + q.w * v);
}

Quaternion normalised(const Quaternion& q) {
  const double l = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / l, q.x / l, q.y / l, q.z / l};
}

int run(const char* device_choice, int steps) {
  clray::Device device(device_choice);
  const clray::Scene scene = sail();
  clray::Prepared prepared(scene, device);
  const double pressure_Pa = clray::constants::kSolarConstant_W_m2 / clray::constants::kLightSpeed_m_s;
  const Vec3 sun(0.0, 0.0, 1.0);
  Vec3 position(0.0), velocity(0.0), rate(0.0);
  Quaternion attitude(1.0, 0.0, 0.0, 0.0);  // body to space
  double first = 0.0;
  for (int step = 0; step < steps; ++step) {
    clray::Orientation view;
    view.time_s = kStep_s * step;
    view.body_to_space = attitude;
    view.source = turned({attitude.w, -attitude.x, -attitude.y, -attitude.z}, sun);
    const clray::Result result = prepared.trace({view});
    const clray::PressureResult& push = result.pressure.front();
    if (step == 0) first = push.coefficient_m2.value.z;
    velocity += turned(attitude, push.coefficient_m2.value) * (pressure_Pa * kStep_s / kMass_kg);
    position += velocity * kStep_s;
    rate += push.torque_coefficient_m3.value * (pressure_Pa * kStep_s / kInertia_kg_m2);
    const Quaternion turn(1.0, 0.5 * kStep_s * rate.x, 0.5 * kStep_s * rate.y, 0.5 * kStep_s * rate.z);
    attitude = normalised(attitude * turn);
  }
  const double expected = -kHalf_m2 * (2.0 + (kRho[0] + kRho[1]) * 2.0 / 3.0);
  std::printf("C_z = %.12f m2, closed form %.12f\n", first, expected);
  std::printf("after %d steps: moved by (%.6f, %.6f, %.6f) m, turned by %.6f rad about y\n", steps, position.x,
              position.y, position.z, 2.0 * std::atan2(attitude.y, attitude.w));
  return std::fabs(first / expected - 1.0) < 1e-12 ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    return run(count > 1 ? arguments[1] : "cpu", count > 2 ? std::stoi(arguments[2]) : 20);
  } catch (const clray::Error& error) {
    std::fprintf(stderr, "propagator: %s\n", error.what());
    return static_cast<int>(error.code());
  }
}
