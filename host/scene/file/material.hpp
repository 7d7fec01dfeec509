// SPDX-License-Identifier: Apache-2.0
// Materials of a scene: reading them from a scene file or from the words of --material, and finding one for each
// slot of a component.
#pragma once

#include <map>
#include <string>

#include "clray/scene.hpp"
#include "scene/file/toml_reader.hpp"
#include "text/name_index.hpp"

namespace clray {

/// Reads a [[material]], or one of a [[variant]]. A table without `model` starts from `base`, the scene's material of
/// that name, and changes what it gives.
Material read_material(TomlTable& table, const Material* base = nullptr);

/// "model key=value …" of --material. Throws Error(usage).
Material parse_material(const std::string& text);

/// Lambert, rho = 0.5: the surface of a part that nobody described.
Material default_material();

/// The materials of a scene by name, while the scene is read. There may be a million of them.
class MaterialBook {
 public:
  explicit MaterialBook(Scene* scene);

  /// Index of a material by name, or -1.
  int find(const std::string& name) const;
  /// Adds a material whose name is not there yet. Returns its index.
  std::uint32_t add(Material material);
  /// Ends what the scene itself defines; what comes later are materials of mesh files and the default.
  void close() { defined_ = scene_->materials.size(); }

  /// Fills `component->materials`, one per slot: `by_slot` first, then `common`, then a material that the scene defines
  /// under the slot's name, then the mesh file's, then the default. Adds what it needs to the scene. Names must exist.
  /// Returns whether the default was needed.
  bool assign(Component* component, const std::map<std::string, std::string>& by_slot, const std::string& common);

 private:
  std::uint32_t add_if_missing(Material material);
  std::uint32_t add_from_file(Material material, const std::string& component);

  Scene* scene_;
  text::NameIndex place_;
  std::size_t defined_ = 0;
};

}  // namespace clray
