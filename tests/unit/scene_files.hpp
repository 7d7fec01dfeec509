// SPDX-License-Identifier: Apache-2.0
// A folder of scene files for one test, removed with everything in it at the end; and what an input error says.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "clray/error.hpp"
#include "clray/scene.hpp"

namespace clray::test {

/// What check_scene() says of a scene filled by hand; "fine" if nothing.
inline std::string check_of(const Scene& scene) {
  try {
    check_scene(scene);
  } catch (const Error& e) {
    return e.code() == ErrorCode::input ? e.what() : "wrong code";
  }
  return "fine";
}

class SceneFolder {
 public:
  SceneFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "clray-scene-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
    write("plate.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl solar\nf 1 2 3\nusemtl foil\nf 1 3 4\n");
  }
  ~SceneFolder() { std::filesystem::remove_all(path_); }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
    return (path_ / name).string();
  }
  std::string path(const std::string& name) const { return (path_ / name).string(); }

  /// What load_scene() says of this scene text, without the folder; "fine" if nothing.
  std::string complaint(const std::string& text, ErrorCode code = ErrorCode::input,
                        const SceneOptions& options = {}) const {
    const std::string file = write("s.toml", text);
    try {
      load_scene(file, options);
    } catch (const Error& e) {
      std::string what = e.what();
      const std::string prefix = path_.string() + "/";
      for (std::size_t at; (at = what.find(prefix)) != std::string::npos;) what.erase(at, prefix.size());
      return e.code() == code ? what : "wrong code: " + what;
    }
    return "fine";
  }
  Scene load(const std::string& text, const SceneOptions& options = {}) const {
    return load_scene(write("s.toml", text), options);
  }

 private:
  std::filesystem::path path_;
};

}  // namespace clray::test
