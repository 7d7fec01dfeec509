// SPDX-License-Identifier: Apache-2.0
// Runs that are cut, killed, shared and checked have the bits of one run: whatever the method, the detectors and the
// stopping rule. The unbroken run is the reference.
#include "clray/saved.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "clray/error.hpp"
#include "physics/saved_cases.hpp"
#include "pipeline/saved_sums.hpp"
#include "text/output_file.hpp"

using namespace clray_test;
using clray::Method;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path;
  Folder() {
    std::string name = (fs::temp_directory_path() / "clray-saved-XXXXXX").string();
    path = ::mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
};

clray::Saving to(const std::string& file) {
  clray::Saving saving;
  saving.file = file;
  saving.every_s = 1e-9;  // whenever it can be
  return saving;
}

struct Killed {};

/// Traces with interrupts, or as if the process was killed, after random numbers of calls; returns the last result.
clray::Result broken(const clray::Scene& scene, const std::string& file, std::mt19937& random, int* breaks) {
  clray::Saving saving = to(file);
  for (int most = 1;; most += 2) {
    std::atomic<bool> stop{false};
    int left = static_cast<int>(random() % static_cast<unsigned>(most));
    const bool kill = random() % 2 == 0;
    clray::TraceHooks hooks;
    hooks.stop = &stop;
    hooks.progress = [&](const clray::Progress&) {
      if (left-- > 0) return;
      if (kill) throw Killed{};
      stop = true;
    };
    try {
      const clray::Result result = clray::trace(scene, device(), hooks, saving);
      if (!result.partial) return result;
    } catch (const Killed&) {
    }
    ++*breaks;
    saving.from.clear();
    if (fs::exists(file)) saving.from = {file};
  }
}

std::string refusal(const clray::Scene& scene, const clray::Saving& saving) {
  try {
    clray::trace(scene, device(), {}, saving);
  } catch (const clray::Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a run that is cut and killed again and again has the digest of one that is not") {
  std::mt19937 random(18);
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const clray::Result whole = run(c.scene);
    int breaks = 0;
    // A short run may end before it sees that it must stop: then it is tried again.
    for (int k = 0; k < (long_tests() ? 20 : 2) || (breaks == 0 && k < 20); ++k) {
      const Folder folder;
      const clray::Result result = broken(c.scene, folder / "sums", random, &breaks);
      CHECK(result.digest == whole.digest);
      CHECK(result.rays_total == whole.rays_total);
      CHECK(result.stopped_by == whole.stopped_by);
      CHECK(result.reached_percent == whole.reached_percent);
      REQUIRE(result.errors.size() == whole.errors.size());
      for (std::size_t e = 0; e < whole.errors.size(); ++e) CHECK(result.errors[e].rays == whole.errors[e].rays);
    }
    CHECK(breaks > 0);
  }
}

TEST_CASE("the shares of a run add up to its digest; shares that do not belong together are refused") {
  const Folder folder;
  for (const Case& c : cases()) {
    if (!c.fixed) continue;
    CAPTURE(c.name);
    const clray::Result whole = run(c.scene);
    for (const std::uint32_t of : {2u, 3u, 7u}) {
      clray::Saving merge;
      for (std::uint32_t number = of; number > 0; --number) {
        clray::Saving share = to(folder / ("share" + std::to_string(number)));
        share.keep = true;
        share.share = {number, of};
        CHECK_FALSE(clray::trace(c.scene, device(), {}, share).partial);
        merge.from.push_back(share.file);
      }
      const clray::Result result = clray::trace(c.scene, device(), {}, merge);
      CHECK(result.digest == whole.digest);
      CHECK(result.rays == whole.rays);
      std::swap(merge.from.front(), merge.from.back());
      merge.from.pop_back();
      CHECK(refusal(c.scene, merge).find("is missing") != std::string::npos);
      merge.from.push_back(merge.from.front());
      CHECK(refusal(c.scene, merge).find("and so is") != std::string::npos);
    }
  }
  const Case first = cases().front();
  clray::Saving merge;
  merge.from = {folder / "share1", folder / "share2"};  // of 7, and of a picture
  CHECK(refusal(first.scene, merge).find("belong to another scene") != std::string::npos);
  clray::Saving share = to(folder / "target");
  share.share = {1, 2};
  CHECK(refusal(cases()[1].scene, share).find("a share needs a run whose end is known") != std::string::npos);
}

TEST_CASE("a share that was cut goes on, and is not merged before") {
  const Folder folder;
  const Case c = cases().front();
  clray::Saving share = to(folder / "share1");
  share.keep = true;
  share.share = {1, 2};
  std::atomic<bool> stop{true};
  clray::TraceHooks hooks;
  hooks.stop = &stop;
  CHECK(clray::trace(c.scene, device(), hooks, share).partial);
  CHECK_FALSE(clray::read_saved(share.file).complete);
  clray::Saving other = share, merge;
  other.file = folder / "share2";
  other.share = {2, 2};
  clray::trace(c.scene, device(), {}, other);
  merge.from = {share.file, other.file};
  CHECK(refusal(c.scene, merge).find("is not finished") != std::string::npos);
  share.from = {share.file};
  CHECK_FALSE(clray::trace(c.scene, device(), {}, share).partial);
  CHECK(clray::trace(c.scene, device(), {}, merge).digest == run(c.scene).digest);
}

TEST_CASE("a complete run goes on to more rays or a sharper target, with the digest of a run that asked for it first") {
  const Folder folder;
  for (const Case& c : cases()) {
    if (c.scene.trace.rays == 0 && c.scene.trace.target_error_percent == 0.0) continue;  // solved, or samples
    CAPTURE(c.name);
    clray::Saving saving = to(folder / "sums");
    saving.keep = true;
    clray::trace(c.scene, device(), {}, saving);
    saving.from = {saving.file};
    clray::Scene more = c.scene;
    more.trace.rays *= 4;
    more.trace.target_error_percent /= 3.0;
    const clray::Result result = clray::trace(more, device(), {}, saving);
    CHECK(result.digest == run(more).digest);
    if (c.fixed && c.scene.trace.method == Method::points)
      CHECK(refusal(c.scene, saving).find("has gone further") != std::string::npos);
  }
}

TEST_CASE("sums of another scene, seed or method are refused") {
  const Folder folder;
  const clray::Scene scene = cases().front().scene;
  clray::Saving saving = to(folder / "sums");
  saving.keep = true;
  clray::trace(scene, device(), {}, saving);
  saving.from = {saving.file};
  CHECK(refusal(scene, saving).empty());
  clray::Scene other = scene;
  other.trace.seed = 2;
  CHECK(refusal(other, saving).find("another scene") != std::string::npos);
  other = scene;
  other.materials[0].parameters["rho"] = 0.41;
  CHECK(refusal(other, saving).find("another scene") != std::string::npos);
  other = scene;
  other.trace.method = Method::exact;
  other.trace.rays = 0;
  CHECK(refusal(other, saving).find("another scene") != std::string::npos);
}

TEST_CASE("verify finds the same bits, and any number that is not") {
  const Folder folder;
  std::mt19937_64 random(5);
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    clray::Saving saving = to(folder / "sums");
    saving.keep = true;
    clray::trace(c.scene, device(), {}, saving);
    const clray::Verified tenth = clray::verify(c.scene, device(), saving.file, 0.1, random());
    CHECK(tenth.different.empty());
    CHECK(tenth.recomputed >= 1);
    CHECK(tenth.recomputed <= tenth.ranges);
    CHECK(tenth.numbers > 0);
    const clray::Verified all = clray::verify(c.scene, device(), saving.file, 1.0, random());
    CHECK(all.different.empty());
    CHECK(all.recomputed == all.ranges);
    std::ifstream in(saving.file, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    clray::SavedSums sums = clray::from_bytes(bytes, "sums");
    clray::Sums& found = sums.passes.back().found;
    found.values.add(random() % found.values.size(), 1);
    clray::text::write_output_file(saving.file, clray::to_bytes(sums));
    CHECK_FALSE(clray::verify(c.scene, device(), saving.file, 1.0, random()).different.empty());
  }
}
