// SPDX-License-Identifier: Apache-2.0
// The sections of a scene file, one reader each, and the checks that they share with scenes built by hand.
#pragma once

#include <string>
#include <vector>

#include "clray/error.hpp"
#include "clray/scene.hpp"
#include "scene/file/toml_reader.hpp"

namespace clray {

/// Reads a scene file into a scene, all of it but what the command line adds.
Scene read_scene_text(const std::string& text, const std::string& path, const SceneOptions& options);

/// An error that names a member of the scene ("observers[0].direction") as one that names its place in the scene file
/// with this text, or the file alone where the file does not speak of it. Other errors stay as they are.
Error placed_in_file(const Error& error, const std::string& text, const std::string& path);

void read_source(TomlTable& root, Scene* scene);
void read_observers(TomlTable& root, Scene* scene);
void read_pass(TomlTable& root, Scene* scene);
/// Tables of directions and the source's default, once the pass is known.
void read_pass_directions(TomlTable& root, Scene* scene);
void read_motion(TomlTable& root, Scene* scene);
void read_station(TomlTable& root, Scene* scene);
void read_detectors(TomlTable& root, Scene* scene);
void read_trace(TomlTable& root, Scene* scene);

/// What is wrong with a shape's parameters (each a length, or a switch) taken together, or "".
std::string shape_fault(const Component& component);

/// What is wrong with a component's place, or "". It may not be so far out that no digits are left for its shape.
std::string distance_fault(const Component& component);

/// What is wrong with a detector's parameters taken together, or "".
std::string detector_fault(const DetectorSpec& detector);

/// What is wrong with a source for the scene's detectors, or "": bands in which it has no light.
std::string source_fault(const Scene& scene);

/// More instants of a pass are refused.
constexpr double kMostInstants = 1e6;

/// Throws Error(input) for a key of [pass], at its place in the scene file if it has one.
[[noreturn]] void fail_pass(const Pass& pass, const std::string& key, const std::string& what);
[[noreturn]] void fail_many_instants(const Pass& pass, const std::string& key);

/// Throws Error(input) where a pass does not fit its scene, or a scene without one moves as only a pass can.
void check_pass(const Scene& scene);

/// Throws Error(input) where the station's range is not known throughout the motion (at time 0 without one), where an
/// observer at the source has another range than the station there, or where the shots of a session are too many.
void check_ranging(const Scene& scene);

/// What a person should know of the station before the scene is traced: why there will be no session, that the target
/// is below the horizon, that no calendar was given. For a scene that check_ranging() accepts.
std::vector<std::string> ranging_warnings(const Scene& scene);

/// The station's ranges during the motion, for a person; empty where they are fixed.
std::string ranging_text(const Scene& scene);

/// What is wrong with an observer's extinction in its scene, or "".
std::string extinction_fault(const Scene& scene, const Observer& observer);

}  // namespace clray
