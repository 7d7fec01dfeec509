// SPDX-License-Identifier: Apache-2.0
// Names of the files of one folder, made of what users call their observers, variants, bands and detectors. Different
// things get different names, also where a file system ignores case.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clray::text {

/// Part of a file name: letters, digits, '.', '_', '-' and UTF-8 are kept, the rest becomes '_'; at most 48 bytes,
/// never empty, no leading dot.
std::string file_name_part(std::string_view text);

/// The names taken in one folder.
class FileNames {
 public:
  /// Reserves a stem, so that stem() will not return it: that of a file with a fixed name.
  void reserve(std::string_view stem);

  /// "part-part-…" with each part as file_name_part() makes it. The same parts of the same `kind` always get the same
  /// stem, all others another one (then ending in "-2", "-3", …).
  std::string stem(const std::vector<std::string>& parts, const std::string& kind = {});

  /// "stem.extension", or "stem-2.extension" and so on where that is taken; takes the name and returns it.
  std::string file(const std::string& stem, const std::string& extension);

  /// Gives a name back.
  void release(std::string_view name);

 private:
  std::map<std::pair<std::string, std::vector<std::string>>, std::string> stems_;
  std::set<std::string> taken_stems_, taken_files_;  // with the case folded
};

}  // namespace clray::text
