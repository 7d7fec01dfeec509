// SPDX-License-Identifier: Apache-2.0
// MTL reader: Kd, Ks, Ns and illum of each newmtl, and whether it is transparent, which no surface here is; textures
// and everything else are left out. Source of the keys: Wavefront, Advanced Visualizer manual, appendix B1 (MTL 4.2).
#include "scene/mesh/mtl_reader.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "scene/file/material.hpp"
#include "scene/mesh/mesh_readers.hpp"
#include "scene/mesh/mesh_text.hpp"
#include "text/input_file.hpp"

namespace clray {

namespace {

constexpr double kMostNs = 1.0e6;
constexpr double kBlueEnd_nm = 500.0, kRedStart_nm = 600.0;

using Colour = std::array<double, 3>;  // red, green, blue

struct MtlEntry {
  std::string_view name;  // of the file
  std::uint64_t line = 0;
  std::optional<Colour> kd, ks;
  double ns = 0.0;
  std::optional<std::int64_t> illum;
  std::optional<double> d, tr;  // opacity, transparency
  bool textured = false;
};

/// A key as the manual writes it, if it is one that we read; some programs write them in other cases.
std::string_view known_key(std::string_view key) {
  constexpr auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  for (const std::string_view known : {"Kd", "Ks", "Ns", "newmtl", "illum", "map_Kd", "d", "Tr"}) {
    if (std::equal(key.begin(), key.end(), known.begin(), known.end(),
                   [&](char a, char b) { return lower(a) == lower(b); }))
      return known;
  }
  return key;
}

class MtlReader {
 public:
  MtlReader(const std::string& path, const std::string& content) : path_(path), text_(content, path) {
    const std::string_view key = "newmtl";
    std::size_t count = 0;
    for (std::size_t i = content.find(key); i != std::string::npos; i = content.find(key, i + key.size())) ++count;
    entries_.reserve(count);
    place_of_.reserve(count);
  }

  MaterialLibrary read(std::vector<std::string>& warnings) {
    while (text_.next_filled_line()) {
      const std::uint64_t line = text_.line();
      const std::string_view key = known_key(text_.word());
      if (key == "newmtl") {
        begin(text_.rest(), line);
      } else if (current_) {
        statement(key, *current_);
      } else if (key == "Kd" || key == "Ks" || key == "Ns" || key == "illum") {
        early_.add(line, key);
      }
      text_.next_line();
    }
    finish();
    MaterialLibrary library;
    library.materials.reserve(entries_.size());
    for (const MtlEntry& entry : entries_) library.materials.push_back(to_material(entry));
    library.place_of = std::move(place_of_);
    warn(warnings);
    return library;
  }

 private:
  void begin(std::string_view name, std::uint64_t line) {
    finish();
    current_ = MtlEntry();
    current_->name = name;
    current_->line = line;
    if (without_comment(name).empty()) {
      current_->name = kUnnamedMaterial;
      unnamed_.add(line);
    }
  }

  // The entry takes the place of an earlier one of the same name, or a new place.
  void finish() {
    if (!current_) return;
    const auto [place, inserted] =
        place_of_.insert(current_->name, static_cast<std::uint32_t>(entries_.size()),
                         [&](std::size_t i) { return i == entries_.size() ? current_->name : entries_[i].name; });
    if (inserted) {
      entries_.push_back(*current_);
    } else {
      twice_.add(current_->line, current_->name);
      entries_[place] = *current_;
    }
    current_.reset();
  }

  void statement(std::string_view key, MtlEntry& entry) {
    if (key == "Kd" || key == "Ks") {
      colour(key, entry, key == "Kd" ? entry.kd : entry.ks);
    } else if (key == "Ns") {
      const std::uint64_t line = text_.line();
      const double value = text_.number("Ns");
      entry.ns = std::min(std::max(value, 0.0), kMostNs);
      if (entry.ns != value) outside_.add(line, "Ns of " + quote_word(entry.name) + " is outside [0,1e6]");
    } else if (key == "illum") {
      const std::uint64_t line = text_.line();
      entry.illum = text_.integer("illum", INT32_MIN, INT32_MAX);
      if (*entry.illum >= 0 && *entry.illum <= 10) return;
      strange_illum_.add(line, entry.name);
      entry.illum.reset();
    } else if (key == "map_Kd") {
      entry.textured = true;
    } else if (key == "d" || key == "Tr") {
      std::string_view last;
      while (text_.more_on_line()) last = text_.word();  // d may begin with -halo
      double value = 0.0;
      if (parse_number(last, value).empty()) (key == "d" ? entry.d : entry.tr) = value;
    }
  }

  // A colour. Spectral files and CIE values are refused, since they give no share of light per colour.
  void colour(std::string_view key, const MtlEntry& entry, std::optional<Colour>& value) {
    const std::string what(key);
    const std::uint64_t line = text_.line();
    TextCursor ahead = text_;
    const std::string_view first = ahead.word();
    if (first == "spectral" || first == "xyz") {
      spectral_.add(line, what);
      return;
    }
    Colour rgb{};
    std::size_t count = 0;
    bool outside = false;
    for (; text_.more_on_line() && count < 3; ++count) {
      const double given = text_.number(what.c_str());
      rgb[count] = std::min(std::max(given, 0.0), 1.0);
      outside = outside || rgb[count] != given;
    }
    // MTL: green and blue default to red where only red is given.
    if (count != 1 && count != 3) text_.fail(what + " with one or three values was expected");
    if (outside) outside_.add(line, what + " of " + quote_word(entry.name) + " is outside [0,1]");
    if (count == 1) rgb[1] = rgb[2] = rgb[0];
    value = rgb;
  }

  static double mean(const Colour& c) { return (c[0] + c[1] + c[2]) / 3.0; }

  // A grey colour is a number. Another one is a spectrum of three bands: blue below 500 nm, red from 600 nm on.
  static void set_colour(const char* key, const Colour& c, Material* material) {
    if (c[0] == c[1] && c[1] == c[2]) {
      material->parameters[key] = c[0];
      return;
    }
    constexpr double kStep_nm = 1e-6;  // a spectrum is linear between its points
    material->spectra[key] = {{kBlueEnd_nm, kBlueEnd_nm + kStep_nm, kRedStart_nm, kRedStart_nm + kStep_nm},
                              {c[2], c[1], c[1], c[0]}};
  }

  Material to_material(const MtlEntry& entry) {
    if (entry.d ? *entry.d < 1.0 : entry.tr && *entry.tr > 0.0) transparent_.add(entry.line, entry.name);
    Material material;
    material.name = entry.name;
    const Colour kd = entry.kd.value_or(Colour{}), ks = entry.ks.value_or(Colour{});
    if (mean(ks) > 0.0 && entry.illum.value_or(0) >= 2) {
      material.model = "ashikhmin-shirley";
      Colour both{};
      bool bright = false;
      for (std::size_t i = 0; i < 3; ++i) {
        both[i] = std::min(kd[i] + ks[i], 1.0);
        bright = bright || kd[i] + ks[i] > 1.0;
      }
      set_colour("rho", both, &material);
      set_colour("f0", both, &material);
      material.parameters["d"] = mean(kd) / (mean(kd) + mean(ks));
      material.parameters["n"] = entry.ns;
      if (bright) bright_.add(entry.line, entry.name);
      if (entry.textured) textured_.add(entry.line, entry.name);
      return material;
    }
    if (!entry.kd) {
      no_kd_.add(entry.line, entry.name);
      material = default_material();
      material.name = entry.name;
      return material;
    }
    if (mean(ks) > 0.0 && !entry.illum) no_illum_.add(entry.line, entry.name);
    material.model = "lambert";
    set_colour("rho", kd, &material);
    if (entry.textured) textured_.add(entry.line, entry.name);
    return material;
  }

  void warn(std::vector<std::string>& warnings) const {
    const auto material = [](const Tally& tally) { return "material " + quote_word(tally.first); };
    early_.warn(path_, quote_word(early_.first) + " before any newmtl is left out", warnings);
    unnamed_.warn(path_, "newmtl without a name", warnings);
    twice_.warn(path_, material(twice_) + " is defined again; the last definition is used", warnings);
    outside_.warn(path_, outside_.first + " and taken to its nearer end", warnings);
    strange_illum_.warn(path_, "illum of " + material(strange_illum_) + " is none of 0 to 10 and left out", warnings);
    spectral_.warn(path_, spectral_.first + " as a spectral file or CIE XYZ is left out", warnings);
    no_illum_.warn(path_, material(no_illum_) + " has Ks but no illum >= 2: taken as Lambert with Kd", warnings);
    no_kd_.warn(path_, material(no_kd_) + " has no Kd: taken as Lambert with rho 0.5", warnings);
    bright_.warn(path_, "Kd + Ks of " + material(bright_) + " are above 1 and taken as 1", warnings);
    textured_.warn(path_, material(textured_) + " has a texture (map_Kd), which is left out: Kd alone is its colour",
                   warnings);
    transparent_.warn(path_, material(transparent_) + " is transparent (d or Tr): taken as opaque", warnings);
    if (entries_.empty()) warnings.push_back(path_ + ": the material library defines no material");
  }

  const std::string& path_;
  TextCursor text_;
  std::optional<MtlEntry> current_;
  std::vector<MtlEntry> entries_;
  text::NameIndex place_of_;
  Tally early_, unnamed_, twice_, outside_, strange_illum_, spectral_, no_illum_, no_kd_, bright_, textured_,
      transparent_;
};

}  // namespace

MaterialLibrary read_mtl(const std::string& path, std::vector<std::string>& warnings) {
  const std::string content = text::read_input_file(path);
  return MtlReader(path, content).read(warnings);
}

}  // namespace clray
