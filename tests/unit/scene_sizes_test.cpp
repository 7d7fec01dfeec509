// SPDX-License-Identifier: Apache-2.0
// Sizes of results, stated before tracing: as measured of runs, to a factor of two, and refused where no machine has
// them.
#include <doctest/doctest.h>

#include "clray/sizes.hpp"
#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::SceneFolder;

namespace {

const std::string kBall = "component = [{ shape = \"sphere\" }]\n";

}  // namespace

TEST_CASE("sizes: those of runs, to a factor of two") {
  const SceneFolder f;
  // A histogram of 10^7 bins: 2.9 GB of memory were used with a CPU as device, and 462 MB written.
  const SceneSizes bins = scene_sizes(f.load(kBall + "[[detector]]\nkind = \"delay\"\nbins = 10000000\n"));
  CHECK(bins.memory == doctest::Approx(2.9e9).epsilon(0.5));
  CHECK(bins.disk > 0.46e9);
  CHECK(bins.disk < 2.5 * 0.46e9);
  // A picture of 4 million pixels: 0.36 GB over what the program takes, and 41 MB written.
  const SceneSizes picture = scene_sizes(
      f.load(kBall + "[source]\nkind = \"sun\"\n[[detector]]\nkind = \"rgb\"\nwidth = 2000\nheight = 2000\n"));
  CHECK(picture.memory == doctest::Approx(0.36e9).epsilon(0.5));
  CHECK(picture.disk == doctest::Approx(41e6).epsilon(0.5));
  // Twice the views are twice the size.
  const std::string spin = "[motion]\naxis = [0, 0, 1]\nperiod_s = 1\nstep_deg = 36\nstop_s = ";
  const double ten = scene_sizes(f.load(kBall + spin + "0.95\n")).memory,
               twenty = scene_sizes(f.load(kBall + spin + "1.95\n")).memory;
  CHECK(twenty == doctest::Approx(2.0 * ten).epsilon(1e-12));
}

TEST_CASE("sizes: a scene of many materials, components and observers is described by the first hundred of each") {
  const SceneFolder f;
  std::string library, mesh = "mtllib many.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", more;
  for (int i = 0; i < 250; ++i) {
    const std::string n = std::to_string(i);
    library += "newmtl paint" + n + "\nKd 0.5 0.25 0.125\n";
    mesh += "usemtl paint" + n + "\nf 1 2 3\n";
    more += "[[observer]]\nname = \"o" + n + "\"\n[[component]]\nshape = \"sphere\"\nname = \"c" + n + "\"\n";
  }
  f.write("many.mtl", library);
  f.write("many.obj", mesh);
  const std::string text = describe_scene(f.load("[[component]]\nfile = \"many.obj\"\n" + more));
  const auto count = [&](const std::string& words) {
    std::size_t n = 0;
    for (std::size_t at = text.find(words); at != text.npos; at = text.find(words, at + 1)) ++n;
    return n;
  };
  CHECK(count("\n  paint") == 100);
  CHECK(count("paint19 and 230 more  250 triangles") == 1);
  CHECK(count("\nobserver ") == 100);
  CHECK(count("  sphere  default") == 99);
  CHECK(count("\n  and 151 more\n") == 2);  // components, and materials with the default
  CHECK(count("  and 150 more\n") == 1);
}

TEST_CASE("sizes: what no machine has is refused with the number; no product wraps") {
  const SceneFolder f;
  const Scene huge = f.load(kBall +
                            "[motion]\naxis = [0, 0, 1]\nperiod_s = 1\nstop_s = 1000\nstep_deg = 0.1\n"
                            "[[detector]]\nkind = \"delay\"\nbins = 10000000\n");
  // 3.6e6 orientations of 1e7 bins of 424 bytes.
  CHECK(scene_sizes(huge).memory == doctest::Approx(3600001.0 * 1e7 * 424.0).epsilon(1e-12));
  CHECK(size_fault(huge, "").find("the results need about 15.3 PB of memory, and this machine has ") == 0);
  CHECK(size_fault(huge, "").find("; most of it is for detector delay: 1 record of 1e+07 bins (bins), 3.6e+06 "
                                  "orientations (motion.step_deg)") != std::string::npos);
  CHECK(size_fault(f.load(kBall), f.path("new/deep")).empty());
}
