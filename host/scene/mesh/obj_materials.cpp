// SPDX-License-Identifier: Apache-2.0
// Libraries and slots of an OBJ file; see obj_materials.hpp. A name goes to the end of its line, so a '#' may belong
// to it ("Material #25") or begin a comment: the names of the libraries decide which.
#include "scene/mesh/obj_materials.hpp"

#include <algorithm>
#include <filesystem>
#include <unordered_map>

#include "scene/mesh/mesh_text.hpp"
#include "scene/mesh/mtl_reader.hpp"

namespace clray {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostWarnings = 16;

/// Finds the material that a usemtl means, and says what each material is called.
class NameTable {
 public:
  /// `whole`: the places of the materials by their names as written.
  NameTable(const std::vector<Material>& materials, const text::NameIndex& whole)
      : materials_(materials), whole_(whole) {
    for (std::size_t i = 0; i < materials.size(); ++i) {
      const std::string& name = materials[i].name;
      if (name.find('#') == std::string::npos) continue;
      add(cut_, without_comment(name), i);
      add(loose_, without_comment(name, true), i);
    }
  }

  /// Index of the material that `name` means, or -1. Two names are never compared after both were cut at a '#':
  /// "Material #27" is not "Material #25".
  int find(std::string_view name) const {
    int found = whole_or_cut(name);
    if (found < 0 && name.find('#') != std::string::npos) {
      found = whole_or_cut(without_comment(name));
      if (found < 0) found = whole_or_cut(without_comment(name, true));
    }
    if (found < 0) found = look_up(loose_, std::string(name));
    if (found < 0) found = look_up(loose_, without_comment(name));
    return found;
  }

  /// The name of material `i`, without its comment if it is then still unlike the others.
  std::string name(std::size_t i) const {
    if (materials_[i].name.find('#') == std::string::npos) return materials_[i].name;
    const std::string plain = without_comment(materials_[i].name);
    return whole_or_cut(plain) == static_cast<int>(i) ? plain : materials_[i].name;
  }

 private:
  using Map = std::unordered_map<std::string, std::size_t>;
  static constexpr std::size_t kSeveral = ~std::size_t{0};

  void add(Map& map, const std::string& name, std::size_t i) {
    if (in_whole(name) >= 0) return;
    const auto [entry, inserted] = map.emplace(name, i);
    if (!inserted && entry->second != i) entry->second = kSeveral;
  }

  static int look_up(const Map& map, const std::string& name) {
    const auto found = map.find(name);
    return found != map.end() && found->second != kSeveral ? static_cast<int>(found->second) : -1;
  }

  int in_whole(std::string_view name) const {
    const std::uint32_t found =
        whole_.find(name, [&](std::size_t i) -> std::string_view { return materials_[i].name; });
    return found == text::NameIndex::kNone ? -1 : static_cast<int>(found);
  }

  int whole_or_cut(std::string_view name) const {
    const int found = in_whole(name);
    return found >= 0 || cut_.empty() ? found : look_up(cut_, std::string(name));
  }

  const std::vector<Material>& materials_;
  const text::NameIndex& whole_;
  Map cut_, loose_;  // names cut at a '#' before a blank, and at any '#'
};

std::string base_name(const std::string& name) {
  const std::size_t slash = name.find_last_of("/\\");
  return slash == std::string::npos ? name : name.substr(slash + 1);
}

// The path of `name` beside the OBJ file, with links followed; empty if it is no file inside the folder.
fs::path file_inside(const fs::path& root, const std::string& name) {
  std::error_code error;
  if (name.empty() || name.find('\0') != std::string::npos) return {};
  const fs::path file = fs::weakly_canonical(root / name, error);
  if (error) return {};
  const fs::path inside = file.lexically_relative(root);
  if (inside.empty() || *inside.begin() == "..") return {};
  return fs::is_regular_file(file, error) ? inside : fs::path();
}

}  // namespace

void ObjMaterials::libraries(std::string_view names, std::uint64_t line, std::vector<std::string>& warnings) {
  any_library_ = true;
  const std::string whole(names), plain = without_comment(names);
  // A name may hold spaces, and a line may hold several names: the whole line is tried first.
  if (library(whole, line, warnings) || library(plain, line, warnings)) return;
  std::vector<std::string> missing;
  std::size_t words = 0;
  TextCursor text(plain, path_);
  for (; text.more_on_line(); ++words) {
    const std::string word(text.word());
    if (!library(word, line, warnings)) missing.push_back(word);
  }
  if (missing.size() == words) missing = {plain};
  for (const std::string& name : missing) {
    Tally gone;
    gone.add(line);
    gone.warn(
        path_,
        name.empty() ? "mtllib without a name is left out" : "material library " + quote_word(name) + " is missing",
        warnings);
  }
}

// Reads a library inside the folder of the OBJ file. A mesh that came from elsewhere must not make us open other files,
// so of a path that leads outside (absolute, of another system, with "..") only the last part is tried. Returns false
// if there is no such file.
bool ObjMaterials::library(const std::string& name, std::uint64_t line, std::vector<std::string>& warnings) {
  const fs::path folder = fs::path(path_).parent_path();
  std::error_code error;
  const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) fail_input(path_, line, "the folder of the OBJ file cannot be resolved: " + error.message());
  std::string slashes = name;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  fs::path inside = file_inside(root, name);
  if (inside.empty()) inside = file_inside(root, slashes);
  const bool fallen_back = inside.empty();
  if (fallen_back) inside = file_inside(root, base_name(name));
  if (inside.empty()) return false;
  if (!read_.insert(inside.string()).second) return true;
  if (fallen_back) {
    Tally elsewhere;
    elsewhere.add(line);
    elsewhere.warn(path_,
                   "material library " + quote_word(name) + " is not inside the folder of the OBJ file: " +
                       quote_word(inside.string()) + " beside it is read instead",
                   warnings);
  }
  MaterialLibrary more = read_mtl((folder / inside).string(), warnings);
  slot_of_.reserve(materials_.size() + more.materials.size());
  if (materials_.empty()) {
    materials_ = std::move(more.materials);
    material_of_ = std::move(more.place_of);
  } else {
    for (Material& material : more.materials) add(std::move(material), line);
  }
  return true;
}

void ObjMaterials::add(Material material, std::uint64_t line) {
  const auto [place, inserted] = material_of_.insert(
      material.name, static_cast<std::uint32_t>(materials_.size()),
      [&](std::size_t i) -> std::string_view { return i == materials_.size() ? material.name : materials_[i].name; });
  if (inserted) {
    materials_.push_back(std::move(material));
    return;
  }
  again_.add(line, material.name);
  materials_[place] = std::move(material);
}

std::uint32_t ObjMaterials::slot(std::string_view name, std::uint64_t line) {
  const auto [place, inserted] = slot_of_.insert(name, static_cast<std::uint32_t>(slots_.size()), [&](std::size_t i) {
    return i == slots_.size() ? name : slots_[i].name;
  });
  if (inserted) slots_.push_back({name, line, false});
  return place;
}

void ObjMaterials::use(std::string_view name, std::uint64_t line) {
  const bool unnamed = name.empty() || (name.front() == '#' && without_comment(name).empty());
  current_ = static_cast<int>(slot(unnamed ? std::string_view(kUnnamedMaterial) : name, line));
}

std::uint32_t ObjMaterials::face_slot() {
  if (current_ < 0) current_ = static_cast<int>(slot("", 0));
  slots_[static_cast<std::size_t>(current_)].used = true;
  return static_cast<std::uint32_t>(current_);
}

void ObjMaterials::finish(PolygonSoup& soup) {
  again_.warn(path_, "material " + quote_word(again_.first) + " comes again in a later library, which is used",
              soup.warnings);
  const NameTable names(materials_, material_of_);
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> place(slots_.size()), place_of_material(materials_.size(), kNone);
  std::unordered_map<std::string, std::uint32_t> place_of_other;
  std::vector<Unknown> unknown;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (!slots_[i].used) continue;
    const auto next = static_cast<std::uint32_t>(soup.slots.size());
    const int material = slots_[i].name.empty() ? -1 : names.find(slots_[i].name);
    if (material >= 0) {
      std::uint32_t& there = place_of_material[static_cast<std::size_t>(material)];
      if (there == kNone) {
        there = next;
        soup.slots.push_back(names.name(static_cast<std::size_t>(material)));
      }
      place[i] = there;
      continue;
    }
    const std::string name = without_comment(slots_[i].name);
    const auto [entry, inserted] = place_of_other.emplace(name, next);
    place[i] = entry->second;
    if (!inserted) continue;
    soup.slots.push_back(name);
    if (!name.empty()) unknown.push_back({soup.slots.back(), slots_[i].line});
  }
  for (std::uint32_t& s : soup.face_slot) s = place[s];
  warn_of_unknown(unknown, soup.warnings);
  // All new names before any changes, since the table looks at names as written.
  std::vector<std::pair<std::size_t, std::string>> renamed;
  for (std::size_t i = 0; i < materials_.size(); ++i) {
    if (std::string name = names.name(i); name != materials_[i].name) renamed.emplace_back(i, std::move(name));
  }
  for (auto& [i, name] : renamed) materials_[i].name = std::move(name);
  soup.file_materials = std::move(materials_);
}

void ObjMaterials::warn_of_unknown(const std::vector<Unknown>& unknown, std::vector<std::string>& warnings) const {
  // If no library could be read at all, a warning has already said so.
  const bool no_library = materials_.empty() && any_library_;
  std::size_t count = 0;
  Tally rest;
  for (const Unknown& slot : unknown) {
    if (no_library && slot.name != kUnnamedMaterial) continue;
    const std::string text = slot.name == kUnnamedMaterial
                                 ? std::string("usemtl without a name")
                                 : "usemtl " + quote_word(slot.name) + " is in no material library";
    if (++count <= kMostWarnings) {
      warnings.push_back(path_ + ":" + std::to_string(slot.line) + ": " + text);
    } else {
      rest.add(slot.line);
    }
  }
  rest.warn(path_, "more usemtl are in no material library", warnings);
}

}  // namespace clray
