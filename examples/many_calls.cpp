// SPDX-License-Identifier: Apache-2.0
// A mesh made in memory, traced again and again under new suns: the body and its program stay on the device
// (clray::Prepared), and every call gives the bits of a run alone. Beside it the same suns in one call, whose tracing
// time is what the calls are measured against, in turn: after every 500 calls, so that other work beside it slows both.
// Usage: many_calls [DEVICE [CALLS [RAYS]]], such as: many_calls cpu 10000 16384
#include <algorithm>
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

struct Found {
  double calls_s = 0.0, tracing_s = 0.0;    ///< of all calls; of tracing alone where all suns are in one
  double calls_sum = 0.0, one_sum = 0.0;    ///< of A, m²/sr
  std::size_t compared = 0, different = 0;  ///< digests
};

/// Traces under each of these suns, one by one and in one call.
void trace_both(clray::Prepared* body, clray::Scene* scene, clray::Device* device, const std::vector<clray::Vec3>& suns,
                Found* found) {
  double start = now();
  std::vector<std::uint64_t> digests;
  for (const clray::Vec3& sun : suns) {
    scene->source.direction = sun;
    const clray::Result result = body->trace(*scene);
    found->calls_sum += result.spectrometer.front().intensity_m2_per_sr.value;
    digests.push_back(result.digest);
  }
  found->calls_s += now() - start;
  for (std::size_t k = 0; k < suns.size(); k += 100) {  // some of them against a run alone
    scene->source.direction = suns[k];
    ++found->compared;
    found->different += clray::trace(*scene, *device).digest != digests[k];
  }
  std::vector<clray::Orientation> views(suns.size());
  for (std::size_t k = 0; k < suns.size(); ++k) views[k].source = suns[k];
  const clray::Result all = body->trace(views);
  found->tracing_s += all.seconds.trace;
  for (const clray::SpectrometerResult& s : all.spectrometer) found->one_sum += s.intensity_m2_per_sr.value;
}

int run(const char* device_choice, std::size_t calls, std::uint64_t rays) {
  constexpr std::size_t kBlock = 500;
  clray::Device device(device_choice);
  clray::Scene scene = satellite(rays);
  clray::Prepared body(scene, device);
  const std::vector<clray::Vec3> directions = suns(calls);
  Found found;
  for (std::size_t first = 0; first < calls; first += kBlock) {
    const auto begin = directions.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = directions.begin() + static_cast<std::ptrdiff_t>(std::min(calls, first + kBlock));
    trace_both(&body, &scene, &device, {begin, end}, &found);
  }
  const auto count = static_cast<double>(calls);
  std::printf("%zu calls of %llu rays: %.3f ms each, %.2f times the tracing time of one call with all suns\n", calls,
              static_cast<unsigned long long>(rays), 1e3 * found.calls_s / count, found.calls_s / found.tracing_s);
  std::printf("mean A = %.9f m2/sr; in one call %.9f; %zu of %zu digests differ from runs alone\n",
              found.calls_sum / count, found.one_sum / count, found.different, found.compared);
  return found.different == 0 && std::fabs(found.calls_sum / found.one_sum - 1.0) < 1e-3 ? 0 : 1;
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
