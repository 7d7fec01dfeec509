// SPDX-License-Identifier: Apache-2.0
// Observers and grids that options or keys change together, and the bounds of angles, sizes and places.
#include <doctest/doctest.h>

#include <cmath>

#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::check_of;
using clray::test::SceneFolder;

TEST_CASE("rules between sections name the place in the file, and a bare mesh's its file") {
  const SceneFolder f;
  const std::string ball = "[[component]]\nshape = \"sphere\"\n";
  CHECK(f.complaint(ball + "[observer]\ndirection = \"station\"\n").find("s.toml:4:13: observer.direction: moves") ==
        0);
  CHECK(f.complaint(ball + "[[observer]]\nname = \"a\"\n[[observer]]\nname = \"b\"\ndirection = \"station\"\n")
            .find("s.toml:7:13: observer.direction: moves") == 0);
  CHECK(f.complaint(ball + "[source]\ndirection = \"sun\"\n").find("s.toml:4:13: source.direction: moves") == 0);
  CHECK(f.complaint(ball +
                    "[motion]\naxis = [0, 1, 0]\nperiod_s = 60\nstop_s = 1\nstep_deg = 3\n[station]\nrate_Hz = 1e12\n")
            .find("s.toml:9:11: station.rate_Hz: makes 1e+12 shots") == 0);
  SceneOptions option;
  option.detectors = {"delay", "delays"};
  CHECK(f.complaint(ball, ErrorCode::usage, option).find("--detector: ") == 0);
  CHECK_THROWS_WITH(load_scene(f.write("far.obj", "v 1e12 0 0\nv 1000000000001 0 0\nv 1e12 1 0\nf 1 2 3\n")),
                    doctest::Contains("far.obj: transform: the component, 1 m large"));
}

TEST_CASE("scene: --observer keeps what the scene says of its observers but for the direction") {
  const SceneFolder f;
  const std::string plate = "[[component]]\nfile = \"plate.obj\"\n[source]\nkind = \"sun\"\n";
  SceneOptions side, source;
  side.observer = Vec3(3, 0, 4);
  source.observer_at_source = true;
  const std::string one =
      plate + "[observer]\nname = \"east\"\ndirection = [1, 0, 0]\nrange_m = 5e5\nacceptance_mrad = 3\n";
  for (const SceneOptions* o : {&side, &source}) {
    const Scene s = f.load(one, *o);
    REQUIRE(s.observers.size() == 1);
    CHECK(s.observers[0].name == "east");
    CHECK(s.observers[0].range_m == 5e5);
    CHECK(s.observers[0].acceptance_rad == 3e-3);
    CHECK(s.observers[0].monostatic == (o == &source));
    CHECK(s.observers[0].direction == (o == &source ? Vec3(0, 0, 1) : Vec3(0.6, 0, 0.8)));
  }
  // Of several observers, what they share.
  const std::string two = plate +
                          "[[observer]]\nname = \"a\"\nrange_m = 5e5\nacceptance_mrad = 3\n"
                          "[[observer]]\nname = \"b\"\nrange_m = 6e5\nacceptance_mrad = 3\n";
  const Scene s = f.load(two, side);
  REQUIRE(s.observers.size() == 1);
  CHECK(s.observers[0].range_m == 0.0);
  CHECK(s.observers[0].acceptance_rad == 3e-3);
  CHECK(s.warnings.back() ==
        "--observer stands instead of the scene's 2 observers; they differ in range_m, which is left out");
}

TEST_CASE("scene: a grid of Sun directions needs both counts") {
  const SceneFolder f;
  const std::string text = "[[component]]\nfile = \"plate.obj\"\n[[detector]]\nkind = \"pressure\"\n";
  CHECK(f.complaint(text + "azimuth_steps = 12\n") ==
        "s.toml:3:1: detector.elevation_steps: a grid of Sun directions has at least 2 (-90 and 90 degrees) beside "
        "azimuth_steps = 12, found 0");
  CHECK(f.complaint(text + "azimuth_steps = 12\nelevation_steps = 1\n").find("s.toml:6:19: detector.elevation_steps") ==
        0);
  CHECK(f.complaint(text + "elevation_steps = 7\n")
            .find("detector.azimuth_steps: a grid of Sun directions has at least 1 "
                  "beside elevation_steps = 7, found 0") != std::string::npos);
  CHECK(f.complaint(text + "azimuth_steps = 1\nelevation_steps = 2\n") == "fine");
  Scene s = f.load(text);
  s.detectors = {{"delay", "", {}}, {"delay", "delay", {}}};
  CHECK(check_of(s) == "detectors: a second one of the name \"delay\"");
}

TEST_CASE("scene: whole turns leave angles exactly; places too far out for a shape are refused") {
  const SceneFolder f;
  const auto part = [](const std::string& more) {
    return "[[component]]\nshape = \"box\"\nsize = [1, 2, 1]\n" + more +
           "\n[[material]]\nname = \"default\"\nmodel = \"lambert\"\n";
  };
  // 1e6 degrees are 2777 turns and 280 degrees, 1e11 are 277777777 turns and 280 degrees.
  const double expected = 280.0 / 180.0 * 3.14159265358979323846;
  CHECK(f.load(part("hinge = { axis = [0, 0, 1], angle_deg = 1e6 }")).components[0].hinge->angle_rad == expected);
  CHECK(f.load(part("transform = { angle_deg = -1e6 }")).components[0].transform.angle_rad == -expected);
  CHECK(f.load(part("") + "[motion]\naxis = [0, 0, 1]\nperiod_s = 1\nstop_s = 1\nstep_deg = 360\nphase_deg = 1e11\n")
            .motion->phase_rad == expected);
  CHECK(f.complaint(part("transform = { translate = [1e12, 0, 0] }")) ==
        "s.toml:1:1: component.transform: the component, 2 m large, lies 1e+12 m from the origin, where positions have "
        "no "
        "digits left for its shape; expected at most 1e+11 times its size");
  CHECK(f.complaint(part("transform = { translate = [1e11, 0, 0] }")) == "fine");
  CHECK(f.complaint(part("transform = { translate = [1e3, 0, 0], scale = 1e-9 }")).find("component.transform: ") !=
        std::string::npos);
  CHECK(f.complaint(part("hinge = { axis = [0, 0, 1], point = [0, 0, 1e13] }")).find("component.transform: ") !=
        std::string::npos);
  CHECK(f.complaint("reference_point = [1e12, 0, 0]\n" + part("")).find("s.toml:1:19: reference_point: lies 1e+12 m") ==
        0);
  f.write("far.obj", "v 1e14 0 0\nv 1.00000000000001e14 0 0\nv 1e14 1 0\nf 1 2 3\n");
  CHECK(f.complaint("[[component]]\nfile = \"far.obj\"\n").find("s.toml:1:1: component.transform: ") == 0);
}
