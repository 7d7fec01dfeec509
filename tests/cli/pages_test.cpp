// SPDX-License-Identifier: Apache-2.0
// The pages that lead through a task are done as a reader does them: files are saved under the names that the page
// gives, commands are run in order, and every line that the page shows must be printed.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

struct Block {
  std::string language, text;
  std::string file;  ///< where the page says to save it
};

/// The blocks between fences, each with the last "Save as `…`" since the one before.
std::vector<Block> blocks_of(const std::string& page) {
  const std::string fence = "```", save = "ave as `";
  std::vector<Block> blocks;
  std::size_t from = 0;
  for (std::size_t at = page.find(fence); at != std::string::npos; at = page.find(fence, from)) {
    const std::size_t head = page.find('\n', at), end = page.find("\n" + fence, head);
    REQUIRE(end != std::string::npos);
    Block block{page.substr(at + fence.size(), head - at - fence.size()), page.substr(head + 1, end - head), ""};
    if (const std::size_t name = page.rfind(save, at); name != std::string::npos && name >= from) {
      const std::size_t begin = name + save.size();
      block.file = page.substr(begin, page.find('`', begin) - begin);
    }
    blocks.push_back(block);
    from = end + 1 + fence.size();
  }
  return blocks;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

/// A folder that looks like clray's to the commands of a page.
void furnish(const Scratch& scratch) {
  std::filesystem::create_directories(scratch / "scripts");
  spit(scratch / "scripts/clray", "#!/bin/sh\nexec '" + program() + "' \"$@\"\n");
  std::filesystem::permissions(scratch / "scripts/clray", std::filesystem::perms::owner_all);
  std::filesystem::create_directory_symlink(std::string(CLRAY_SOURCE_DIR) + "/meshes", scratch / "meshes");
}

}  // namespace

TEST_CASE("docs: every command of light-curve.md and pressure-table.md prints what the page shows") {
  for (const char* page : {"light-curve.md", "pressure-table.md"}) {
    CAPTURE(page);
    const Scratch scratch;
    furnish(scratch);
    std::string printed;
    int commands = 0, shown = 0;
    for (const Block& block : blocks_of(slurp(std::string(CLRAY_SOURCE_DIR) + "/docs/" + page))) {
      if (block.language == "sh") {
        ++commands;
        const std::string command =
            "cd '" + scratch.path.string() + "' && { " + block.text + "} > .printed 2> .complaints";
        const int status = std::system(command.c_str());
        printed = slurp(scratch / ".printed");
        INFO(block.text << printed << slurp(scratch / ".complaints"));
        CHECK(status == 0);
      } else if (block.language.empty()) {
        for (const std::string& line : lines_of(block.text)) {
          ++shown;
          INFO(printed);
          CAPTURE(line);
          CHECK(contains(printed, line));
        }
      } else {
        REQUIRE_FALSE(block.file.empty());
        std::filesystem::create_directories(std::filesystem::path(scratch / block.file).parent_path());
        spit(scratch / block.file, block.text);
      }
    }
    CHECK(commands >= 3);
    CHECK(shown >= 6);
  }
}
