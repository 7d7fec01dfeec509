// SPDX-License-Identifier: Apache-2.0
// A CSV file with its '#' lines; see table_file.hpp. Quoting as RFC 4180; text cells are kept on one line.
#include "io/table_file.hpp"

#include "text/text.hpp"

namespace clray::io {

using namespace text;

TableFile::TableFile(const std::string& path, const Result& result, const Scene& scene, const std::string& what,
                     const std::string& units)
    : file_(path) {
  comment("what: " + what);
  comment("units: " + units);
  comment("scene: " + (scene.path.empty() ? scene.name : scene.path));
  comment("seed: " + std::to_string(result.seed));
  comment("digest: " + hex16(result.digest));
  comment("clray: " CLRAY_VERSION);
}

void TableFile::comment(std::string_view text) {
  file_.put("# " + shown(text) + "\n");
}

void TableFile::columns(const std::vector<std::string>& names) {
  for (const auto& name : names) cell(std::string_view(name));
  end_row();
}

TableFile& TableFile::cell(double value) {
  row_ += number(value);
  row_ += ',';
  return *this;
}

TableFile& TableFile::cell(std::uint64_t value) {
  row_ += std::to_string(value);
  row_ += ',';
  return *this;
}

TableFile& TableFile::cell(std::string_view text) {
  const std::string line = shown(text);
  if (line.find_first_of(",\"") == std::string::npos) {
    row_ += line;
  } else {
    row_ += '"';
    for (const char c : line) row_.append(c == '"' ? 2 : 1, c);
    row_ += '"';
  }
  row_ += ',';
  return *this;
}

void TableFile::end_row() {
  row_.back() = '\n';
  file_.put(row_);
  row_.clear();
}

void TableFile::close() {
  file_.close();
}

}  // namespace clray::io
