// SPDX-License-Identifier: Apache-2.0
// Materials of a scene: reading them from a scene file or from the words of --material, and finding one for each
// slot of a component.
#pragma once

#include <map>
#include <string>

#include "clray/scene.hpp"
#include "scene/file/toml_reader.hpp"

namespace clray {

/// Reads a [[material]], or one of a [[variant]]. A table without `model` starts from `base`, the scene's material of
/// that name, and changes what it gives.
Material read_material(TomlTable& table, const Material* base = nullptr);

/// "model key=value …" of --material. Throws Error(usage).
Material parse_material(const std::string& text);

/// Lambert, rho = 0.5: the surface of a part that nobody described.
Material default_material();

/// Index of a material by name, or -1.
int find_material(const Scene& scene, const std::string& name);

/// Fills `component->materials`, one per slot: `by_slot` first, then `common`, then a scene material of the slot's
/// name (the first `defined` of scene->materials), then the mesh file's, then the default. Adds what it needs to
/// the scene. Names must exist. Returns whether the default was needed.
bool assign_materials(Scene* scene, std::size_t defined, Component* component,
                      const std::map<std::string, std::string>& by_slot, const std::string& common);

}  // namespace clray
