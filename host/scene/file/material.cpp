// SPDX-License-Identifier: Apache-2.0
// Materials of a scene, see material.hpp. Which keys a model takes, their ranges and defaults come from brdf.def.
#include "scene/file/material.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>

#include "clray/error.hpp"
#include "scene/file/scene_csv.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

/// Checks that the key accepts every value of a spectrum.
Spectrum key_spectrum(const TableKey& key, const std::string& file) {
  std::vector<std::string> names{"value", key.name};
  for (const char* word : {"reflectance", "albedo"}) {
    if (key.meaning.find(word) != std::string::npos) names.insert(names.end(), {word, "rho"});
  }
  Spectrum spectrum = read_spectrum(file, {names, ""}, key.low, key.high);
  for (const double value : spectrum.value) {
    std::string expected;
    if (!key_accepts(key, value, &expected)) {
      throw Error(ErrorCode::input, fmt::format("{}: expected {}, found {}", key.name, expected, value), file);
    }
  }
  return spectrum;
}

/// Sets a key to a number and drops a spectrum that it had from a base, or the other way round.
void set_number(Material* m, const std::string& key, double value) {
  m->parameters[key] = value;
  m->spectra.erase(key);
}
void set_spectrum(Material* m, const std::string& key, Spectrum spectrum) {
  m->spectra[key] = std::move(spectrum);
  m->parameters.erase(key);
}

bool same(const Material& a, const Material& b) {
  const auto equal = [](const Spectrum& x, const Spectrum& y) {
    return x.wavelength_nm == y.wavelength_nm && x.value == y.value;
  };
  if (a.model != b.model || a.parameters != b.parameters || a.two_sided != b.two_sided || a.table != b.table ||
      a.infrared_reflectance != b.infrared_reflectance || a.spectra.size() != b.spectra.size()) {
    return false;
  }
  for (const auto& [key, spectrum] : a.spectra) {
    const auto other = b.spectra.find(key);
    if (other == b.spectra.end() || !equal(spectrum, other->second)) return false;
  }
  return true;
}

auto names_of(const std::vector<Material>& list) {
  return [&list](std::size_t i) -> std::string_view { return list[i].name; };
}

[[noreturn]] void usage(const std::string& message) {
  throw Error(ErrorCode::usage, message, "--material");
}

/// One "key=value" of --material.
void parse_pair(const std::string& pair, const TableRow& row, Material* m) {
  const std::size_t equals = pair.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size()) {
    usage("expected key=value, found '" + pair + "'");
  }
  const std::string name = pair.substr(0, equals), word = pair.substr(equals + 1);
  double value = 0.0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool number = read.ec == std::errc() && read.ptr == word.data() + word.size();
  if (name == "two_sided") {
    if (word != "true" && word != "false") usage("two_sided: expected true or false, found '" + word + "'");
    m->two_sided = word == "true";
    return;
  }
  if (name == "infrared_reflectance") {
    if (!number || !(value >= 0.0 && value <= 1.0)) {
      usage("infrared_reflectance: expected a number in [0,1], found '" + word + "'");
    }
    m->infrared_reflectance = value;
    return;
  }
  if (name == "file" && row.file) {
    m->table = std::make_shared<BrdfTable>(read_brdf_table(word));
    return;
  }
  std::vector<std::string> known{"two_sided", "infrared_reflectance"};
  for (const TableKey& key : row.keys) {
    known.push_back(key.name);
    if (key.name != name) continue;
    if (!number && word.size() > 4 && word.substr(word.size() - 4) == ".csv") {
      set_spectrum(m, name, key_spectrum(key, word));
      return;
    }
    std::string expected;
    if (!key_accepts(key, number ? value : std::nan(""), &expected) || !number) {
      usage(fmt::format("{}: expected {}, found '{}'", name, expected, word));
    }
    set_number(m, name, value);
    return;
  }
  usage(fmt::format("unknown key '{}' of model '{}'; expected one of {}{}", name, row.name, fmt::join(known, ", "),
                    did_you_mean(name, known)));
}

}  // namespace

Material default_material() {
  Material m;
  m.name = "default";
  m.parameters["rho"] = 0.5;
  return m;
}

MaterialBook::MaterialBook(Scene* scene) : scene_(scene) {
  for (std::size_t i = 0; i < scene->materials.size(); ++i)
    place_.insert(scene->materials[i].name, static_cast<std::uint32_t>(i), names_of(scene->materials));
}

int MaterialBook::find(const std::string& name) const {
  const std::uint32_t there = place_.find(name, names_of(scene_->materials));
  return there == text::NameIndex::kNone ? -1 : static_cast<int>(there);
}

std::uint32_t MaterialBook::add(Material material) {
  const auto place = static_cast<std::uint32_t>(scene_->materials.size());
  scene_->materials.push_back(std::move(material));
  place_.insert(scene_->materials.back().name, place, names_of(scene_->materials));
  return place;
}

std::uint32_t MaterialBook::add_if_missing(Material material) {
  const int there = find(material.name);
  return there >= 0 ? static_cast<std::uint32_t>(there) : add(std::move(material));
}

// Adds a mesh file's own material. An equal one is shared; if a different one has its name, it is renamed.
std::uint32_t MaterialBook::add_from_file(Material material, const std::string& component) {
  std::vector<Material>& known = scene_->materials;
  const auto next = static_cast<std::uint32_t>(known.size());
  const auto [there, inserted] = place_.insert(material.name, next, [&](std::size_t i) -> std::string_view {
    return i == next ? std::string_view(material.name) : std::string_view(known[i].name);
  });
  if (inserted) {
    known.push_back(std::move(material));
    return next;
  }
  if (same(known[there], material)) return there;
  material.name += " (" + component + ")";
  return add(std::move(material));
}

bool MaterialBook::assign(Component* component, const std::map<std::string, std::string>& by_slot,
                          const std::string& common) {
  const std::vector<std::string> shape_slot{""};
  const Mesh* mesh = component->mesh.get();
  const std::vector<std::string>& slots = mesh != nullptr ? mesh->material_slots : shape_slot;
  text::NameIndex in_file;
  if (mesh != nullptr) in_file.reserve(mesh->file_materials.size());
  for (std::size_t i = 0; mesh != nullptr && i < mesh->file_materials.size(); ++i)
    in_file.insert(mesh->file_materials[i].name, static_cast<std::uint32_t>(i), names_of(mesh->file_materials));
  component->materials.clear();
  component->materials.reserve(slots.size());
  const std::size_t most = scene_->materials.size() + slots.size();
  if (most > 2 * scene_->materials.capacity()) scene_->materials.reserve(most);
  place_.reserve(most);
  bool defaulted = false;
  for (const std::string& slot : slots) {
    const auto mapped = by_slot.find(slot);
    const std::string& wanted = mapped != by_slot.end() ? mapped->second : common;
    const int named = wanted.empty() && defined_ == 0 ? -1 : find(wanted.empty() ? slot : wanted);
    const bool own = !wanted.empty() || (named >= 0 && static_cast<std::size_t>(named) < defined_);
    if (own && named >= 0) {
      component->materials.push_back(static_cast<std::uint32_t>(named));
      continue;
    }
    const std::uint32_t of_file =
        slot.empty() ? text::NameIndex::kNone : in_file.find(slot, names_of(mesh->file_materials));
    const bool none = of_file == text::NameIndex::kNone;
    defaulted = defaulted || none;
    component->materials.push_back(none ? add_if_missing(default_material())
                                        : add_from_file(mesh->file_materials[of_file], component->name));
  }
  return defaulted;
}

Material read_material(TomlTable& t, const Material* base) {
  Material m;
  const bool inherits = base != nullptr && !t.has("model");
  if (inherits) m = *base;
  m.name = t.name("name");
  m.model = t.choice("model", row_names("brdf"), inherits ? m.model : std::optional<std::string>());
  const TableRow& row = table_row("brdf", m.model);
  for (const TableKey& key : row.keys) {
    const toml::node* value = t.node(key.name);
    if (value != nullptr && value->is_string() && !key.is_switch) {
      const std::string file = t.file(key.name);
      set_spectrum(&m, key.name, key_spectrum(key, file));
    } else if (const std::optional<double> number = t.row_key(key)) {
      set_number(&m, key.name, *number);
    }
  }
  m.two_sided = t.boolean("two_sided", m.two_sided);
  m.infrared_reflectance = t.number("infrared_reflectance", kShare, m.infrared_reflectance);
  if (row.file && (t.has("file") || !m.table)) {
    m.table = std::make_shared<BrdfTable>(read_brdf_table(t.file("file")));
  }
  t.finish();
  return m;
}

Material parse_material(const std::string& text) {
  std::istringstream words(text);
  Material m;
  m.name = "command line";
  if (!(words >> m.model)) usage("expected \"model key=value …\", found nothing");
  const std::vector<std::string> models = row_names("brdf");
  if (table_index("brdf", m.model) < 0) {
    usage(fmt::format("unknown model '{}'; expected one of {}{}", m.model, fmt::join(models, ", "),
                      did_you_mean(m.model, models)));
  }
  const TableRow& row = table_row("brdf", m.model);
  for (std::string pair; words >> pair;) parse_pair(pair, row, &m);
  if (row.file && !m.table) usage(fmt::format("model '{}' needs file=TABLE.csv", row.name));
  return m;
}

}  // namespace clray
