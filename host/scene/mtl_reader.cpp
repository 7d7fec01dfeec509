// SPDX-License-Identifier: Apache-2.0
// MTL reader: Kd, Ks, Ns and illum of each newmtl; textures and everything else are left out.
// Source of the keys: Wavefront, Advanced Visualizer manual, appendix B1 (MTL 4.2).
#include "scene/mtl_reader.hpp"

#include <array>

#include "scene/mesh_soup.hpp"
#include "scene/mesh_text.hpp"

namespace clray {

namespace {

struct MtlEntry {
  std::string name;
  double kd = 0.0, ks = 0.0;  // means over the colours
  double ns = 0.0;
  int illum = -1;  // -1: not given
  std::uint64_t line = 0;
};

// The mean of a colour; false for a spectral file or CIE values, which are no share of light per colour.
bool read_colour(TextCursor& text, const char* what, double& mean) {
  double sum = 0.0;
  int count = 0;
  while (text.more_on_line() && count < 3) {
    if (count == 0) {
      TextCursor ahead = text;
      const std::string_view word = ahead.word();
      if (word == "spectral" || word == "xyz") return false;
    }
    const double value = text.number(what);
    if (!(value >= 0.0 && value <= 1.0))
      text.fail(std::string(what) + " is outside [0,1]; a value in [0,1] was expected");
    sum += value;
    ++count;
  }
  // MTL: green and blue default to red where only red is given.
  if (count != 1 && count != 3) text.fail(std::string(what) + " with one or three values was expected");
  mean = sum / count;
  return true;
}

Material to_material(const MtlEntry& entry) {
  Material material;
  material.name = entry.name;
  if (entry.ks > 0.0 && entry.illum >= 2) {
    const double sum = entry.kd + entry.ks;
    material.model = "ashikhmin-shirley";
    material.parameters["rho"] = sum < 1.0 ? sum : 1.0;
    material.parameters["f0"] = material.parameters["rho"];
    material.parameters["d"] = entry.kd / sum;
    material.parameters["n"] = entry.ns;
  } else {
    material.model = "lambert";
    material.parameters["rho"] = entry.kd;
  }
  return material;
}

void read_statement(TextCursor& text, std::string_view key, MtlEntry& entry, const std::string& path,
                    std::vector<std::string>& warnings) {
  if (key == "Kd" || key == "Ks") {
    const std::string where = path + ":" + std::to_string(text.line());
    if (!read_colour(text, key == "Kd" ? "Kd" : "Ks", key == "Kd" ? entry.kd : entry.ks)) {
      warnings.push_back(where + ": " + std::string(key) + " as a spectral file or CIE XYZ is left out");
      return;
    }
  } else if (key == "Ns") {
    entry.ns = text.number("Ns");
    if (!(entry.ns >= 0.0 && entry.ns <= 1.0e6)) text.fail("Ns is outside [0,1e6]; a value in [0,1e6] was expected");
  } else if (key == "illum") {
    entry.illum = static_cast<int>(text.integer("illum", 0, 10));
  } else {
    return;
  }
  if (text.more_on_line())
    text.fail(quote_word(text.word()) + " follows a complete " + std::string(key) +
              "; the end of the line was expected");
}

}  // namespace

std::vector<Material> read_mtl(const std::string& path, std::vector<std::string>& warnings) {
  const std::string content = read_mesh_file(path);
  TextCursor text(content, path);
  std::vector<MtlEntry> entries;
  while (text.next_filled_line()) {
    const std::uint64_t line = text.line();
    const std::string_view key = text.word();
    if (key == "newmtl") {
      MtlEntry entry;
      entry.name = std::string(text.rest());
      entry.line = line;
      if (entry.name.empty()) text.fail("newmtl without a name; a name was expected");
      for (const MtlEntry& other : entries) {
        if (other.name == entry.name) {
          text.fail("material " + quote_word(entry.name) + " is defined twice (first in line " +
                    std::to_string(other.line) + "); names that differ were expected");
        }
      }
      entries.push_back(entry);
    } else if (!entries.empty()) {
      read_statement(text, key, entries.back(), path, warnings);
    } else if (key == "Kd" || key == "Ks" || key == "Ns" || key == "illum") {
      text.fail(quote_word(key) + " before any newmtl; newmtl was expected first");
    }
    text.next_line();
  }
  if (entries.empty()) warnings.push_back(path + ": the material library defines no material");
  std::vector<Material> materials;
  for (const MtlEntry& entry : entries) {
    if (entry.ks > 0.0 && entry.illum < 0) {
      warnings.push_back(path + ":" + std::to_string(entry.line) + ": material " + quote_word(entry.name) +
                         " has Ks but no illum >= 2: taken as Lambert with Kd");
    }
    materials.push_back(to_material(entry));
  }
  return materials;
}

}  // namespace clray
