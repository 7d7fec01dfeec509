// SPDX-License-Identifier: Apache-2.0
// Saved sums through the program: killed at any moment and resumed, shared, merged and verified, with one run's digest.
#include <doctest/doctest.h>
#include <poll.h>

#include <nlohmann/json.hpp>
#include <random>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

const std::vector<std::string> kRun{"--device", "cpu", "--method", "points", "--no-plots", "--quiet", "square.obj"};

std::vector<std::string> with(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::string digest(const Scratch& scratch, const std::string& folder) {
  return nlohmann::json::parse(slurp(scratch / (folder + "/summary.json")))["digest"];
}

}  // namespace

TEST_CASE("killed at random moments and resumed each time, a run ends with the digest of an unbroken one") {
  std::mt19937 random(9);
  const bool all = ::getenv("CLRAY_LONG_TESTS") != nullptr;
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  // Tilted, so that the outline is met by chance; longer than what lies between two kills.
  const std::vector<std::string> options{"--source", "1,0.3,2", "--rays", all ? "2^26" : "2^24"};
  REQUIRE(clray(scratch, with(kRun, with(options, {"--out", "whole"}))).status == 0);
  CHECK_FALSE(scratch.has("whole.sums"));
  int kills = 0, finished = 0;
  std::uintmax_t torn = 0;
  std::vector<std::string> words = with(kRun, with(options, {"--out", "out", "--checkpoint", "100ms"}));
  while (kills < (all ? 100 : 4)) {
    const Running running(scratch, words);
    ::poll(nullptr, 0, 200 + static_cast<int>(random() % 1500));
    running.send(SIGKILL);
    const auto outcome = running.wait();
    CAPTURE(outcome.err);
    if (outcome.status != 0) {
      REQUIRE(outcome.status == 128 + SIGKILL);
      ++kills;
      torn += scratch.has("out/summary.json") && !scratch.has("out/delay.csv");
      if (scratch.has("out.sums")) words = {"--resume", "out/"};
      continue;
    }
    ++finished;
    CHECK(digest(scratch, "out") == digest(scratch, "whole"));
    CHECK_FALSE(scratch.has("out.sums"));
    words = with(kRun, with(options, {"--out", "out", "--checkpoint", "100ms"}));
  }
  if (scratch.has("out.sums")) {
    const auto outcome = clray(scratch, {"--resume", "out"});
    CAPTURE(outcome.err);
    CHECK(outcome.status == 0);
    CHECK(digest(scratch, "out") == digest(scratch, "whole"));
  }
  CHECK(torn == 0);
  CHECK_FALSE(scratch.has("out.sums"));
  MESSAGE(kills << " kills, " << finished << " runs finished between them");
}

TEST_CASE("an interrupted run is resumed, from another folder, too, and its options stay") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const Running running(scratch,
                        with(kRun, {"--rays", "2^36", "--seed", "5", "--out", "out", "--checkpoint", "100ms"}));
  for (int k = 0; k < 200 && !scratch.has("out.sums"); ++k) ::poll(nullptr, 0, 100);
  running.send(SIGINT);
  const auto cut = running.wait();
  CAPTURE(cut.err);
  CHECK(cut.status == 128 + SIGINT);
  REQUIRE(scratch.has("out.sums"));
  CHECK(contains(cut.err, "clray --resume goes on"));
  std::filesystem::create_directory(scratch / "elsewhere");
  const auto rays = nlohmann::json::parse(slurp(scratch / "out/summary.json"))["rays"].get<std::uint64_t>();
  // It has gone at most to twice the points that it has finished.
  const std::string more = std::to_string(4 * rays);
  const auto outcome = clray(scratch, {"--resume", scratch / "out", "--rays", more, "--out", "elsewhere/out"});
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  REQUIRE(clray(scratch, with(kRun, {"--rays", more, "--seed", "5", "--out", "whole"})).status == 0);
  CHECK(digest(scratch, "elsewhere/out") == digest(scratch, "whole"));
}

TEST_CASE("shares are merged to the digest of one run, which verify confirms") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const std::vector<std::string> run = with(kRun, {"--rays", "32768", "--source", "1,0.3,2"});
  REQUIRE(clray(scratch, with(run, {"--out", "whole"})).status == 0);
  for (const std::string number : {"1", "2", "3"}) {
    const auto share = clray(scratch, with(run, {"--shard", number + "/3", "--out", "parts/" + number}));
    CAPTURE(share.err);
    CHECK(share.status == 0);
    CHECK(contains(share.out, "share " + number + " of 3: its sums are in parts/" + number + ".sums"));
    CHECK_FALSE(scratch.has("parts/" + number));
  }
  const auto missing = clray(scratch, {"merge", "parts/1", "parts/3.sums", "--out", "all"});
  CHECK(missing.status == 2);
  CHECK(contains(missing.err, "share 2 of 3 is missing"));
  const auto merged = clray(scratch, {"merge", "parts/3", "parts/2/", "parts/1.sums", "--out", "all", "--keep-sums"});
  CAPTURE(merged.err);
  REQUIRE(merged.status == 0);
  CHECK(digest(scratch, "all") == digest(scratch, "whole"));
  const auto verified = clray(scratch, {"verify", "all"});
  CAPTURE(verified.err);
  CHECK(verified.status == 0);
  CHECK(contains(verified.out, "the same: 2 of 16 ranges were computed again"));
  REQUIRE(clray(scratch, {"verify", "parts/2"}).status == 0);
  // On another machine the scene stands elsewhere.
  const Scratch other;
  std::filesystem::rename(scratch / "parts", other / "parts");
  std::filesystem::rename(scratch / "square.obj", other / "square.obj");
  const auto moved = clray(other, {"merge", "parts/1", "parts/2", "parts/3", "--out", "all"});
  CAPTURE(moved.err);
  REQUIRE(moved.status == 0);
  CHECK(digest(other, "all") == digest(scratch, "whole"));
  spit(other / "square.obj", "v 0 0 0\nv 1 0 0\nv 1 2 0\nf 1 2 3\n");
  CHECK(clray(other, {"merge", "parts/1", "parts/2", "parts/3", "--out", "else"}).status == 2);
}

TEST_CASE("what is no file of sums is neither replaced nor read") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  spit(scratch / "out.sums", "my sums: 1 + 1 = 2\n");
  const auto replaced = clray(scratch, with(kRun, {"--rays", "4096", "--out", "out"}));
  CHECK(replaced.status == 5);
  CHECK(contains(replaced.err, "it holds no sums of clray"));
  CHECK(slurp(scratch / "out.sums") == "my sums: 1 + 1 = 2\n");
  const auto read = clray(scratch, {"--resume", "out"});
  CHECK(read.status == 3);
  CHECK(contains(read.err, "out.sums: these are no sums of clray"));
  CHECK(clray(scratch, {"--resume", "nothing"}).status == 3);
  CHECK(clray(scratch, {"merge", "--out", "all"}).status == 2);
  CHECK(clray(scratch, {"merge", "a", "b"}).status == 2);
  CHECK(clray(scratch, {"verify"}).status == 2);
  const auto share = clray(scratch, with(kRun, {"--shard", "4/3"}));
  CHECK(share.status == 2);
  CHECK(contains(share.err, "expected a share i/n such as 3/8"));
}
