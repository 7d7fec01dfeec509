// SPDX-License-Identifier: Apache-2.0
// The public functions and what they cannot use: each says so by an Error, with the member's path, and none crashes.
// Every fault is tried at every entry point that takes a scene.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>

#include "clray/error.hpp"
#include "clray/keys.hpp"
#include "clray/session.hpp"
#include "clray/trace.hpp"
#include "support/scenes.hpp"

using namespace clray_test;
using clray::Error;
using clray::ErrorCode;
using clray::Scene;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// A scene with something in every member: meshes and shapes, a hinge, spectra, a table, variants, motion, station.
Scene full_scene() {
  Scene scene = scene_of(box_mesh(1.0, 2.0, 3.0), lambert(0.5));
  scene.materials[0].spectra["rho"] = {{400.0, 800.0}, {0.2, 0.4}};
  clray::Material measured;
  measured.model = "tabulated";
  auto table = std::make_shared<clray::BrdfTable>();
  table->theta_i_rad = table->theta_o_rad = {0.0, 1.5};
  table->phi_rad = {0.0, 3.0};
  table->value.assign(8, 0.1);
  measured.table = table;
  clray::Component& disk = add(scene, "disk", {{"radius", 1.0}, {"inner_radius", 0.5}}, measured);
  disk.transform.translate = {0.0, 0.0, 2.5};
  disk.hinge = clray::Hinge{};
  clray::Variant variant;
  variant.name = "dark";
  variant.materials.push_back(lambert(0.1));
  variant.materials[0].name = scene.materials[0].name;
  scene.variants.push_back(variant);
  bistatic(scene, toward(0.3), toward(0.5));
  scene.observers.push_back({"second", toward(0.9), false, 0.1, 1e6});
  scene.detectors = {{"delay", "a", {{"bins", 16.0}}}, {"pressure", "", {}}};
  scene.motion = clray::Motion{};
  scene.motion->period_s = 10.0;
  scene.motion->stop_s = 1.0;
  scene.motion->step_rad = 0.5;
  scene.station = clray::Station{};
  return rays(scene, 10);
}

/// The mesh of a component, copied so that it can be changed.
clray::Mesh& mesh_of(Scene& scene) {
  auto copy = std::make_shared<clray::Mesh>(*scene.components[0].mesh);
  scene.components[0].mesh = copy;
  return *copy;
}

clray::BrdfTable& table_of(Scene& scene) {
  auto copy = std::make_shared<clray::BrdfTable>(*scene.materials[1].table);
  scene.materials[1].table = copy;
  return *copy;
}

struct Fault {
  std::string where;  ///< the beginning of the error's context
  std::function<void(Scene&)> make;
};

std::vector<Fault> faults() {
  return {
      {"components", [](Scene& s) { s.components.clear(); }},
      {"observers", [](Scene& s) { s.observers.clear(); }},
      {"detectors", [](Scene& s) { s.detectors.clear(); }},
      {"components[0].materials", [](Scene& s) { s.materials.clear(); }},
      {"reference_point", [](Scene& s) { s.reference_point.y = kNan; }},
      {"reference_point", [](Scene& s) { s.reference_point.y = 1e200; }},
      {"materials", [](Scene& s) { s.materials[1].name = s.materials[0].name; }},
      {"materials[0].model", [](Scene& s) { s.materials[0].model = "lambrt"; }},
      {"materials[0].rho", [](Scene& s) { s.materials[0].parameters["rho"] = 1.5; }},
      {"materials[0].rho", [](Scene& s) { s.materials[0].parameters["rho"] = kNan; }},
      {"materials[0]", [](Scene& s) { s.materials[0].parameters["n"] = 1.0; }},
      {"materials[0].infrared_reflectance", [](Scene& s) { s.materials[0].infrared_reflectance = kNan; }},
      {"materials[0].rho", [](Scene& s) { s.materials[0].spectra["rho"].value.pop_back(); }},
      {"materials[0].rho", [](Scene& s) { s.materials[0].spectra["rho"] = {}; }},
      {"materials[0].rho", [](Scene& s) { s.materials[0].spectra["rho"].wavelength_nm[1] = 400.0; }},
      {"materials[0].rho", [](Scene& s) { s.materials[0].spectra["rho"].value[1] = 1.1; }},
      {"materials[0].rho", [](Scene& s) { s.materials[0].spectra["rho"].wavelength_nm[0] = kNan; }},
      {"materials[0].table", [](Scene& s) { s.materials[0].table = s.materials[1].table; }},
      {"materials[1].table", [](Scene& s) { s.materials[1].table = nullptr; }},
      {"materials[1].table", [](Scene& s) { table_of(s).value.pop_back(); }},
      {"materials[1].table", [](Scene& s) { table_of(s).theta_i_rad.clear(); }},
      {"materials[1].table",
       [](Scene& s) {
         table_of(s).phi_rad = {0.0, 4.0};
       }},
      {"materials[1].table",
       [](Scene& s) {
         table_of(s).theta_o_rad = {1.0, 1.0};
       }},
      {"materials[1].table", [](Scene& s) { table_of(s).value[3] = -1.0; }},
      {"materials[1].table",
       [](Scene& s) {  // sizes whose product is 2^64, which a size holds as 0
         clray::BrdfTable& t = table_of(s);
         t.theta_i_rad.assign(1u << 22, 0.0);
         t.theta_o_rad = t.theta_i_rad;
         t.phi_rad.assign(1u << 20, 0.0);
         for (auto* axis : {&t.theta_i_rad, &t.theta_o_rad, &t.phi_rad})
           for (std::size_t i = 0; i < axis->size(); ++i) (*axis)[i] = 1e-7 * static_cast<double>(i);
         t.value.clear();
       }},
      {"components[0].mesh", [](Scene& s) { s.components[0].mesh = nullptr; }},
      {"components[0].mesh", [](Scene& s) { mesh_of(s).triangles.clear(); }},
      {"components[0].mesh", [](Scene& s) { mesh_of(s).vertices.clear(); }},
      {"components[0].mesh", [](Scene& s) { mesh_of(s).triangles[3][1] = 4000000000u; }},
      {"components[0].mesh", [](Scene& s) { mesh_of(s).triangle_slot[3] = 1; }},
      {"components[0].mesh", [](Scene& s) { mesh_of(s).triangle_slot.pop_back(); }},
      {"components[0].mesh", [](Scene& s) { mesh_of(s).material_slots.clear(); }},
      {"components[0].mesh.vertices[5]", [](Scene& s) { mesh_of(s).vertices[5].z = kNan; }},
      {"components[0].mesh.vertices[5]", [](Scene& s) { mesh_of(s).vertices[5].z = kInf; }},
      {"components[0].mesh.vertices[5]", [](Scene& s) { mesh_of(s).vertices[5].z = -1e200; }},
      {"components[0].mesh.vertices[0]", [](Scene& s) { s.components[0].transform.scale = 1e200; }},
      {"components[0].materials", [](Scene& s) { s.components[0].materials = {7}; }},
      {"components[0].materials", [](Scene& s) { s.components[0].materials.clear(); }},
      {"components[0].transform.axis",
       [](Scene& s) {
         s.components[0].transform.axis = {0, 0, 0};
       }},
      {"components[0].transform.axis",
       [](Scene& s) {
         s.components[0].transform.axis = {1, 1, 0};
       }},
      {"components[0].transform.angle_rad", [](Scene& s) { s.components[0].transform.angle_rad = 1e11; }},
      {"components[0].transform.scale", [](Scene& s) { s.components[0].transform.scale = 0.0; }},
      {"components[0].transform.scale", [](Scene& s) { s.components[0].transform.scale = -1.0; }},
      {"components[1].transform.translate", [](Scene& s) { s.components[1].transform.translate.x = 1e300; }},
      {"components[1].shape", [](Scene& s) { s.components[1].shape = "dsk"; }},
      {"components[1].radius", [](Scene& s) { s.components[1].parameters["radius"] = -1.0; }},
      {"components[1]", [](Scene& s) { s.components[1].parameters["radius"] = 1e200; }},
      {"components[1]", [](Scene& s) { s.components[1].parameters["radius"] = 0.4; }},
      {"components[1]", [](Scene& s) { s.components[1].transform.scale = 1e-200; }},
      {"components[1]", [](Scene& s) { s.components[1].parameters["height"] = 1.0; }},
      {"components[1].mesh", [](Scene& s) { s.components[1].mesh = std::make_shared<clray::Mesh>(); }},
      {"components[1].hinge.axis",
       [](Scene& s) {
         s.components[1].hinge->axis = {0, 0, 2};
       }},
      {"components[1].hinge.point", [](Scene& s) { s.components[1].hinge->point.x = kInf; }},
      {"components[1].hinge.angle_rad", [](Scene& s) { s.components[1].hinge->angle_rad = 1e20; }},
      {"variants[0].materials", [](Scene& s) { s.variants[0].materials[0].name = "nobody"; }},
      {"variants[0].materials", [](Scene& s) { s.variants[0].materials[0].parameters["rho"] = -1.0; }},
      {"source.direction",
       [](Scene& s) {
         s.source.direction = {0, 0, 2};
       }},
      {"source.direction",
       [](Scene& s) {
         s.source.direction = {0, 0, 0};
       }},
      {"source.direction",
       [](Scene& s) {
         s.source.direction = {kNan, 0, 1};
       }},
      {"source.wavelength_nm", [](Scene& s) { s.source.wavelength_nm = 0.0; }},
      {"source.bands",
       [](Scene& s) {
         s.source.kind = clray::Source::Kind::sun;
         s.source.bands = {{"a", 500.0, 400.0}};
       }},
      {"source.bands",
       [](Scene& s) {
         s.source.kind = clray::Source::Kind::sun;
         s.source.bands = {{"a", 400.0, 500.0}, {"a", 500.0, 600.0}};
       }},
      {"observers", [](Scene& s) { s.observers[1].name = s.observers[0].name; }},
      {"observers[0].direction",
       [](Scene& s) {
         s.observers[0].direction = {0, 0.5, 0};
       }},
      {"observers[1].acceptance_rad", [](Scene& s) { s.observers[1].acceptance_rad = -0.1; }},
      {"observers[1].range_m", [](Scene& s) { s.observers[1].range_m = kNan; }},
      {"detectors[0].kind", [](Scene& s) { s.detectors[0].kind = "dely"; }},
      {"detectors[0].bins", [](Scene& s) { s.detectors[0].parameters["bins"] = 0.5; }},
      {"detectors[0]", [](Scene& s) { s.detectors[0].parameters["width"] = 5.0; }},
      {"detectors", [](Scene& s) { s.detectors[0].name = "pressure"; }},
      {"motion.axis",
       [](Scene& s) {
         s.motion->axis = {0, 3, 0};
       }},
      {"motion.period_s", [](Scene& s) { s.motion->period_s = 0.0; }},
      {"motion.step_rad", [](Scene& s) { s.motion->step_rad = 0.0; }},
      {"motion", [](Scene& s) { s.motion->step_rad = 1e-12; }},
      {"motion.stop_s", [](Scene& s) { s.motion->stop_s = -1.0; }},
      {"motion.start_s", [](Scene& s) { s.motion->start_s = kNan; }},
      {"motion.attitudes",
       [](Scene& s) {
         s.motion->attitudes = {{0.0, {2, 0, 0, 0}}};
       }},
      {"motion.attitudes",
       [](Scene& s) {
         s.motion->attitudes = {{1.0, {1, 0, 0, 0}}, {0.0, {1, 0, 0, 0}}};
       }},
      {"station.range_m", [](Scene& s) { s.station->range_m = 0.0; }},
      {"station.ranges",
       [](Scene& s) {
         s.station->ranges = {{0.0, 1e6}, {0.0, 1e6}};
       }},
      {"station.eta_q", [](Scene& s) { s.station->eta_q = 2.0; }},
      {"trace.replicates", [](Scene& s) { s.trace.replicates = 0; }},
      {"trace.max_bounces", [](Scene& s) { s.trace.max_bounces = 0; }},
      {"trace.max_bounces", [](Scene& s) { s.trace.max_bounces = 1000; }},
      {"trace.target_error_percent", [](Scene& s) { s.trace.target_error_percent = kNan; }},
      {"trace.time_limit_s", [](Scene& s) { s.trace.time_limit_s = -1.0; }},
      {"trace.work_group_size", [](Scene& s) { s.trace.work_group_size = 0; }},
  };
}

/// The error that a call throws, as its context; anything else is a failure of the test.
std::string context_of(const std::string& call, ErrorCode code, const std::function<void()>& function) {
  CAPTURE(call);
  try {
    function();
  } catch (const Error& error) {
    CHECK(error.code() == code);
    return error.context();
  }
  CHECK_MESSAGE(false, "no error");
  return "";
}

/// A folder that nothing must be written into.
struct Folder {
  std::string name = (std::filesystem::temp_directory_path() / "clray-api-XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(name.data()) != nullptr); }
  ~Folder() { std::filesystem::remove_all(name); }
};

}  // namespace

TEST_CASE("every fault of a scene is an error that names it, at every function that takes a scene") {
  const Folder folder;
  const Scene good = full_scene();
  REQUIRE_NOTHROW(clray::check_scene(good));
  const clray::Result result = clray::trace(good, device());
  for (const Fault& fault : faults()) {
    CAPTURE(fault.where);
    Scene bad = good;
    fault.make(bad);
    const std::pair<std::string, std::function<void()>> calls[] = {
        {"check_scene", [&] { clray::check_scene(bad); }},
        {"trace", [&] { clray::trace(bad, device()); }},
        {"kernel_source", [&] { clray::kernel_source(bad, device()); }},
        {"describe_scene", [&] { clray::describe_scene(bad); }},
        {"write_result", [&] { clray::write_result(result, bad, folder.name + "/out"); }},
        {"write_session", [&] { clray::write_session(result, bad, folder.name); }},
        {"session_files", [&] { clray::session_files(result, bad, folder.name); }},
        {"link_budget_text", [&] { clray::link_budget_text(bad, result); }},
        {"expect_photons",
         [&] {
           clray::Result copy = result;
           clray::expect_photons(bad, &copy);
         }},
    };
    for (const auto& one : calls) {
      CAPTURE(one.first);
      CHECK(context_of(one.first, ErrorCode::input, one.second).rfind(fault.where, 0) == 0);
    }
  }
  CHECK(std::filesystem::is_empty(folder.name));
}

TEST_CASE("every fault of a result is an error that names it, at every function that writes one") {
  const Folder folder;
  const Scene scene = full_scene();
  const clray::Result good = clray::trace(scene, device());
  REQUIRE(good.orientations.size() > 1);
  const std::pair<std::string, std::function<void(clray::Result&)>> cases[] = {
      {"delay[1].bin_m2_per_sr", [](clray::Result& r) { r.delay[1].bin_m2_per_sr.clear(); }},
      {"delay[1].bin_standard_error", [](clray::Result& r) { r.delay[1].bin_standard_error.pop_back(); }},
      {"delay[1].bin_upper_bound", [](clray::Result& r) { r.delay[1].bin_upper_bound.clear(); }},
      {"delay[1].hits", [](clray::Result& r) { r.delay[1].hits.push_back(0); }},
      {"delay[1].resolved", [](clray::Result& r) { r.delay[1].resolved.pop_back(); }},
      {"delay[1].photons_per_ns", [](clray::Result& r) { r.delay[1].photons_per_ns = {1.0}; }},
      {"delay[1].bin_width_s", [](clray::Result& r) { r.delay[1].bin_width_s = 0.0; }},
      {"delay[1].first_bin_start_s", [](clray::Result& r) { r.delay[1].first_bin_start_s = kNan; }},
      {"delay[1].key.orientation", [](clray::Result& r) { r.delay[1].key.orientation = 77; }},
      {"pressure[0].component_m2", [](clray::Result& r) { r.pressure[0].component_m2.pop_back(); }},
      {"pressure[0].component_m3", [](clray::Result& r) { r.pressure[0].component_m3.clear(); }},
      {"orientations[1].time_s", [](clray::Result& r) { r.orientations[1].time_s = kInf; }},
      {"orientations[1].observers", [](clray::Result& r) { r.orientations[1].observers.pop_back(); }},
      {"image[0]", [](clray::Result& r) { r.image.push_back({}); }},
  };
  for (const auto& one : cases) {
    CAPTURE(one.first);
    clray::Result bad = good;
    one.second(bad);
    CHECK(context_of("check", ErrorCode::usage, [&] { clray::check_result(bad, scene); }).rfind(one.first, 0) == 0);
    const auto write = [&] { clray::write_result(bad, scene, folder.name + "/out"); };
    CHECK(context_of("write_result", ErrorCode::usage, write).rfind(one.first, 0) == 0);
    const auto session = [&] { clray::write_session(bad, scene, folder.name); };
    CHECK(context_of("write_session", ErrorCode::usage, session).rfind(one.first, 0) == 0);
    const auto photons = [&] { clray::expect_photons(scene, &bad); };
    CHECK(context_of("expect_photons", ErrorCode::usage, photons).rfind(one.first, 0) == 0);
  }
  CHECK(std::filesystem::is_empty(folder.name));
}

TEST_CASE("pictures whose pixels and bands do not fit are refused") {
  Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  detect(scene, "rgb", {{"width", 8.0}, {"height", 6.0}, {"samples", 1.0}});
  const clray::Result good = clray::trace(scene, device());
  const Folder folder;
  const std::pair<std::string, std::function<void(clray::ImageResult&)>> cases[] = {
      {"image[0]", [](clray::ImageResult& i) { i.width = 0; }},
      {"image[0]", [](clray::ImageResult& i) { i.height = -6; }},
      {"image[0].radiance_per_sr",
       [](clray::ImageResult& i) {
         i.width = 9;
         i.coverage.clear();
       }},
      {"image[0].radiance_per_sr", [](clray::ImageResult& i) { i.radiance_per_sr.clear(); }},
      {"image[0].standard_error_per_sr", [](clray::ImageResult& i) { i.standard_error_per_sr.resize(5); }},
      {"image[0].coverage", [](clray::ImageResult& i) { i.coverage.resize(5); }},
      {"image[0].bands", [](clray::ImageResult& i) { i.bands.clear(); }},
      {"image[0].band_source_W_m2", [](clray::ImageResult& i) { i.band_source_W_m2.clear(); }},
      {"image[0].pixel_m", [](clray::ImageResult& i) { i.pixel_m = kNan; }},
  };
  for (const auto& one : cases) {
    CAPTURE(one.first);
    clray::Result bad = good;
    one.second(bad.image[0]);
    const auto write = [&] { clray::write_result(bad, scene, folder.name + "/out"); };
    CHECK(context_of("write_result", ErrorCode::usage, write) == one.first);
  }
  CHECK(std::filesystem::is_empty(folder.name));
}

TEST_CASE("the other public functions refuse what makes no sense") {
  const std::string mesh = std::string(CLRAY_SOURCE_DIR) + "/meshes/box_wing.obj";
  for (const double unit : {0.0, -1.0, kNan, kInf, 1e300}) CHECK_THROWS_AS(clray::load_mesh(mesh, unit), Error);
  CHECK_THROWS_AS(clray::load_mesh(""), Error);
  CHECK_THROWS_AS(clray::load_scene(""), Error);
  CHECK_THROWS_AS(clray::load_scene(std::string("a\0b.toml", 8)), Error);
  CHECK_THROWS_AS(clray::describe_scene({}), Error);
  CHECK_THROWS_AS(clray::photons_per_ns({}, {}, 1e6), Error);
  clray::DelayResult delay;
  delay.bin_width_s = 1e-10;
  delay.bin_m2_per_sr = {1.0};
  CHECK(clray::photons_per_ns(delay, {}, 1e6).size() == 1);
  for (const double range : {0.0, -1.0, kNan, kInf}) CHECK_THROWS_AS(clray::photons_per_ns(delay, {}, range), Error);
  CHECK_THROWS_AS(clray::photons_per_ns(delay, {}, 1e6, kNan), Error);
  CHECK_THROWS_AS(clray::expect_photons(full_scene(), nullptr), Error);
  CHECK_THROWS_AS(clray::load_reference(""), Error);
  CHECK_THROWS_AS(clray::load_reference("/"), Error);
  CHECK_THROWS_AS(clray::check_output(""), Error);
  CHECK_FALSE(clray::has_session({}));
  CHECK(std::isnan(clray::relative_true_error({}, {})));
  CHECK(clray::format_with_error(kNan, kNan) == "n/a");
}

TEST_CASE("text that is not JSON does not enter the summary") {
  const Folder folder;
  Scene scene = scene_of("sphere", {{"radius", 1.0}}, lambert(0.5));
  rays(scene, 10);
  clray::WriteOptions options;
  options.plots = false;
  options.more.push_back([](const std::string&) { return clray::MoreFiles{{}, "mine", "{not json"}; });
  try {
    clray::write_result(clray::trace(scene, device()), scene, folder.name + "/out", options);
    FAIL("no error");
  } catch (const Error& e) {  // nothing appears; what was finished stays where the message says
    CHECK((e.code() == ErrorCode::usage && e.context() == "MoreFiles.mine"));
    CHECK_FALSE(std::filesystem::exists(folder.name + "/out"));
    CHECK(std::filesystem::exists(e.message().substr(e.message().find(" are in ") + 8) + "/delay.csv"));
  }
}

TEST_CASE("results have the same bits under every walk through the BVH") {
  // Nearest hits and shadows, over two bounces, on a tree of several levels.
  Scene scene = scene_of(sphere_mesh(16, 8, 1.0), lambert(0.5));
  add(scene, "box", {}, lambert(0.8)).transform.translate = {1.5, 0.3, 0.2};
  scene.observers[0].monostatic = false;
  scene.observers[0].direction = {1.0, 0.0, 0.0};
  scene.trace.max_bounces = 2;
  rays(scene, 12);
  std::set<std::uint64_t> digests;
  for (const std::string& walk : clray::table_rows("walk")) {
    scene.trace.walk = walk;
    digests.insert(run(scene).digest);
  }
  CHECK(clray::table_rows("walk").size() > 1);
  CHECK(digests.size() == 1);
}
