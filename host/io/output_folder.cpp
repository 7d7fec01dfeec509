// SPDX-License-Identifier: Apache-2.0
// A result's folder that appears whole or not at all; see output_folder.hpp. POSIX rename semantics; an existing
// folder is swapped with Linux's renameat2(RENAME_EXCHANGE), or by two renames where the file system lacks it.
#include "io/output_folder.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "clray/error.hpp"
#include "clray/result.hpp"
#include "clray/write.hpp"
#include "text/input_file.hpp"
#include "text/output_file.hpp"
#include "text/text.hpp"

namespace clray::io {

using namespace text;

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& target, const std::string& why) {
  throw Error(ErrorCode::output,
              "will not replace " + shown(target.string()) + ": " + why + "; choose another --out or move it away");
}

/// The summary of the result at `target`; discarded where there is none.
nlohmann::json summary_of(const fs::path& target) {
  return nlohmann::json::parse(read_input_file((target / "summary.json").string()), nullptr, false);
}

/// Names that a result says it wrote. A name with a slash would lead out of the folder, so it is none.
std::set<std::string> files_of_result(const nlohmann::json& summary) {
  std::set<std::string> names{"summary.json"};
  const auto files = summary.find("files");
  if (files == summary.end() || !files->is_array()) return names;
  for (const auto& name : *files) {
    if (name.is_string() && name.get<std::string>().find('/') == std::string::npos)
      names.insert(name.get<std::string>());
  }
  return names;
}

/// Where a result goes that must not replace the one at `target`.
std::string beside(const fs::path& target) {
  return target.string() + ".partial";
}

/// Removes a result that was replaced: the files that it says it wrote, and the folder if nothing else is in it.
void remove_result(const fs::path& folder) noexcept {
  try {
    const auto summary = summary_of(folder);
    if (!summary.is_object()) return;
    for (const std::string& name : files_of_result(summary)) {
      if (name != "summary.json") ::unlink((folder / name).c_str());
    }
    ::unlink((folder / "summary.json").c_str());
  } catch (const std::exception&) {
    // An empty folder was replaced, or it cannot be read.
  }
  ::rmdir(folder.c_str());
}

/// Throws unless `target` is absent, an empty folder, or a result of clray and nothing more.
void check_replaceable(const fs::path& target) {
  std::error_code error;
  const auto status = fs::status(target, error);
  if (status.type() == fs::file_type::not_found) return;
  if (error) fail_output("look at", target, error.value());
  if (!fs::is_directory(status)) refuse(target, "it is a file, not a folder");
  fs::directory_iterator entries(target, error);
  if (error) fail_output("read the folder", target, error.value());
  if (entries == fs::directory_iterator{}) return;
  if (!fs::is_regular_file(target / "summary.json", error))
    refuse(target, "it is not a result of clray (no summary.json)");
  const auto summary = summary_of(target);
  if (!summary.is_object() || !summary.contains("clray")) refuse(target, "its summary.json is not of clray");
  const auto known = files_of_result(summary);
  for (const auto& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (known.count(name) == 0 || fs::is_directory(entry.symlink_status()))
      refuse(target, "it holds '" + shown(name) + "', which clray did not write");
  }
}

/// Throws where the system would not let us put another folder in place of `target`, though it may be a result.
void check_movable(const fs::path& target) {
  struct statx folder {
  }, parent{};
  if (::statx(AT_FDCWD, target.c_str(), 0, STATX_BASIC_STATS, &folder) != 0 || !S_ISDIR(folder.stx_mode)) return;
  if (::statx(AT_FDCWD, target.parent_path().c_str(), 0, STATX_BASIC_STATS, &parent) != 0) return;
  const bool other_disk = folder.stx_dev_major != parent.stx_dev_major || folder.stx_dev_minor != parent.stx_dev_minor;
  if (other_disk || (folder.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0)
    refuse(target, "a file system is mounted there");
  std::error_code error;
  for (fs::path here = fs::current_path(error); !error && !here.empty(); here = here.parent_path()) {
    if (fs::equivalent(here, target, error)) refuse(target, "it is the current folder, or holds it");
    if (here == here.parent_path()) break;
  }
  const uid_t user = ::geteuid();
  const bool sticky = (parent.stx_mode & S_ISVTX) != 0;
  if (user != 0 && sticky && folder.stx_uid != user && parent.stx_uid != user)
    refuse(target, "it belongs to somebody else, in a folder where only owners may move what is theirs");
  if (::faccessat(AT_FDCWD, target.c_str(), R_OK | W_OK | X_OK, AT_EACCESS) != 0)
    refuse(target, std::string("its files could not be removed (") + std::strerror(errno) + ")");
}

/// The absolute path without a trailing slash; a symbolic link is followed.
fs::path resolve(const std::string& target) {
  if (target.empty()) throw Error(ErrorCode::output, "the output folder has an empty name");
  std::error_code error;
  fs::path path = fs::absolute(target, error).lexically_normal();
  if (error) fail_output("find", target, error.value());
  if (path.filename().empty()) path = path.parent_path();
  // Link by link, since a link may lead to a folder that is yet to be made.
  for (int links = 0; fs::is_symlink(fs::symlink_status(path, error)); ++links) {
    if (links == 40) fail_output("follow the link", target, ELOOP);
    const fs::path next = fs::read_symlink(path, error);
    if (error) fail_output("follow the link", target, error.value());
    path = (path.parent_path() / next).lexically_normal();
    if (path.filename().empty()) path = path.parent_path();
  }
  return path;
}

/// Puts `temporary` at `target`. What stood there is then at `temporary`. Returns an errno or 0.
int exchange(const fs::path& temporary, const fs::path& target) {
  const auto lock = hold_temporaries();
  if (::rename(temporary.c_str(), target.c_str()) == 0) return 0;
  if (errno != ENOTEMPTY && errno != EEXIST) return errno;
  if (::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS && errno != ENOTSUP) return errno;
  const fs::path old = temporary.string() + ".old";
  if (::rename(target.c_str(), old.c_str()) != 0) return errno;
  if (::rename(temporary.c_str(), target.c_str()) != 0) {
    const int code = errno;
    ::rename(old.c_str(), target.c_str());
    return code;
  }
  ::rename(old.c_str(), temporary.c_str());
  return 0;
}

}  // namespace

OutputFolder::OutputFolder(const std::string& target) : target_(resolve(target)) {
  check_movable(target_);
  check_replaceable(target_);
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path parent = target_.parent_path(); !parent.empty() && !fs::exists(parent, error);
       parent = parent.parent_path()) {
    missing.push_back(parent);
  }
  for (auto parent = missing.rbegin(); parent != missing.rend(); ++parent) {
    if (::mkdir(parent->c_str(), 0777) == 0) {
      made_parents_.push_back(*parent);
    } else if (errno != EEXIST) {
      const int code = errno;
      remove_leftovers();
      fail_output("make the folder", *parent, code);
    }
  }
  remove_unfinished(target_.string());
  if (const int code = unfinished_.make(target_.string(), Unfinished::Kind::folder)) {
    remove_leftovers();
    fail_output("write in the folder", target_.parent_path(), code);
  }
}

OutputFolder::~OutputFolder() {
  remove_leftovers();
}

void OutputFolder::remove_leftovers() noexcept {
  if (kept_) return;
  if (done_) {
    remove_result(folder());
    return;
  }
  std::error_code ignored;
  if (!folder().empty()) fs::remove_all(folder(), ignored);
  for (auto parent = made_parents_.rbegin(); parent != made_parents_.rend(); ++parent) ::rmdir(parent->c_str());
  made_parents_.clear();
}

std::string OutputFolder::keep() noexcept {
  std::error_code error;
  const std::string& here = folder();
  if (here.empty() || fs::is_empty(here, error) || error) return {};
  kept_ = true;
  unfinished_.forget();
  // Under its present name the next run would remove it.
  const std::string kept = target_.string() + ".unfinished" + here.substr(here.size() - 9);
  return ::rename(here.c_str(), kept.c_str()) == 0 ? kept : here;
}

void OutputFolder::commit() {
  for (const auto& entry : fs::directory_iterator(folder())) sync_to_disk(entry.path());
  sync_to_disk(folder());
  check_replaceable(target_);  // it may have changed while we traced
  if (const int code = io::exchange(folder(), target_)) fail_output("put the result at", target_, code);
  done_ = true;
  unfinished_.forget();  // what stands there now is the older result
  sync_to_disk(target_.parent_path());
}

}  // namespace clray::io

namespace clray {

void check_output(const std::string& folder) {
  io::OutputFolder probe(folder);
  std::error_code error;
  const std::filesystem::path target = io::resolve(folder);
  if (std::filesystem::exists(target / "summary.json", error)) io::OutputFolder other(io::beside(target));
}

std::string result_folder(const Result& result, const std::string& folder) {
  if (!result.partial || result.stopped_by != "interrupt") return folder;
  std::error_code error;
  const std::filesystem::path target = io::resolve(folder);
  if (!std::filesystem::is_regular_file(target / "summary.json", error)) return folder;
  const auto summary = io::summary_of(target);
  if (!summary.is_object()) return folder;
  const auto partial = summary.find("partial"), rays = summary.find("rays_total");
  const bool has_no_more = partial != summary.end() && *partial == true && rays != summary.end() &&
                           rays->is_number_unsigned() && rays->get<std::uint64_t>() <= result.rays_total;
  return has_no_more ? folder : io::beside(target);
}

}  // namespace clray
