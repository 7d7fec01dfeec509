// SPDX-License-Identifier: Apache-2.0
// The scenes that README and docs/how-to.md show are understood by clray as they stand, beside the meshes' files.
#include <doctest/doctest.h>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

/// The blocks ```toml … ``` of a document.
std::vector<std::string> scenes_of(const std::string& document) {
  const std::string text = slurp(std::string(CLRAY_SOURCE_DIR) + "/" + document), open = "```toml\n", close = "\n```";
  std::vector<std::string> scenes;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    at += open.size();
    scenes.push_back(text.substr(at, text.find(close, at) + 1 - at));
  }
  return scenes;
}

/// Runs meshes/make-pass; its exit status.
int make_pass(const std::string& folder) {
  return std::system((std::string(CLRAY_SOURCE_DIR) + "/meshes/make-pass '" + folder + "' > /dev/null").c_str());
}

}  // namespace

TEST_CASE("docs: the scenes of README and of docs/how-to.md are understood") {
  const Scratch scratch;
  REQUIRE(make_pass(scratch.path.string()) == 0);  // box_wing.obj and .mtl, and what a pass needs
  for (const auto& one : {std::pair<const char*, std::size_t>{"README.md", 1}, {"docs/how-to.md", 4}}) {
    const auto& document = one.first;
    const auto& least = one.second;
    const std::vector<std::string> scenes = scenes_of(document);
    CHECK(scenes.size() >= least);
    for (const std::string& scene : scenes) {
      spit(scratch / "scene.toml", scene);
      const Outcome outcome = clray(scratch, {"--check", "scene.toml"});
      INFO(document << ":\n" << scene << outcome.err);
      CHECK(outcome.status == 0);
    }
  }
}

TEST_CASE("docs: a pass from the script to its files, as docs/how-to.md tells it") {
  const Scratch scratch;
  REQUIRE(make_pass(scratch / "my-pass") == 0);
  const std::string told = slurp(std::string(CLRAY_SOURCE_DIR) + "/docs/how-to.md");
  const Outcome check = clray(scratch, {"--check", "my-pass/pass.toml"});
  CHECK(check.status == 0);
  // The lines of the document that say what a pass will be.
  for (const char* begin : {"  instants ", "  station HERL: elevation", "  station HERL: range"}) {
    const std::size_t at = told.find(begin);
    REQUIRE(at != std::string::npos);
    const std::string line = told.substr(at, told.find('\n', at) - at);
    INFO(check.out);
    CHECK(check.out.find(line) != std::string::npos);
  }
  const Outcome run = clray(scratch, {"--device", "cpu", "--rays", "4096", "--out", "out", "my-pass/pass.toml"});
  INFO(run.err);
  CHECK(run.status == 0);
  for (const char* file :
       {"pass.csv", "delay.csv", "delay.png", "observations.csv", "observations.crd", "observations.png"})
    CHECK(scratch.has(std::string("out/") + file));
  // As many traced instants as --check says, and as the table marks.
  const std::string table = slurp(scratch / "out/pass.csv");
  std::size_t hidden = 0;
  for (std::size_t at = table.find("below min_elevation_deg"); at != std::string::npos;
       at = table.find("below min_elevation_deg", at + 1))
    ++hidden;
  CHECK(check.out.find(std::to_string(hidden) + " below min_elevation_deg") != std::string::npos);
  CHECK(slurp(scratch / "out/summary.json").find("\"pass\": {") != std::string::npos);
  CHECK(slurp(scratch / "out/observations.crd").find("H5 1 26 112500 CLR ") != std::string::npos);
}
