// SPDX-License-Identifier: Apache-2.0
// Signals to the program and to its process group, as Ctrl-C in a terminal sends them: at any moment, compilation
// included, a run ends with 128 + signal, its result is whole, partial or absent, and nothing else stays behind.
#include <doctest/doctest.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <random>

#include "cli/program.hpp"

using namespace cli_test;
namespace fs = std::filesystem;

namespace {

const std::vector<std::string> kEndless{"--device",     "cpu", "--rays",     "2^36",       "--method", "points",
                                        "--checkpoint", "1",   "--no-plots", "square.obj", "--out",    "out"};

nlohmann::json summary(const Scratch& scratch, const std::string& folder) {
  return nlohmann::json::parse(slurp(scratch / (folder + "/summary.json")));
}

void wait_ms(int ms) {
  ::poll(nullptr, 0, ms);
}

/// Entries of a folder, sorted.
std::vector<std::string> entries(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

TEST_CASE("a signal to the process group at any moment: 128 + signal, a whole partial result or none, nothing else") {
  std::mt19937 random(18);
  const int moments = ::getenv("CLRAY_LONG_TESTS") != nullptr ? 100 : 5;
  int saved = 0;
  for (int k = 0; k < moments; ++k) {
    const Scratch scratch;
    spit(scratch / "square.obj", square());
    fs::create_directory(scratch / "tmp");
    std::vector<std::string> environment{"TMPDIR=" + (scratch / "tmp")};
    // With a fresh cache the driver compiles and starts a linker, which is in the group, too.
    if (k % 2 == 0) environment.push_back("POCL_CACHE_DIR=" + (scratch / "kernels"));
    const Running running(scratch, kEndless, environment);
    const int ms = static_cast<int>(random() % 6000);
    wait_ms(ms);
    const int signal = k % 3 == 2 ? SIGTERM : k % 3 == 1 ? SIGHUP : SIGINT;
    running.send_to_group(signal);
    const auto outcome = running.wait();
    CAPTURE(k);
    CAPTURE(ms);
    CAPTURE(outcome.err);
    CHECK(outcome.status == 128 + signal);
    CHECK(entries(scratch / "tmp").empty());
    for (const std::string& name : entries(scratch.path))
      CHECK_MESSAGE((name == "square.obj" || name == "tmp" || name == "kernels" || name == ".out" || name == ".err" ||
                     name == "out" || name == "out.sums"),
                    name);
    if (!scratch.has("out")) continue;
    ++saved;
    const auto result = summary(scratch, "out");
    CHECK(result["partial"] == true);
    CHECK(result["stopped_by"] == "interrupt");
    for (const auto& file : result["files"]) CHECK(scratch.has("out/" + file.get<std::string>()));
  }
  MESSAGE(saved << " of " << moments << " had something to save");
}

TEST_CASE("tiles of one view end within moments of a signal") {
  if (::getenv("CLRAY_LONG_TESTS") == nullptr) return;  // half a minute of both cores
  const Scratch scratch;
  spit(scratch / "square.obj", square() + "v 0.2 0.2 0.3\nv 0.9 0.3 0.4\nv 0.4 0.8 0.2\nf -3 -2 -1\n");
  const Running running(scratch, {"--device", "cpu", "--method", "tiles", "--target-error", "1e-9", "--no-plots",
                                  "square.obj", "--out", "out"});
  wait_ms(23000);  // steps take many seconds by now
  const auto start = std::chrono::steady_clock::now();
  running.send(SIGTERM);
  const auto outcome = running.wait();
  CAPTURE(outcome.err);
  CHECK(outcome.status == 128 + SIGTERM);
  // A slice takes 0.15 s. The rest is for a busy machine, and for the memory of a million tiles to be given back.
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < 5.0);
}

TEST_CASE("a second signal ends at once, and leaves nothing behind") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const Running running(scratch, kEndless);
  REQUIRE(has_found_something(scratch));
  running.send(SIGTERM);
  running.send(SIGINT);
  const auto outcome = running.wait();
  CAPTURE(outcome.err);
  CHECK((outcome.status == 128 + SIGINT || outcome.status == 128 + SIGTERM));
  for (const std::string& name : entries(scratch.path)) CHECK_MESSAGE(name.rfind(".out.", 0) != 0, name);
}

TEST_CASE("an interrupted rerun leaves the complete older result, and says where its own is") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  REQUIRE(clray(scratch, {"--device", "cpu", "--rays", "16384", "--no-plots", "square.obj", "--out", "out"}).status ==
          0);
  const auto before = summary(scratch, "out");
  for (int k = 0; k < 2; ++k) {
    const Running running(scratch, kEndless);
    REQUIRE(has_found_something(scratch));
    running.send(SIGHUP);
    const auto outcome = running.wait();
    CAPTURE(outcome.err);
    CHECK(outcome.status == 128 + SIGHUP);
    CHECK(contains(outcome.err, "the older result is kept"));
    CHECK(contains(outcome.err, "out.partial"));
    CHECK(summary(scratch, "out") == before);
    CHECK(summary(scratch, "out.partial")["partial"] == true);
  }
}

TEST_CASE("a signal that was ignored at the start stays so") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  ::signal(SIGHUP, SIG_IGN);
  const Running running(
      scratch, {"--device", "cpu", "--rays", "2^22", "--method", "points", "--no-plots", "square.obj", "--out", "out"},
      {"POCL_CACHE_DIR=" + (scratch / "kernels")});  // the driver's compiler runs, too
  ::signal(SIGHUP, SIG_DFL);
  for (int k = 0; k < 60; ++k) {
    running.send(SIGHUP);
    wait_ms(50);
  }
  const auto outcome = running.wait();
  CAPTURE(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(scratch.has("out/summary.json"));
}
