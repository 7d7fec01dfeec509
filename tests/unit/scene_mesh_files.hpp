// SPDX-License-Identifier: Apache-2.0
// A folder of throw-away mesh files for the reader tests, and the error that a file is refused with.
#pragma once

#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "clray/error.hpp"
#include "clray/scene.hpp"

namespace mesh_test {

/// A new folder under the temporary folder, removed with all that is in it.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "clray-mesh-XXXXXX").string();
    REQUIRE(::mkdtemp(pattern.data()) != nullptr);
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(const std::string& name = {}) const { return name.empty() ? path_ : path_ + "/" + name; }
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

 private:
  std::string path_;
};

inline std::shared_ptr<const clray::Mesh> load_text(const std::string& content, const std::string& name = "a.obj") {
  const Folder folder;
  return clray::load_mesh(folder.write(name, content));
}

/// "context|message" of the error that `path` is refused with (context without the folder), or "accepted".
inline std::string refusal_of(const std::string& path) {
  try {
    clray::load_mesh(path);
  } catch (const clray::Error& error) {
    CHECK(error.code() == clray::ErrorCode::input);
    const std::size_t slash = error.context().rfind('/');
    return error.context().substr(slash == std::string::npos ? 0 : slash + 1) + "|" + error.message();
  }
  return "accepted";
}

inline std::string refusal(const std::string& content, const std::string& name = "a.obj") {
  const Folder folder;
  return refusal_of(folder.write(name, content));
}

/// Refused at `context` with a message that holds `words` and says what was expected.
inline void check_refused(const std::string& content, const std::string& context, const std::string& words,
                          const std::string& name = "a.obj") {
  const std::string found = refusal(content, name);
  INFO(content.substr(0, 200));
  INFO(found);
  CHECK(found.substr(0, context.size() + 1) == context + "|");
  CHECK(found.find(words) != std::string::npos);
  CHECK(found.find("expected") != std::string::npos);
}

/// Six times the volume that outward faces enclose, over six: negative if they point inward.
inline double volume(const clray::Mesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    sum += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  }
  return sum / 6.0;
}

/// A box of 2 × 3 × 4 with outward faces: 8 vertices, 6 quads, area 52, volume 24.
inline const std::string kBoxVertices = "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 4\nv 2 0 4\nv 2 3 4\nv 0 3 4\n";
inline const std::string kBox = kBoxVertices + "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";

}  // namespace mesh_test
