// SPDX-License-Identifier: Apache-2.0
// What runs take of memory: large sums are nowhere twice, --memory expects no less than is taken, and a long run takes
// no more at its end than at its beginning.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

constexpr const char* kTilted = R"(length_unit = "m"
[[material]]
name = "surface"
model = "ashikhmin-shirley"
rho = 0.5
d = 0.8
n = 50
[[component]]
name = "plate"
shape = "mesh"
file = "square.obj"
material = "surface"
)";

std::string pulse() {
  return std::string(kTilted) +
         "[source]\nkind = \"laser\"\ndirection = [1, 0.3, 1]\nwavelength_nm = 532\n[observer]\n"
         "direction = \"source\"\n[[detector]]\nkind = \"delay\"\nbins = 1000000\n";
}

std::string cube() {
  std::string bands;
  for (int k = 0; k < 64; ++k) bands += fmt::format("[{}, {}], ", 400 + 4 * k, 404 + 4 * k);
  return std::string(kTilted) + "[source]\nkind = \"sun\"\ndirection = [1, 0.3, 1]\nbands = [" + bands +
         "]\n[observer]\ndirection = [0, 0, 1]\n[[detector]]\nkind = \"hyperspectral\"\nwidth = 256\nheight = 256\n";
}

/// MB that a refused run says it may take.
double expected_MB(const std::string& refusal) {
  const std::string before = "the run may take ";
  const std::string rest = refusal.substr(refusal.find(before) + before.size());
  return std::stod(rest) * (rest.compare(rest.find(' ') + 1, 2, "GB") == 0 ? 1000.0 : 1.0);
}

/// Resident memory of a process, MB.
double resident_MB(pid_t process) {
  std::ifstream in(fmt::format("/proc/{}/statm", process));
  double all = 0.0, resident = 0.0;
  in >> all >> resident;
  return 1e-6 * resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

TEST_CASE("large sums are nowhere twice, and --memory expects no less than a run takes") {
  struct Large {
    const char* name;
    std::string scene;
    std::vector<std::string> more;
    double most_MB;
  };
  // 10^6 bins, 16 replicates: up to 192 MB of sums, which stay beside those of the last step, and 33 MB of results. A
  // cube of 256 x 256 x 64: up to 67 MB each of sums and results, and sums go while results come. The program and PoCL
  // take some 100 MB. The rest is room for other drivers.
  const Large runs[] = {{"10^6 bins", pulse(), {"--method", "points", "--rays", "65536"}, 520.0},
                        {"256 x 256 x 64", cube(), {}, 265.0}};
  for (const Large& run : runs) {
    CAPTURE(run.name);
    const Scratch scratch;
    spit(scratch / "square.obj", square());
    spit(scratch / "scene.toml", run.scene);
    std::vector<std::string> words{"--device", "cpu", "--no-plots", "--checkpoint", "0", "--out", "out", "scene.toml"};
    words.insert(words.end(), run.more.begin(), run.more.end());
    REQUIRE(clray(scratch, words).status == 0);  // builds the program, for which drivers take memory too
    const Outcome outcome = clray(scratch, words);
    REQUIRE(outcome.status == 0);
    words.insert(words.end(), {"--memory", "1M"});
    const Outcome refused = clray(scratch, words);
    REQUIRE(refused.status == 2);
    MESSAGE(run.name << ": " << outcome.peak_MB << " MB, expected " << expected_MB(refused.err));
    CHECK(outcome.peak_MB < run.most_MB);
    CHECK(outcome.peak_MB < expected_MB(refused.err));
  }
}

TEST_CASE("files of sums are written and read in parts") {
  // The file has 188 MB. A run with it takes what one without takes, see above; whole in memory, it took that to 700
  // MB.
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  spit(scratch / "scene.toml", pulse());
  const std::vector<std::string> words{"--device", "cpu",   "--no-plots", "--checkpoint", "0",      "--method",
                                       "points",   "--out", "out",        "--keep-sums",  "--rays", "65536"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    return clray(scratch, all);
  };
  REQUIRE(with({"scene.toml"}).status == 0);
  const Outcome written = with({"scene.toml"});
  REQUIRE(written.status == 0);
  REQUIRE(std::filesystem::file_size(scratch / "out.sums") > 150'000'000);
  const Outcome read = with({"--resume", "out"});
  REQUIRE(read.status == 0);
  MESSAGE("written: " << written.peak_MB << " MB, read: " << read.peak_MB << " MB");
  CHECK(written.peak_MB < 520.0);
  CHECK(read.peak_MB < 520.0);
}

TEST_CASE("memory is flat while a run goes on") {
  // 20 minutes with --long; files of sums are written. After half of the time everything has its place: in 20 minutes
  // 0.5 % were added behind the first tenth, and 2 % are allowed.
  const double seconds = ::getenv("CLRAY_LONG_TESTS") != nullptr ? 1200.0 : 10.0;
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  std::vector<std::string> words{"--device", "cpu",          "--no-plots",
                                 "--method", "points",       "--max-bounces",
                                 "3",        "--checkpoint", fmt::format("{}s", seconds / 40.0),
                                 "--out",    "out",          "square.obj"};
  words.insert(words.end(), {"--time-limit", "1s"});
  REQUIRE(clray(scratch, words).status == 0);  // compilers take memory for a while
  words.back() = fmt::format("{}s", seconds);
  const Running run(scratch, words);
  std::vector<double> samples;
  while (run.alive()) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds / 120.0));
    samples.push_back(resident_MB(run.id()));
  }
  REQUIRE(run.wait().status == 0);
  REQUIRE(samples.size() > 100);
  const auto half = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  const double early = *std::max_element(samples.begin(), half), late = *std::max_element(half, samples.end());
  MESSAGE(early << " MB in the first half of " << seconds << " s, at most " << late << " MB in the second");
  CHECK(late < 1.02 * early);
}
