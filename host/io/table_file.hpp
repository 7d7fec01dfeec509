// SPDX-License-Identifier: Apache-2.0
// A CSV file that begins with '#' lines saying what it holds, in which units, of which scene, seed and digest.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "clray/result.hpp"
#include "text/output_file.hpp"

namespace clray::io {

using namespace text;

/// One table being written; errors are thrown as Error(output) at the latest by close().
class TableFile {
 public:
  TableFile(const std::string& path, const Result& result, const Scene& scene, const std::string& what,
            const std::string& units);

  /// One more '#' line; only before columns().
  void comment(std::string_view text);
  void columns(const std::vector<std::string>& names);

  TableFile& cell(double value);
  TableFile& cell(std::uint64_t value);
  TableFile& cell(std::string_view text);
  TableFile& cell(const Vec3& v) { return cell(v.x).cell(v.y).cell(v.z); }
  void end_row();
  void close();

 private:
  OutputFile file_;
  std::string row_;
};

}  // namespace clray::io
