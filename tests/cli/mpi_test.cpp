// SPDX-License-Identifier: Apache-2.0
// The program as an MPI job: one digest for any number of ranks and any mix of devices; a job that loses a rank at any
// moment leaves sums from which any other number of ranks goes on.
#include <doctest/doctest.h>
#include <poll.h>

#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "cli/program.hpp"

using namespace cli_test;

TEST_CASE("without MPI, processes that mpirun has started refuse to trace the same run each") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
#ifndef CLRAY_MPIRUN
  const auto outcome = clray(scratch, {"square.obj"}, {"OMPI_COMM_WORLD_SIZE=2"});
  CHECK(outcome.status == 2);
  CHECK(contains(outcome.err, "this clray was built without MPI"));
#else
  CHECK(clray(scratch, {"--check", "square.obj"}, {"OMPI_COMM_WORLD_LOCAL_SIZE=2"}).status == 0);
#endif
}

#ifdef CLRAY_MPIRUN
namespace {

const std::vector<std::string> kRoot{"OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"};

/// A small run.
std::vector<std::string> traced(const std::string& device, const std::vector<std::string>& more) {
  std::vector<std::string> words{"--device", device, "--no-plots", "--source", "1,0.3,2"};
  words.insert(words.end(), more.begin(), more.end());
  words.push_back("square.obj");
  return words;
}

struct Job : Running {
  Job(const Scratch& scratch, int ranks, const std::vector<std::string>& arguments,
      const std::vector<std::string>& environment = {})
      : Running(scratch, arguments, joined(environment),
                {CLRAY_MPIRUN, "--oversubscribe", "-n", std::to_string(ranks)}) {}

  static std::vector<std::string> joined(std::vector<std::string> environment) {
    environment.insert(environment.end(), kRoot.begin(), kRoot.end());
    return environment;
  }
  /// The ranks that are running.
  std::vector<pid_t> ranks() const {
    const std::string id = std::to_string(this->id());
    std::istringstream in(slurp("/proc/" + id + "/task/" + id + "/children"));
    return {std::istream_iterator<pid_t>(in), {}};
  }
};

std::string digest(const Scratch& scratch, const std::string& folder) {
  return nlohmann::json::parse(slurp(scratch / (folder + "/summary.json")))["digest"];
}

bool all() {
  return ::getenv("CLRAY_LONG_TESTS") != nullptr;
}

}  // namespace

TEST_CASE("1 to 4 ranks have one digest, on unlike devices, too, and rank 0 alone writes and speaks") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const std::vector<std::vector<std::string>> ways{{"--method", "points", "--rays", all() ? "2^22" : "2^19"},
                                                   {"--method", "points", "--target-error", "0.3"},
                                                   {"--method", "exact"},
                                                   {"--method", "tiles", "--target-error", "0.01"}};
  for (std::size_t way = 0; way < (all() ? ways.size() : 1); ++way) {
    std::vector<std::string> words = ways[way];
    words.insert(words.end(), {"--out", "whole"});
    REQUIRE(clray(scratch, traced("cpu", words)).status == 0);
    words.back() = "out";
    for (int ranks = 1; ranks <= 4; ++ranks) {
      if (!all() && ranks != 2) continue;
      CAPTURE(ranks);
      std::filesystem::remove_all(scratch / "out");
      const bool mixed = ranks == 2;  // each device of the node is one rank's
      const auto outcome = Job(scratch, ranks, traced(mixed ? "all" : "cpu", words),
                               {mixed ? "POCL_DEVICES=pthread basic" : "POCL_DEVICES=pthread"})
                               .wait();
      CAPTURE(outcome.err);
      REQUIRE(outcome.status == 0);
      CHECK_FALSE(contains(outcome.err, "warning"));
      CHECK(outcome.out.find("device ") == outcome.out.rfind("device "));
      if (ranks > 1) CHECK(contains(outcome.out, "shared by " + std::to_string(ranks) + " ranks; "));
      CHECK(digest(scratch, "out") == digest(scratch, "whole"));
    }
  }
}

TEST_CASE("a rank that cannot take part is left out and said; an error of rank 0 ends all with its status") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const auto bad = Job(scratch, 2, {"--device", "77", "square.obj"}).wait();
  CHECK(bad.status == 4);
  CHECK(bad.err.find("there is no device 77") == bad.err.rfind("there is no device 77"));
  if (!all()) return;
  // Of mpirun's several programs the second one has another seed.
  std::vector<std::string> words = traced("cpu", {"--method", "points", "--rays", "2^22", "--out", "out"});
  words.insert(words.end(), {":", "-n", "1", program()});
  const std::vector<std::string> other =
      traced("cpu", {"--method", "points", "--rays", "2^22", "--out", "out", "--seed", "2"});
  words.insert(words.end(), other.begin(), other.end());
  const auto outcome = Job(scratch, 1, words).wait();
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.err, "rank 1 is left out, and the others do its share: it has another scene"));
  REQUIRE(clray(scratch, traced("cpu", {"--method", "points", "--rays", "2^22", "--out", "whole"})).status == 0);
  CHECK(digest(scratch, "out") == digest(scratch, "whole"));
}

TEST_CASE("a job that loses a rank at a random moment ends, and any number of ranks resumes it to the same digest") {
  std::mt19937 random(18);
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  const std::vector<std::string> options{"--method", "points", "--rays", all() ? "2^27" : "2^22", "--out"};
  const auto start = [&](const std::string& out) {
    std::vector<std::string> words = options;
    words.insert(words.end(), {out, "--checkpoint", "100ms"});
    return traced("cpu", words);
  };
  REQUIRE(clray(scratch, start("whole")).status == 0);
  std::vector<std::string> words = start("out");
  int kills = 0, resumed = 0;
  for (int k = 0; k < 200 && kills < (all() ? 20 : 1); ++k) {
    const Job job(scratch, 2 + static_cast<int>(random() % 2), words);
    ::poll(nullptr, 0, 200 + static_cast<int>(random() % (all() ? 1200 : 300)));
    const std::vector<pid_t> ranks = job.ranks();
    if (!ranks.empty()) ::kill(ranks[random() % ranks.size()], SIGKILL);
    const auto outcome = job.wait();
    CAPTURE(outcome.err);
    if (outcome.status != 0) {
      ++kills;
      if (scratch.has("out.sums")) words = {"--resume", "out"};
      resumed += scratch.has("out.sums") ? 1 : 0;
      continue;
    }
    CHECK(digest(scratch, "out") == digest(scratch, "whole"));
    words = start("out");
  }
  CHECK(kills > 0);
  CHECK((resumed > 0 || !all()));
  const auto outcome = Job(scratch, 4, words).wait();
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  CHECK(digest(scratch, "out") == digest(scratch, "whole"));
  CHECK_FALSE(scratch.has("out.sums"));
  MESSAGE(kills << " lost ranks, after " << resumed << " of them there were sums to go on from");
}
#endif
