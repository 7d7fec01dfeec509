// SPDX-License-Identifier: Apache-2.0
// Every class of error in a scene file, with its exact place and words: file:line:column, the key, what was expected.
#include <doctest/doctest.h>

#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::SceneFolder;

namespace {

/// A component on line 1, so that what follows begins on line 2.
const std::string kBall = "component = [{ shape = \"sphere\" }]\n";

}  // namespace

TEST_CASE("toml: what is no TOML") {
  const SceneFolder f;
  CHECK(f.complaint("a = \n").compare(0, 21, "s.toml:1:5: not TOML:") == 0);
  CHECK(f.complaint("[source]\nkind = \"sun\"\nkind = \"laser\"\n") ==
        "s.toml:3:8: not TOML: Error while parsing key-value pair: cannot redefine existing string 'kind'");
  CHECK(f.complaint("[source]\n[source]\n").find("s.toml:2:") == 0);
  // Each of these met an assertion of the parser, which ends a debug build.
  for (const char* text :
       {"[=",       "[",        "[[",         "[[=",  "a = 90°", "a = ",   "a = \x01",         "a = _1",
        "= 1",      "a.= 1",    "a = [1,,2]", "\x7f", "a = 1°",  "a = +é", "a = 2020-01-01 é", "[a.",
        "a = {=1}", "a = \"\\", "\"",         "'",    "a = 0x",  "a=,",    "\xff\xfe"}) {
    CAPTURE(text);
    CHECK(f.complaint(text).find("not TOML: ") != std::string::npos);
  }
  CHECK(f.complaint("") == "s.toml:1:1: component: missing; expected at least one [[component]]");
}

TEST_CASE("toml: unknown keys and near misses") {
  const SceneFolder f;
  CHECK(f.complaint(kBall + "[source]\nwavelenght_nm = 532\n") ==
        "s.toml:3:1: unknown key 'wavelenght_nm' in [source]; did you mean 'wavelength_nm'?");
  CHECK(f.complaint(kBall + "[sorce]\n") == "s.toml:2:2: unknown key 'sorce'; did you mean 'source'?");
  CHECK(f.complaint(kBall + "[station]\nrange_km = 1\n") ==
        "s.toml:3:1: unknown key 'range_km' in [station]; did you mean 'range_m'?");
  CHECK(f.complaint("[[component]]\nshape = \"sphere\"\nheight = 2\n") ==
        "s.toml:3:1: unknown key 'height' in [component]; expected one of hinge, material, name, radius, shape, "
        "transform");
  CHECK(f.complaint("[[component]]\nshape = \"sphere\"\n  radus = 2\n") ==
        "s.toml:3:3: unknown key 'radus' in [component]; did you mean 'radius'?");
  CHECK(f.complaint("[[material]]\nnmae = \"a\"\n" + kBall) ==
        "s.toml:2:1: unknown key 'nmae' in [material]; did you mean 'name'?");
  CHECK(f.complaint(kBall + "[[detector]]\nkind = \"delay\"\nbns = 3\n") ==
        "s.toml:4:1: unknown key 'bns' in [detector]; did you mean 'bins'?");
  CHECK(f.complaint("[[component]]\nshape = \"sphere\"\ntransform = { translat = [0, 0, 1] }\n") ==
        "s.toml:3:15: unknown key 'translat' in [component.transform]; did you mean 'translate'?");
}

TEST_CASE("toml: lengths and angles whose arithmetic would overflow or lose its digits") {
  const SceneFolder f;
  const std::string sphere = "[[component]]\nshape = \"sphere\"\n";
  CHECK(f.complaint(sphere + "transform = { translate = [1e300, 0, 0] }\n") ==
        "s.toml:3:27: component.transform.translate: expected at most 1e+15 m, found 1e+300");
  CHECK(f.complaint(sphere + "transform = { angle_deg = -1e11 }\n") ==
        "s.toml:3:27: component.transform.angle_deg: expected a number in [-1000000,1000000], found -100000000000");
  CHECK(f.complaint(sphere + "hinge = { axis = [0, 0, 1], angle_deg = 1e11 }\n") ==
        "s.toml:3:41: component.hinge.angle_deg: expected a number in [-1000000,1000000], found 100000000000");
  CHECK(f.complaint(sphere + "hinge = { axis = [0, 0, 1], point = [0, -1e16, 0] }\n") ==
        "s.toml:3:37: component.hinge.point: expected at most 1e+15 m, found 1e+16");
  CHECK(f.complaint(sphere + "radius = 1e200\n") ==
        "s.toml:1:1: component.radius: expected a length from 1e-15 to 1e+15 m, found 1e+200");
  CHECK(f.complaint("reference_point = [0, 1e300, 0]\n" + sphere) ==
        "s.toml:1:19: reference_point: expected at most 1e+15 m, found 1e+300");
  CHECK(f.complaint(sphere + "transform = { scale = 1e-200 }\n") ==
        "s.toml:1:1: component: radius: expected a length from 1e-15 to 1e+15 m, found 1e-200");
}

TEST_CASE("toml: words out of a list") {
  const SceneFolder f;
  CHECK(f.complaint("[[component]]\nshape = \"shpere\"\n") ==
        "s.toml:2:9: component.shape: expected one of mesh, sphere, cylinder, disk, cone, paraboloid, rectangle, box, "
        "found \"shpere\"; did you mean 'sphere'?");
  CHECK(f.complaint(kBall + "[source]\nkind = \"lamp\"\n") ==
        "s.toml:3:8: source.kind: expected one of laser, sun, found \"lamp\"");
  CHECK(f.complaint(kBall + "[[detector]]\nkind = \"dealy\"\n")
            .find("s.toml:3:8: detector.kind: expected one of pressure, delay, ") == 0);
  CHECK(f.complaint("[[material]]\nname = \"a\"\nmodel = \"lambrt\"\n" + kBall).find("; did you mean 'lambert'?") !=
        std::string::npos);
  CHECK(f.complaint(kBall + "[trace]\nsampler = \"halton\"\n") ==
        "s.toml:3:11: trace.sampler: expected one of random, sobol, strata, found \"halton\"");
  CHECK(f.complaint(kBall + "[observer]\ndirection = \"sun\"\n") ==
        "s.toml:3:13: observer.direction: expected one of source, station, found \"sun\"");
  CHECK(f.complaint("length_unit = \"km\"\n" + kBall) ==
        "s.toml:1:15: length_unit: expected one of m, cm, mm, in, ft, found \"km\"");
}

TEST_CASE("toml: wrong types") {
  const SceneFolder f;
  CHECK(f.complaint(kBall + "[source]\nwavelength_nm = \"green\"\n") ==
        "s.toml:3:17: source.wavelength_nm: expected a number in (0,1e7], found \"green\"");
  CHECK(f.complaint(kBall + "[source]\ndirection = [0, 1]\n") ==
        "s.toml:3:13: source.direction: expected three numbers [x, y, z], found an array of 2");
  CHECK(f.complaint(kBall + "[source]\ndirection = [0, true, 1]\n") ==
        "s.toml:3:17: source.direction: expected a finite number, found true");
  CHECK(f.complaint(kBall + "[source]\nkind = 3\n") == "s.toml:3:8: source.kind: expected a text, found 3");
  CHECK(f.complaint(kBall + "source = 3\n") == "s.toml:2:10: source: expected a table, found 3");
  CHECK(f.complaint(kBall + "observer = [1]\n") == "s.toml:2:13: observer: expected a table, found 1");
  CHECK(f.complaint("[[component]]\nshape = \"cylinder\"\ncapped = 0.5\n") ==
        "s.toml:3:10: component.capped: expected true or false, found 0.5");
  CHECK(f.complaint(kBall + "[station]\nflag_signal = 1\n") ==
        "s.toml:3:15: station.flag_signal: expected true or false, found 1");
  CHECK(f.complaint("[[component]]\nshape = \"box\"\nsize = [1, 2]\n") ==
        "s.toml:3:8: component.size: expected an array of 3 numbers, found an array of 2");
  CHECK(f.complaint("[[component]]\nshape = \"box\"\nsize = [1, 2, 3]\nsize_x = 1\n") ==
        "s.toml:4:10: component.size_x: given twice, here and in size");
  CHECK(f.complaint(kBall + "[trace]\nrays = 1.5\n") ==
        "s.toml:3:8: trace.rays: expected a whole number in [1..2^40], found 1.5");
  CHECK(f.complaint(kBall + "[[detector]]\nkind = \"delay\"\nbins = 2.5\n") ==
        "s.toml:4:8: detector.bins: expected a whole number in [1..1e7], found 2.5");
}

TEST_CASE("toml: numbers out of range or not finite") {
  const SceneFolder f;
  CHECK(f.complaint("[[material]]\nname = \"a\"\nmodel = \"lambert\"\nrho = 1.5\n" + kBall) ==
        "s.toml:4:7: material.rho: expected a number in [0,1], found 1.5");
  CHECK(f.complaint("[[component]]\nshape = \"sphere\"\nradius = 0\n") ==
        "s.toml:3:10: component.radius: expected a number in (0,inf), found 0");
  CHECK(f.complaint("[[component]]\nshape = \"sphere\"\nradius = nan\n") ==
        "s.toml:3:10: component.radius: expected a number in (0,inf), found nan");
  CHECK(f.complaint("[[component]]\nshape = \"sphere\"\nradius = inf\n") ==
        "s.toml:3:10: component.radius: expected a number in (0,inf), found inf");
  CHECK(f.complaint("reference_point = [0, nan, 0]\n" + kBall) ==
        "s.toml:1:23: reference_point: expected a finite number, found nan");
  CHECK(f.complaint("[[component]]\nshape = \"box\"\nsize = [1, -2, 3]\n") ==
        "s.toml:3:12: component.size: expected a number in (0,inf), found -2");
  CHECK(f.complaint("[[component]]\nshape = \"disk\"\nradius = 1\ninner_radius = 1\n") ==
        "s.toml:1:1: component.inner_radius: expected less than radius = 1, found 1");
  CHECK(f.complaint(kBall + "[station]\nrange_m = -1\n") ==
        "s.toml:3:11: station.range_m: expected a number in [1e-3,1e13], found -1");
  CHECK(f.complaint(kBall + "[station]\ndivergence_urad = 0\n") ==
        "s.toml:3:19: station.divergence_urad: expected a number in [1e-9,4e6], found 0");
  CHECK(f.complaint(kBall + "[trace]\nmax_bounces = 65\n") ==
        "s.toml:3:15: trace.max_bounces: expected a whole number in [1..64], found 65");
  CHECK(f.complaint("length_unit = 0\n" + kBall) == "s.toml:1:15: length_unit: expected a number in (0,inf), found 0");
  CHECK(f.complaint(kBall + "[[detector]]\nkind = \"delay\"\nstart_ns = 3\nstop_ns = 2\n") ==
        "s.toml:5:11: detector.stop_ns: expected more than start_ns = 3, found 2");
  CHECK(f.complaint(kBall + "[[detector]]\nkind = \"rgb\"\nwidth = 0\n") ==
        "s.toml:4:9: detector.width: expected a whole number in [1..32768], found 0");
}

TEST_CASE("toml: directions of no length") {
  const SceneFolder f;
  CHECK(f.complaint(kBall + "[source]\ndirection = [0, 0, 0]\n") ==
        "s.toml:3:13: source.direction: expected a direction, found the zero vector");
  CHECK(f.complaint(kBall + "[motion]\naxis = [0, -0.0, 0]\n") ==
        "s.toml:3:8: motion.axis: expected a direction, found the zero vector");
}

TEST_CASE("toml: materials that nobody defined, and duplicates") {
  const SceneFolder f;
  const std::string material = "[[material]]\nname = \"panel\"\nmodel = \"lambert\"\n";
  CHECK(f.complaint(material + "[[component]]\nshape = \"sphere\"\nmaterial = \"panle\"\n") ==
        "s.toml:6:12: component.material: nobody defines a material \"panle\"; did you mean 'panel'?");
  CHECK(f.complaint(material + material) == "s.toml:5:8: material.name: a second material of the name \"panel\"");
  CHECK(f.complaint("[[material]]\nmodel = \"lambert\"\n") == "s.toml:1:1: material.name: missing; expected a text");
  CHECK(f.complaint("[[material]]\nname = \"a\"\n")
            .find("s.toml:1:1: material.model: missing; expected one of lambert, ") == 0);
  const std::string ball = "[[component]]\nname = \"a\"\nshape = \"sphere\"\n";
  CHECK(f.complaint(ball + ball) == "s.toml:5:8: component.name: a second component of the name \"a\"");
  CHECK(f.complaint(kBall + "[[observer]]\n[[observer]]\n") ==
        "s.toml:2:1: observer.name: missing; several observers must be named");
  for (const char* order : {"[[observer]]\n[[observer]]\nname = \"a\"\n", "[[observer]]\nname = \"a\"\n[[observer]]\n"})
    CHECK(f.complaint(kBall + order).find("observer.name: missing; several observers must be named") !=
          std::string::npos);
  CHECK(f.complaint(kBall + "[[observer]]\nname = \"a\"\n[[observer]]\nname = \"a\"\n") ==
        "s.toml:5:8: observer.name: a second observer of the name \"a\"");
  CHECK(f.complaint(kBall + "[[detector]]\nkind = \"delay\"\n[[detector]]\nkind = \"delay\"\n") ==
        "s.toml:4:1: detector.name: a second detector of the name \"delay\"; several of a kind must be named");
  CHECK(f.complaint(kBall + "[[observer]]\nname = \"a/b\"\n") ==
        "s.toml:3:8: observer.name: expected a name without slashes and control characters, found \"a/b\"");
  CHECK(f.complaint(material + kBall) != "fine");  // an array cannot follow its [[…]] of another kind
  CHECK(f.complaint(kBall + material + "[[variant]]\nname = \"v\"\nmaterial = [{ name = \"pannel\", rho = 0.1 }]\n") ==
        "s.toml:7:22: variant.material.name: nobody defines a material \"pannel\"; did you mean 'panel'?");
  CHECK(f.complaint(kBall + "[[variant]]\nname = \"v\"\n") ==
        "s.toml:2:1: variant.material: missing; expected at least one material to replace");
}

TEST_CASE("toml: files are there and inside the scene's folder") {
  const SceneFolder f;
  const std::string mesh = "[[component]]\nshape = \"mesh\"\nfile = ";
  CHECK(f.complaint(mesh + "\"plaet.obj\"\n") ==
        "s.toml:3:8: component.file: there is no file \"plaet.obj\"; did you mean 'plate.obj'?");
  CHECK(f.complaint("[[component]]\nshape = \"mesh\"\n") == "s.toml:1:1: component.file: missing; expected a text");
  for (const std::string outside : {"../plate.obj", "/etc/passwd", "sub/../../x.obj"}) {
    CHECK(f.complaint(mesh + "\"" + outside + "\"\n") ==
          "s.toml:3:8: component.file: expected a file inside the scene's folder, found \"" + outside + "\"");
  }
  std::filesystem::create_symlink("/etc/passwd", f.path("link.obj"));
  std::filesystem::create_directory_symlink("/etc", f.path("folder"));
  CHECK(f.complaint(mesh + "\"link.obj\"\n").find("expected a file inside the scene's folder") != std::string::npos);
  CHECK(f.complaint(mesh + "\"folder/passwd\"\n").find("expected a file inside the scene's folder") !=
        std::string::npos);
  f.write("parts/plate.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK(f.complaint(mesh + "\"parts/plate.obj\"\n") == "fine");
  CHECK(f.complaint(mesh + "\"parts/../plate.obj\"\n") == "fine");
  CHECK(f.complaint(mesh + "\"plate.obj\"\nmaterials = { solr = \"a\" }\n") ==
        "s.toml:4:22: component.materials.solr: the mesh has no material of this name; did you mean 'solar'?; it has "
        "solar, foil");
  f.write("rho.csv", "400,0.5\n500,2\n");
  CHECK(f.complaint("[[material]]\nname = \"a\"\nmodel = \"lambert\"\nrho = \"rho.csv\"\n") ==
        "rho.csv:2: value: expected a number in [0,1], found 2");
}

TEST_CASE("toml: keys that exclude or need each other") {
  const SceneFolder f;
  CHECK(f.complaint(kBall + "[source]\nbands = [[400, 500]]\n") ==
        "s.toml:3:9: source.bands: belongs to a sun; this is a laser");
  CHECK(f.complaint(kBall + "[source]\nkind = \"sun\"\nwavelength_nm = 532\n") ==
        "s.toml:4:17: source.wavelength_nm: belongs to a laser; this is a sun");
  CHECK(f.complaint(kBall + "[source]\nkind = \"sun\"\nbands = [[500, 400]]\n") ==
        "s.toml:4:16: source.bands: expected more than 500, found 400");
  CHECK(f.complaint(kBall + "[source]\nkind = \"sun\"\nbands = [[400, 500], [400, 500]]\n") ==
        "s.toml:4:22: source.bands: a second band of the name \"400-500\"");
  f.write("sun.csv", "400,1\n500,2\n");
  CHECK(f.complaint(kBall + "[source]\nkind = \"sun\"\nspectrum = \"sun.csv\"\nbands = [[600, 700]]\n") ==
        "s.toml:5:9: source.bands: the source has no light in the band 600-700: its spectrum does not overlap it");
  CHECK(f.complaint(kBall + "[source]\nkind = \"sun\"\nspectrum = \"sun.csv\"\nblackbody_K = 5000\n") ==
        "s.toml:5:15: source.blackbody_K: given beside spectrum; expected only one of them");
  f.write("orbit.cpf", "H1 CPF\n");
  CHECK(f.complaint(kBall + "[station]\ncpf = \"orbit.cpf\"\n") ==
        "s.toml:2:1: station.position_m: missing; expected three numbers [x, y, z]");
  CHECK(f.complaint(kBall + "[station]\ncpf = \"orbit.cpf\"\nrange_m = 1\n") ==
        "s.toml:3:7: station.cpf: given beside range_m; expected only one of them");
  CHECK(f.complaint(kBall + "[motion]\naxis = [0, 1, 0]\nperiod_s = 40\nstop_s = 20\n") ==
        "s.toml:2:1: motion.step_deg: missing; expected a number in (0,360]");
  CHECK(f.complaint(kBall + "[motion]\naxis = [0, 1, 0]\nperiod_s = 40\nstart_s = 20\nstop_s = 10\nstep_deg = 2\n") ==
        "s.toml:6:10: motion.stop_s: expected a number in [20,inf), found 10");
  CHECK(f.complaint(kBall + "[motion]\naxis = [0, 1, 0]\nperiod_s = 1\nstop_s = 1e9\nstep_deg = 1\n") ==
        "s.toml:2:1: motion: the motion needs between 1 and 10000000 steps");
  f.write("att.csv", "time_s,qw,qx,qy,qz\n0,1,0,0,0\n10,1,0,0,0\n");
  CHECK(f.complaint(kBall + "[motion]\nattitudes = \"att.csv\"\nperiod_s = 1\n") ==
        "s.toml:4:12: motion.period_s: belongs to a spin; this is a table");
  CHECK(f.complaint(kBall + "[motion]\nattitudes = \"att.csv\"\nstop_s = 11\n") ==
        "s.toml:4:10: motion.stop_s: expected a number in [0,10], found 11");
}
