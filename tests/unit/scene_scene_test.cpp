// SPDX-License-Identifier: Apache-2.0
// Loading scenes: every key arrives, in SI; bare meshes; what the command line overrides; checks of scenes by hand;
// the scenes in meshes/. A little over 400 lines: all of it is about one call, load_scene.
#include <doctest/doctest.h>

#include <cmath>

#include "scene/motion.hpp"
#include "scene/spectrum.hpp"
#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::check_of;
using clray::test::SceneFolder;

namespace {

constexpr double kPi = 3.14159265358979323846;
const std::string kBall = "component = [{ shape = \"sphere\" }]\n";

std::string usage_of(const std::string& file, const SceneOptions& options) {
  try {
    load_scene(file, options);
  } catch (const Error& e) {
    return e.code() == ErrorCode::usage ? e.what() : "wrong code";
  }
  return "fine";
}

}  // namespace

TEST_CASE("scene: materials, components and variants arrive whole") {
  const SceneFolder f;
  f.write("panel.csv", "wavelength_nm,rho\n400,0.1\n700,0.3\n");
  f.write("table.csv", "0,0,0,0.1\n0,90,0,0.2\n90,0,0,0.2\n90,90,0,0.3\n");
  const Scene s = f.load(R"(length_unit = "mm"
reference_point = [1, 2.5, -3]
[[material]]
name = "panel"
model = "ashikhmin-shirley"
rho = "panel.csv"
d = 0.2
n = 500
f0 = 0.04
two_sided = false
infrared_reflectance = 0.1
[[material]]
name = "tab"
model = "tabulated"
file = "table.csv"
scale = 0.5
[[component]]
name = "bus"
file = "plate.obj"
materials = { solar = "panel" }
material = "tab"
[[component]]
shape = "mesh"
file = "./plate.obj"
material = "panel"
[[component]]
name = "tank"
shape = "cylinder"
radius = 2
height = 3.5
capped = false
material = "tab"
transform = { translate = [1, 2, 3], axis = [0, 0, 2], angle_deg = 90, scale = 4 }
hinge = { axis = [0, -3, 0], point = [4, 5, 6], angle_deg = 180, follow = "observer" }
[[component]]
shape = "box"
size = [1, 2, 3]
material = "tab"
[[variant]]
name = "dull"
material = [{ name = "panel", n = 50, rho = 0.9 }, { name = "tab", model = "lambert" }]
)");
  CHECK(s.reference_point == Vec3(1, 2.5, -3));
  REQUIRE(s.materials.size() == 2);
  CHECK(s.materials[0].spectra.at("rho").value == std::vector<double>{0.1, 0.3});
  CHECK(s.materials[0].parameters == std::map<std::string, double>{{"d", 0.2}, {"n", 500}, {"f0", 0.04}});
  CHECK_FALSE(s.materials[0].two_sided);
  CHECK(s.materials[0].infrared_reflectance == 0.1);
  CHECK(s.materials[1].table->value.size() == 4);
  REQUIRE(s.components.size() == 4);
  CHECK(s.components[0].materials == std::vector<std::uint32_t>{0, 1});
  CHECK(s.components[0].mesh->report.area_m2 == doctest::Approx(4e-6).epsilon(1e-12));
  CHECK(s.components[1].mesh == s.components[0].mesh);
  CHECK(s.components[1].name == "mesh");
  CHECK(s.components[1].materials == std::vector<std::uint32_t>{0, 0});
  const Component& tank = s.components[2];
  CHECK(tank.parameters == std::map<std::string, double>{{"radius", 2}, {"height", 3.5}, {"capped", 0}});
  CHECK(tank.transform.translate == Vec3(1, 2, 3));
  CHECK(tank.transform.axis == Vec3(0, 0, 1));
  CHECK(tank.transform.angle_rad == kPi / 2);
  CHECK(tank.transform.scale == 4.0);
  CHECK(tank.hinge->axis == Vec3(0, -1, 0));
  CHECK(tank.hinge->point == Vec3(4, 5, 6));
  CHECK(tank.hinge->angle_rad == kPi);
  CHECK(tank.hinge->follow == Hinge::Follow::observer);
  CHECK(s.components[3].parameters.at("size_z") == 3.0);
  REQUIRE(s.variants.size() == 1);
  const Material& dull = s.variants[0].materials[0];
  CHECK(dull.spectra.empty());
  CHECK(dull.parameters == std::map<std::string, double>{{"d", 0.2}, {"n", 50}, {"f0", 0.04}, {"rho", 0.9}});
  CHECK_FALSE(dull.two_sided);
  CHECK(s.variants[0].materials[1].model == "lambert");
  CHECK(s.variants[0].materials[1].parameters.empty());
}

TEST_CASE("scene: light, motion, station, detectors and trace arrive in SI") {
  const SceneFolder f;
  f.write("pulse.csv", "time_ps,power\n0,0\n10,1\n20,0\n");
  f.write("range.csv", "0,1e6\n30,1.1e6\n");
  const Scene s = f.load(kBall + R"([source]
kind = "sun"
direction = [0, 3, 4]
bands = [[400, 500], { low_nm = 500, high_nm = 600, name = "green" }]
blackbody_K = 5000
irradiance_W_m2 = 1000
[[observer]]
name = "a"
[[observer]]
name = "b"
direction = [-2, 0, 0]
acceptance_mrad = 5
[motion]
axis = [0, 2, 0]
period_s = 40
phase_deg = 90
start_s = 1
stop_s = 21
step_deg = 2
[station]
name = "hill"
ranges = "range.csv"
position_m = [6e6, 1, 2]
start_mjd = 60000.5
pulse_energy_J = 0.1
pulse = "pulse.csv"
rate_Hz = 100
aperture_m = 0.75
divergence_urad = 25
pointing_urad = 2
eta_q = 0.1
eta_t = 0.2
eta_r = 0.3
T_a = 0.4
T_c = 0.5
noise_per_ns = 0.002
dark_per_ns = 0.003
gate_ns = 100
jitter_fwhm_ps = 30
dead_time_ns = 40
flag_signal = true
[[detector]]
kind = "delay"
bins = 100
start_ns = -5
stop_ns = 5.5
[[detector]]
kind = "pressure"
name = "push"
thermal = true
[trace]
max_bounces = 3
target_error_percent = 0.5
rays = 1e6
time_limit_s = 60
max_rays = 4194304
seed = 7
sampler = "random"
replicates = 32
)");
  CHECK(s.source.kind == Source::Kind::sun);
  CHECK(s.source.direction == Vec3(0, 0.6, 0.8));
  CHECK(s.source.bands[1].name == "green");
  CHECK(s.source.bands[0].high_nm == 500.0);
  CHECK(s.source.blackbody_K == 5000.0);
  CHECK(s.source.irradiance_W_m2 == 1000.0);
  CHECK(s.observers[0].monostatic);
  CHECK(s.observers[0].direction == s.source.direction);
  CHECK_FALSE(s.observers[1].monostatic);
  CHECK(s.observers[1].direction == Vec3(-1, 0, 0));
  CHECK(s.observers[1].acceptance_rad == 5e-3);
  CHECK(s.motion->phase_rad == kPi / 2);
  CHECK(orientations(s).size() == 91);
  const Station& t = *s.station;
  CHECK(t.name == "hill");
  CHECK(t.ranges[1] == std::pair<double, double>(30, 1.1e6));
  CHECK(t.position_m == Vec3(6e6, 1, 2));
  CHECK(t.start_mjd == 60000.5);
  CHECK(t.pulse_energy_J == 0.1);
  CHECK(t.pulse[1] == std::pair<double, double>(1e-11, 1));
  CHECK(t.rate_Hz == 100.0);
  CHECK(t.aperture_m == 0.75);
  CHECK(t.divergence_rad == 25e-6);
  CHECK(t.pointing_rad == 2e-6);
  CHECK(t.eta_q + t.eta_t + t.eta_r + t.T_a + t.T_c == doctest::Approx(1.5));
  CHECK(t.eta_t == 0.2);
  CHECK(t.noise_per_ns == 0.002);
  CHECK(t.dark_per_ns == 0.003);
  CHECK(t.gate_s == 1e-7);
  CHECK(t.jitter_fwhm_s == 3e-11);
  CHECK(t.dead_time_s == 4e-8);
  CHECK(t.flag_signal);
  CHECK(s.detectors[0].name == "delay");
  CHECK(s.detectors[0].parameters == std::map<std::string, double>{{"bins", 100}, {"start_ns", -5}, {"stop_ns", 5.5}});
  CHECK(s.detectors[1].name == "push");
  CHECK(s.detectors[1].parameters.at("thermal") == 1.0);
  CHECK(s.trace.max_bounces == 3);
  CHECK(s.trace.target_error_percent == 0.5);
  CHECK(s.trace.rays == 1000000);
  CHECK(s.trace.time_limit_s == 60.0);
  CHECK(s.trace.max_rays == 4194304);
  CHECK(s.trace.seed == 7);
  CHECK(s.trace.sampler == SamplerKind::random);
  CHECK(s.trace.replicates == 32);
}

TEST_CASE("scene: defaults of a file that says little") {
  const SceneFolder f;
  const Scene s = f.load(kBall);
  CHECK(s.name == "s");
  REQUIRE(s.observers.size() == 1);
  CHECK(s.observers[0].monostatic);
  CHECK(s.detectors[0].kind == "delay");
  CHECK(s.materials[0].parameters.at("rho") == 0.5);
  CHECK(s.warnings.size() == 1);
  CHECK(orientations(s)[0].source == Vec3(0, 0, 1));
}

TEST_CASE("scene: a bare mesh, and its MTL") {
  const SceneFolder f;
  const Scene plain = load_scene(f.path("plate.obj"));
  CHECK(plain.source.wavelength_nm == 532.0);
  CHECK(plain.source.direction == Vec3(0, 0, 1));
  CHECK(plain.observers[0].monostatic);
  CHECK(plain.detectors[0].kind == "delay");
  REQUIRE(plain.materials.size() == 1);
  CHECK(plain.materials[0].model == "lambert");
  CHECK(plain.materials[0].parameters.at("rho") == 0.5);
  CHECK(plain.components[0].materials == std::vector<std::uint32_t>{0, 0});
  f.write("a.mtl", "newmtl solar\nKd 0.4 0.4 0.4\nKs 0.1 0.1 0.1\nNs 50\nillum 2\n");
  const std::string with =
      "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl solar\nf 1 2 3\nusemtl foil\nf 1 3 4\n";
  const Scene mtl = load_scene(f.write("m.obj", with));
  REQUIRE(mtl.materials.size() == 2);
  CHECK(mtl.materials[0].model == "ashikhmin-shirley");
  CHECK(mtl.materials[0].parameters.at("rho") == doctest::Approx(0.5));
  CHECK(mtl.materials[1].model == "lambert");
  // Two meshes with one name for two things keep both; a scene's own material of that name wins over the MTL's.
  f.write("b.mtl", "newmtl solar\nKd 0.9 0.9 0.9\n");
  f.write("n.obj", "mtllib b.mtl" + with.substr(12));
  const Scene both =
      f.load("[[component]]\nname = \"m\"\nfile = \"m.obj\"\n[[component]]\nname = \"n\"\nfile = \"n.obj\"\n");
  CHECK(both.materials[both.components[1].materials[0]].name == "solar (n)");
  const Scene own = f.load("[[material]]\nname = \"solar\"\nmodel = \"mirror\"\n[[component]]\nfile = \"m.obj\"\n");
  CHECK(own.materials[own.components[0].materials[0]].model == "mirror");
}

TEST_CASE("scene: the command line overrides") {
  const SceneFolder f;
  SceneOptions o;
  o.material = "ashikhmin-shirley rho=0.5 d=0.2 n=50 two_sided=false";
  o.source = Vec3(0, 0, 5);
  o.observer = Vec3(3, 0, 4);
  o.detectors = {"delay", "pressure"};
  o.bins = 64;
  o.length_unit_m = 0.5;
  const std::string text =
      "length_unit = \"mm\"\n[[component]]\nfile = \"plate.obj\"\n[[detector]]\nkind = \"delay\"\nbin_ps = "
      "10\nstart_ns = 1\n";
  const Scene s = f.load(text, o);
  REQUIRE(s.materials.size() == 1);
  CHECK(s.materials[0].parameters == std::map<std::string, double>{{"rho", 0.5}, {"d", 0.2}, {"n", 50}});
  CHECK_FALSE(s.materials[0].two_sided);
  CHECK(s.components[0].materials == std::vector<std::uint32_t>{0, 0});
  CHECK(s.components[0].mesh->report.area_m2 == doctest::Approx(1.0));
  CHECK(s.source.direction == Vec3(0, 0, 1));
  CHECK(s.observers[0].direction == Vec3(0.6, 0, 0.8));
  CHECK_FALSE(s.observers[0].monostatic);
  REQUIRE(s.detectors.size() == 2);
  CHECK(s.detectors[0].parameters == std::map<std::string, double>{{"bins", 64}, {"start_ns", 1}});
  o.observer.reset();
  o.observer_at_source = true;
  CHECK(f.load(text, o).observers[0].monostatic);
}

TEST_CASE("scene: arguments that make no sense") {
  const SceneFolder f;
  const std::string file = f.path("plate.obj");
  const auto material = [&](const std::string& text) {
    SceneOptions o;
    o.material = text;
    return usage_of(file, o);
  };
  CHECK(material("lambrt rho=1").find("--material: unknown model 'lambrt'; expected one of lambert, ") == 0);
  CHECK(material("lambert rho=2") == "--material: rho: expected a number in [0,1], found '2'");
  CHECK(material("lambert rho=x") == "--material: rho: expected a number in [0,1], found 'x'");
  CHECK(material("lambert rho") == "--material: expected key=value, found 'rho'");
  CHECK(material("lambert rhoo=1") ==
        "--material: unknown key 'rhoo' of model 'lambert'; expected one of two_sided, infrared_reflectance, rho; did "
        "you mean 'rho'?");
  CHECK(material("  ") == "--material: expected \"model key=value …\", found nothing");
  CHECK(material("tabulated") == "--material: model 'tabulated' needs file=TABLE.csv");
  SceneOptions o;
  o.source = Vec3(0.0);
  CHECK(usage_of(file, o) == "--source: expected three finite numbers X,Y,Z that are not all zero");
  o = {};
  o.detectors = {"dely"};
  CHECK(usage_of(file, o).find("; did you mean 'delay'?") != std::string::npos);
  o = {};
  o.bins = 0;
  CHECK(usage_of(file, o) == "--bins: expected a whole number in [1..1e7]");
  CHECK_THROWS_WITH_AS(load_scene(f.path("no.toml")), doctest::Contains("no.toml: there is no such file"), Error);
  CHECK_THROWS_WITH_AS(load_scene(f.path("x.step")), doctest::Contains("expected a scene file (.toml) or a mesh"),
                       Error);
}

TEST_CASE("scene: scenes built by hand are checked") {
  const SceneFolder f;
  const Scene good = f.load(kBall);
  CHECK(check_of(good) == "fine");
  Scene s = good;
  s.source.direction = {0, 0, 2};
  CHECK(check_of(s) == "source.direction: expected a unit vector, found length 2");
  s = good;
  s.components[0].parameters["radius"] = -1;
  CHECK(check_of(s) == "components[0].radius: expected a number in (0,inf), found -1");
  s = good;
  s.components[0].parameters["radus"] = 1;
  CHECK(check_of(s) == "components[0]: unknown key 'radus' of 'sphere'; did you mean 'radius'?");
  s = good;
  s.components[0].shape = "mesh";
  s.components[0].parameters.clear();
  CHECK(check_of(s) == "components[0].mesh: missing; expected a mesh with triangles");
  s = good;
  s.components[0].materials = {3};
  CHECK(check_of(s) == "components[0].materials: there is no material 3");
  s = good;
  s.components[0].materials.clear();
  CHECK(check_of(s) == "components[0].materials: expected 1 of them, found 0");
  s = good;
  s.materials[0].model = "tabulated";
  s.materials[0].parameters.clear();
  CHECK(check_of(s) == "materials[0].table: missing; the model 'tabulated' needs a table");
  s = good;
  s.materials[0].spectra["rho"] = {{500, 400}, {0.1, 0.2}};
  CHECK(check_of(s) == "materials[0].rho: wavelengths must increase");
  s = good;
  s.observers.push_back(s.observers[0]);
  CHECK(check_of(s) == "observers: a second one of the name \"\"");
  s = good;
  s.detectors.clear();
  CHECK(check_of(s) == "detectors: missing; expected at least one");
  s = good;
  s.components[0].transform.scale = NAN;
  CHECK(check_of(s) == "components[0].transform.scale: expected a number in (0,inf), found nan");
  s = good;
  s.motion = Motion{};
  CHECK(check_of(s) == "motion.period_s: expected a number in (0,inf), found 0");
  s = good;
  s.station = Station{};
  s.station->eta_q = 1.5;
  CHECK(check_of(s) == "station.eta_q: expected a number in [0,1], found 1.5");
  s = good;
  s.trace.replicates = 1;
  CHECK(check_of(s) == "trace.replicates: expected a whole number in [2..64], found 1");
}

TEST_CASE("scene: the scenes in meshes/ load, and are described") {
  const std::string folder = std::string(CLRAY_SOURCE_DIR) + "/meshes/";
  const std::pair<const char*, std::size_t> paper[] = {{"hexprism", 181}, {"cylinder", 91}, {"box_wing", 91}};
  for (const auto& [name, steps] : paper) {
    const Scene s = load_scene(folder + name + ".toml");
    CHECK(s.warnings.empty());
    CHECK(s.variants.size() == 12);
    CHECK(orientations(s).size() == steps);
    CHECK(s.station->rate_Hz == 2000.0);
    CHECK(describe_scene(s).find("variants (12)") != std::string::npos);
  }
  const Scene rich = load_scene(folder + "rich.toml");
  CHECK(rich.warnings.empty());
  CHECK(rich.materials.size() == 4);
  CHECK(rich.trace.max_bounces == 8);
  CHECK(rich.components[0].mesh == rich.components[3].mesh);
  CHECK(rich.observers.size() == 2);
  CHECK(bands_of(rich).size() == 3);
  const std::string text = describe_scene(rich);
  for (const char* part : {"bus ", "paraboloid", "follows the source", "spectrum of 11 points, d 0.3, n 200, f0 = rho",
                           "2 x 1 x 1.73205 m", "max_bounces 8", "name at the Sun, direction source"}) {
    CHECK(text.find(part) != std::string::npos);
  }
}
