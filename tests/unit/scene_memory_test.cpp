// SPDX-License-Identifier: Apache-2.0
// Scenes and meshes that are in no file: text of a scene, meshes by the names that it gives, and what is refused.
#include <doctest/doctest.h>

#include <string>

#include "clray/error.hpp"
#include "clray/scene.hpp"

using namespace clray;

namespace {

std::shared_ptr<const Mesh> square() {
  return make_mesh({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, {{{0, 1, 2}}, {{0, 2, 3}}});
}

std::string message_of(const std::string& text, const SceneOptions& options = {}) {
  try {
    parse_scene(text, "here/scene", options);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::input);
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a mesh in memory is counted as one of a file is") {
  const auto mesh = square();
  CHECK(mesh->report.area_m2 == 4.0);
  CHECK(mesh->report.triangles == 2);
  CHECK(mesh->report.faces == 2);
  CHECK(mesh->report.boundary_edges == 4);
  CHECK(mesh->report.non_manifold_edges == 0);
  CHECK(mesh->material_slots == std::vector<std::string>{""});
}

TEST_CASE("meshes in memory that are none are refused") {
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  CHECK_THROWS_WITH_AS(make_mesh(corners, {}), doctest::Contains("no faces"), Error);
  CHECK_THROWS_WITH_AS(make_mesh(corners, {{{0, 1, 3}}}), doctest::Contains("vertex 3; there are 3"), Error);
  CHECK_THROWS_WITH_AS(make_mesh(corners, {{{0, 1, 1}}}), doctest::Contains("without area"), Error);
  CHECK_THROWS_AS(make_mesh({{0, 0, 0}, {1, 0, 0}, {0, HUGE_VAL, 0}}, {{{0, 1, 2}}}), Error);
}

TEST_CASE("the text of a scene gives the scene, with meshes in memory by their names") {
  SceneOptions options;
  options.meshes["panel"] = square();
  const Scene scene = parse_scene(
      "[[material]]\nname = \"paint\"\nmodel = \"lambert\"\nrho = 0.25\n"
      "[[component]]\nname = \"a\"\nfile = \"panel\"\nmaterial = \"paint\"\n"
      "[[component]]\nname = \"b\"\nfile = \"panel\"\nmaterial = \"paint\"\ntransform = { translate = [0, 0, 1] }\n",
      "here/scene", options);
  REQUIRE(scene.components.size() == 2);
  CHECK(scene.components[0].mesh.get() == options.meshes["panel"].get());
  CHECK(scene.components[1].mesh.get() == scene.components[0].mesh.get());
  CHECK(scene.components[1].transform.translate.z == 1.0);
  CHECK(scene.materials.at(0).parameters.at("rho") == 0.25);
  CHECK(scene.detectors.size() == 1);
}

TEST_CASE("messages name the place in the text") {
  CHECK(message_of("[[component]]\nshape = \"sphere\"\nradius = -1\n").find("here/scene:3:10") == 0);
  CHECK(message_of("[[component]\n").find("here/scene:1:") == 0);
  CHECK(message_of("[[component]]\nfile = \"panel\"\n").find("here/scene:2:8") == 0);
  SceneOptions options;
  options.meshes["panel"] = nullptr;
  CHECK(message_of("[[component]]\nfile = \"panel\"\n", options).find("here/scene:2:8") == 0);
}

TEST_CASE("files that stand elsewhere are found by the names that keys give them") {
  const std::string orbit = std::string(CLRAY_SOURCE_DIR) + "/meshes/box_wing.obj";  // any file: it is not read yet
  const std::string text =
      "[[component]]\nshape = \"sphere\"\n[source]\nkind = \"sun\"\n[[observer]]\necef_m = [6.4e6, 0, 0]\n"
      "[pass]\nstart = 2026-01-01T00:00:00Z\nstop = 2026-01-01T00:01:00Z\nstep_s = 10\nephemeris = \"orbit\"\n";
  SceneOptions options;
  options.files["orbit"] = orbit;
  CHECK(parse_scene(text, "here/scene", options).pass->ephemeris == orbit);
  CHECK(message_of(text).find("here/scene:11:13") == 0);
  options.files["orbit"] = orbit + ".nowhere";
  CHECK(message_of(text, options).find("here/scene:11:13: pass.ephemeris: \"" + orbit + ".nowhere\"") == 0);
}
