// SPDX-License-Identifier: Apache-2.0
// The arguments of --resume, merge and verify: those that a file of sums has from the command that made it, and the new
// ones over them; see arguments.hpp.
#include <algorithm>
#include <filesystem>

#include "arguments.hpp"
#include "clray/error.hpp"

namespace clray::cli {

namespace {

constexpr const char* kBreak = "\n";  // between the commands of a note: none is a word of a command

/// A file of a saved run: from the folder where it was started, or, on another machine, by the same name from here.
/// That it is the same scene is checked by its numbers.
std::string found_again(const std::string& path, const std::filesystem::path& folder) {
  const std::filesystem::path there = folder / path, here = std::filesystem::path(path).is_absolute()
                                                                ? std::filesystem::path(path).filename()
                                                                : std::filesystem::path(path);
  return (!std::filesystem::exists(there) && std::filesystem::exists(here) ? here : there).string();
}

/// The arguments of a saved run: those of its commands, one over the other.
Arguments saved_arguments(const std::string& file, const SavedRun& saved) {
  if (saved.note.empty()) throw Error(ErrorCode::input, "these sums do not say what was run", file);
  Arguments a;
  for (auto at = saved.note.begin() + 1; at != saved.note.end();) {
    const auto end = std::find(at, saved.note.end(), kBreak);
    parse_words({at, end}, &a);
    at = end == saved.note.end() ? end : end + 1;
  }
  const std::filesystem::path folder = saved.note.front();
  for (std::string* path : {&a.scene, &a.reference}) {
    if (!path->empty()) *path = found_again(*path, folder);
  }
  a.resume.clear();
  a.note = saved.note;
  return a;
}

}  // namespace

void go_on(const std::vector<std::string>& words, Arguments* arguments) {
  const Arguments own = *arguments;
  std::vector<std::string> files;
  for (const std::string& name : own.operands) files.push_back(sums_file(name));
  if (files.empty()) files.push_back(sums_file(own.resume));
  const SavedRun saved = read_saved(files.front());
  Arguments a = saved_arguments(files.front(), saved);
  a.verb = own.verb;
  std::vector<std::string> more;  // options alone
  for (const std::string& word : words) {
    if (std::find(own.operands.begin(), own.operands.end(), word) == own.operands.end()) more.push_back(word);
  }
  parse_words(more, &a);
  a.command = own.command;
  a.operands = own.operands;
  a.share = own.verb == "merge" ? Share{} : saved.share;
  if (own.verb.empty() && own.out.empty()) a.out = files.front().substr(0, files.front().size() - 5);
  a.note.push_back(kBreak);
  a.note.insert(a.note.end(), more.begin(), more.end());
  a.from = files;
  *arguments = a;
}

std::string sums_file(const std::string& folder) {
  const std::string end = ".sums";
  const bool file = folder.size() > end.size() && folder.compare(folder.size() - end.size(), end.size(), end) == 0;
  if (file) return folder;
  return folder.substr(0, folder.find_last_not_of('/') + 1) + end;
}

}  // namespace clray::cli
