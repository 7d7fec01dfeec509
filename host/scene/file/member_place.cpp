// SPDX-License-Identifier: Apache-2.0
// Where a member that check_scene() names ("observers[0].direction") stands in its scene file: those rules are about
// several sections, and are checked when the command line has had its word. The text is parsed again, since this
// happens once, on the way to an error.
#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>
#include <string_view>

#include "clray/error.hpp"
#include "scene/file/toml_reader.hpp"
#include "scene/scene_parts.hpp"

namespace clray {
namespace {

/// A member of a scene, and the key of the file that fills it.
struct Root {
  std::string_view member, key;
};
constexpr std::array<Root, 11> kRoots{{{"reference_point", "reference_point"},
                                       {"components", "component"},
                                       {"materials", "material"},
                                       {"variants", "variant"},
                                       {"observers", "observer"},
                                       {"detectors", "detector"},
                                       {"source", "source"},
                                       {"motion", "motion"},
                                       {"pass", "pass"},
                                       {"station", "station"},
                                       {"trace", "trace"}}};

/// A step of a member's path: its name, and its number in a list or -1.
struct Step {
  std::string key;
  int number = -1;
};

/// The steps of a member's path; none where the text is no such path.
std::vector<Step> steps_of(const std::string& member) {
  std::vector<Step> steps;
  std::istringstream path(member);
  for (std::string word; std::getline(path, word, '.');) {
    Step step;
    const std::size_t bracket = word.find('[');
    step.key = word.substr(0, bracket);
    if (bracket != std::string::npos)
      std::from_chars(word.data() + bracket + 1, word.data() + word.size(), step.number);
    if (steps.empty()) {
      const auto* const root =
          std::find_if(kRoots.begin(), kRoots.end(), [&](const Root& r) { return step.key == r.member; });
      if (root == kRoots.end()) return {};
      step.key = root->key;
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

/// The node of a step, or null.
const toml::node* below(const toml::node* node, const Step& step) {
  const toml::table* table = node->as_table();
  const toml::node* found = table != nullptr ? table->get(step.key) : nullptr;
  const toml::array* array = found != nullptr ? found->as_array() : nullptr;
  if (array == nullptr || step.number < 0) return found;
  return array->get(static_cast<std::size_t>(step.number));
}

}  // namespace

Error placed_in_file(const Error& error, const std::string& text, const std::string& path) {
  const std::vector<Step> steps = steps_of(error.context());
  if (error.code() != ErrorCode::input || steps.empty()) return error;
  const toml::table parsed = parse_toml(text, path);
  const toml::node *node = &parsed, *deepest = nullptr;
  std::string key;
  for (const Step& step : steps) {
    key += (key.empty() ? "" : ".") + step.key;
    if (node != nullptr) node = below(node, step);
    if (node != nullptr) deepest = node;
  }
  std::string place = path;
  if (deepest != nullptr) {
    const toml::source_position at = deepest->source().begin;
    place += ":" + std::to_string(at.line) + ":" + std::to_string(at.column);
  }
  return Error(error.code(), key + ": " + error.message(), place);
}

}  // namespace clray
