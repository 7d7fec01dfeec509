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

}  // namespace

TEST_CASE("docs: the scenes of README and of docs/how-to.md are understood") {
  const Scratch scratch;
  for (const char* file : {"box_wing.obj", "box_wing.mtl"})
    spit(scratch / file, slurp(std::string(CLRAY_SOURCE_DIR) + "/meshes/" + file));
  for (const auto& [document, least] : {std::pair<const char*, std::size_t>{"README.md", 1}, {"docs/how-to.md", 4}}) {
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
