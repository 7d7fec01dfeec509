// SPDX-License-Identifier: Apache-2.0
// Devices hold the sums of some views at a time, and a run is refused before it traces where its memory is bounded too
// tightly. The run that holds all at once is the reference: no bit may differ.
#include <doctest/doctest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>

#include "clray/error.hpp"
#include "clray/prepared.hpp"
#include "clray/saved.hpp"
#include "device/device_impl.hpp"
#include "physics/saved_cases.hpp"

using namespace clray_test;

namespace {

/// While it lives, devices have room for one view.
struct OneView {
  const double before = device().impl().slab_bytes;
  OneView() { device().impl().slab_bytes = 1.0; }
  ~OneView() { device().impl().slab_bytes = before; }
};

struct Bounded {
  explicit Bounded(std::uint64_t bytes) { device().limit_memory(bytes); }
  ~Bounded() { device().limit_memory(0); }
};

/// Resident memory of this process, MB.
double resident_MB() {
  std::ifstream in("/proc/self/statm");
  double all = 0.0, resident = 0.0;
  in >> all >> resident;
  return 1e-6 * resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

TEST_CASE("a device that has room for one view at a time finds the same bits, whole, cut or shared") {
  std::string name = (std::filesystem::temp_directory_path() / "clray-memory-XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(name.data());
  for (const Case& c : cases()) {
    if (c.scene.views.size() < 2) continue;
    CAPTURE(c.name);
    const clray::Result whole = run(c.scene);
    const OneView one;
    const clray::Result parts = run(c.scene);
    CHECK(parts.digest == whole.digest);
    CHECK(parts.rays_total == whole.rays_total);
    CHECK(parts.reached_percent == whole.reached_percent);
    CHECK(parts.stopped_by == whole.stopped_by);
    REQUIRE(parts.errors.size() == whole.errors.size());
    for (std::size_t e = 0; e < whole.errors.size(); ++e) {
      CHECK(parts.errors[e].rays == whole.errors[e].rays);
      CHECK(parts.errors[e].relative_standard_error == whole.errors[e].relative_standard_error);
    }
    clray::Saving saving;
    saving.file = (folder / "sums").string();
    saving.every_s = 1e-9;
    std::filesystem::remove(saving.file);
    for (int calls = 1;; calls += 3) {
      std::atomic<bool> stop{false};
      clray::TraceHooks hooks;
      hooks.stop = &stop;
      int left = calls;
      hooks.progress = [&](const clray::Progress&) { stop = stop || left-- <= 0; };
      const clray::Result result = clray::trace(c.scene, device(), hooks, saving);
      saving.from = {saving.file};
      if (result.partial) continue;
      CHECK(result.digest == whole.digest);
      break;
    }
    if (!c.fixed) continue;
    clray::Saving merge;
    for (const std::uint32_t number : {1u, 2u}) {
      clray::Saving share;
      share.file = (folder / ("share" + std::to_string(number))).string();
      share.keep = true;
      share.share = {number, 2};
      CHECK_FALSE(clray::trace(c.scene, device(), {}, share).partial);
      merge.from.push_back(share.file);
    }
    CHECK(clray::trace(c.scene, device(), {}, merge).digest == whole.digest);
  }
  std::filesystem::remove_all(folder);
}

TEST_CASE("a run that cannot keep within its memory is refused with what takes it and what would help") {
  const Case c = cases().front();
  const clray::Result whole = run(c.scene);
  {
    const Bounded little(1000000);
    CHECK_THROWS_WITH_AS(run(c.scene), doctest::Contains("and 1 MB are allowed: "), clray::Error);
    CHECK_THROWS_WITH_AS(run(c.scene), doctest::Contains("that is the least"), clray::Error);
  }
  clray::Scene large = c.scene;
  for (auto& detector : large.detectors) {
    if (detector.kind == "delay") detector.parameters["bins"] = 1000000;
  }
  const Bounded enough(1000000000);
  CHECK(run(c.scene).digest == whole.digest);
  CHECK_THROWS_WITH_AS(run(large), doctest::Contains("fewer orientations, bins"), clray::Error);
}

TEST_CASE("memory is flat over many traces of a Prepared") {
  const int traces = long_tests() ? 20000 : 300;
  clray::Scene scene = cases().front().scene;
  scene.trace.rays = 256;
  clray::Prepared prepared(scene, device());
  for (int k = 0; k < traces / 10; ++k) prepared.trace();
  const double early = resident_MB();
  for (int k = 0; k < traces; ++k) prepared.trace();
  const double late = resident_MB();
  MESSAGE(early << " MB before " << traces << " traces, " << late << " MB after them");
  CHECK(late < early + 2.0);  // a heap's last grown part; 100 bytes a trace would show with --long
}
