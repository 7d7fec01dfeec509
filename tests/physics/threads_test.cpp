// SPDX-License-Identifier: Apache-2.0
// Scenes traced in several threads, each on a device of its own or all on one: each gives the digest that it gives
// alone.
#include <doctest/doctest.h>

#include <thread>
#include <vector>

#include "clray/error.hpp"
#include "clray/trace.hpp"
#include "support/scenes.hpp"

using namespace clray_test;

namespace {

/// Scenes of several programs: models, shapes, detectors, bounces.
clray::Scene scene_number(int i) {
  clray::Scene scene = i % 2 == 0 ? scene_of(box_mesh(1.0, 2.0, 3.0), lambert(0.5))
                                  : scene_of("sphere", {{"radius", 1.0}}, ashikhmin_shirley(0.4, 0.3, 10.0 + i));
  if (i % 3 == 1) detect(scene, "pressure");
  if (i % 3 == 2) detect(scene, "rgb", {{"width", 24.0}, {"height", 16.0}, {"samples", 4.0}});
  if (i % 4 == 3) scene.trace.max_bounces = 3;
  bistatic(scene, toward(0.3 + 0.1 * i), toward(0.9));
  return rays(scene, 12, static_cast<std::uint64_t>(i));
}

void trace_in_threads(const std::vector<clray::Device*>& devices) {
  const int count = static_cast<int>(devices.size());
  std::vector<std::uint64_t> digests(devices.size(), 0);
  std::vector<std::thread> threads;
  for (int i = 0; i < count; ++i)
    threads.emplace_back([&, i] { digests[i] = clray::trace(scene_number(i), *devices[i]).digest; });
  for (std::thread& thread : threads) thread.join();
  for (int i = 0; i < count; ++i) {
    CAPTURE(i);
    CHECK(digests[i] == run(scene_number(i)).digest);
  }
}

}  // namespace

TEST_CASE("eight threads trace eight scenes, each on a device of its own") {
  std::vector<clray::Device> own;
  for (int i = 0; i < 8; ++i) own.emplace_back(device_name());
  std::vector<clray::Device*> devices;
  for (clray::Device& d : own) devices.push_back(&d);
  trace_in_threads(devices);
}

TEST_CASE("eight threads trace eight scenes on one device, which takes them one by one") {
  clray::Device shared(device_name());
  trace_in_threads(std::vector<clray::Device*>(8, &shared));
}

TEST_CASE("tracing from a progress callback on the same device is refused, on another it works") {
  clray::Device other(device_name());
  int refused = 0, traced = 0;
  clray::TraceHooks hooks;
  hooks.progress = [&](const clray::Progress&) {
    if (traced > 0) return;
    traced = static_cast<int>(clray::trace(scene_number(0), other).rays >> 12);
    CHECK_THROWS_WITH_AS(clray::kernel_source(scene_number(0), device()), doctest::Contains("busy"), clray::Error);
    try {
      clray::trace(scene_number(0), device());
    } catch (const clray::Error& error) {
      refused += error.code() == clray::ErrorCode::usage;
    }
  };
  CHECK(clray::trace(scene_number(0), device(), hooks).rays == 1u << 12);
  CHECK(traced == 1);
  CHECK(refused == 1);
  CHECK_NOTHROW(run(scene_number(0)));  // the device is free again
}
