// SPDX-License-Identifier: Apache-2.0
// A mesh made in memory, traced again and again under new suns: the body and its program stay on the device
// (clray::Prepared), and every call gives the bits of a run alone. Beside it all suns in one call, whose tracing time
// is what the calls are measured against. Usage: many_calls [DEVICE [CALLS [RAYS]]], such as: many_calls cpu 10000
// 16384
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "clray/device.hpp"
#include "clray/error.hpp"
#include "clray/prepared.hpp"

namespace {

/// A box with two wings of one material; lengths in m.
clray::Scene satellite(std::uint64_t rays) {
  std::vector<clray::Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto box = [&](const clray::Vec3& middle, const clray::Vec3& half) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (int k = 0; k < 8; ++k)
      vertices.push_back(middle + half * clray::Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
    const std::uint32_t faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                        {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    for (const auto& f : faces) triangles.push_back({first + f[0], first + f[1], first + f[2]});
  };
  box({0.0, 0.0, 0.0}, {0.5, 0.5, 1.0});
  box({0.0, 2.0, 0.0}, {0.02, 1.2, 0.5});
  box({0.0, -2.0, 0.0}, {0.02, 1.2, 0.5});

  clray::Scene scene;
  scene.name = "satellite";
  clray::Material paint;
  paint.name = "paint";
  paint.parameters["rho"] = 0.4;
  scene.materials.push_back(paint);
  clray::Component body;
  body.name = "body";
  body.mesh = clray::make_mesh(vertices, triangles);
  body.materials = {0};
  scene.components.push_back(body);
  scene.observers.push_back({});  // at the source
  scene.detectors.push_back({"spectrometer", "", {}});
  scene.trace.method = clray::Method::points;
  scene.trace.rays = rays;
  return scene;
}

std::vector<clray::Vec3> suns(std::size_t count) {  // spread evenly (Fibonacci's lattice)
  std::vector<clray::Vec3> all;
  for (std::size_t k = 0; k < count; ++k) {
    const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / static_cast<double>(count);
    const double r = std::sqrt(1.0 - z * z), turn = 2.399963229728653 * static_cast<double>(k);
    all.push_back({r * std::cos(turn), r * std::sin(turn), z});
  }
  return all;
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int run(const char* device_choice, std::size_t calls, std::uint64_t rays) {
  clray::Device device(device_choice);
  clray::Scene scene = satellite(rays);
  clray::Prepared body(scene, device);
  const std::vector<clray::Vec3> directions = suns(calls);

  double sum = 0.0;
  std::size_t wrong = 0;
  const double start = now();
  double checking = 0.0;
  for (std::size_t k = 0; k < calls; ++k) {
    scene.source.direction = directions[k];
    const clray::Result result = body.trace(scene);
    sum += result.spectrometer.front().intensity_m2_per_sr.value;
    if (k % 100 != 0) continue;  // some of them against a run alone
    const double begin = now();
    wrong += clray::trace(scene, device).digest != result.digest;
    checking += now() - begin;
  }
  const double each = (now() - start - checking) / static_cast<double>(calls);

  std::vector<clray::Orientation> views(calls);
  for (std::size_t k = 0; k < calls; ++k) views[k].source = directions[k];
  const clray::Result all = body.trace(views);
  double together = 0.0;
  for (const clray::SpectrometerResult& s : all.spectrometer) together += s.intensity_m2_per_sr.value;
  const double tracing = all.seconds.trace / static_cast<double>(calls);
  std::printf("%zu calls of %llu rays: %.3f ms each, %.2f times the tracing time of one call with all suns\n", calls,
              static_cast<unsigned long long>(rays), 1e3 * each, each / tracing);
  std::printf("mean A = %.9f m2/sr; in one call %.9f; %zu digests differ from runs alone\n",
              sum / static_cast<double>(calls), together / static_cast<double>(calls), wrong);
  return wrong == 0 && std::fabs(sum / together - 1.0) < 1e-3 ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    return run(count > 1 ? arguments[1] : "cpu", count > 2 ? std::stoul(arguments[2]) : 200,
               count > 3 ? std::stoul(arguments[3]) : 16384);
  } catch (const clray::Error& error) {
    std::fprintf(stderr, "many_calls: %s\n", error.what());
    return static_cast<int>(error.code());
  }
}
