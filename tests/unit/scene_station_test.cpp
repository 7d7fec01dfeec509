// SPDX-License-Identifier: Apache-2.0
// Station files: what they hold, what the scene's own keys replace, and what is wrong with them, by line. Expected
// values are those that the texts give.
#include <doctest/doctest.h>

#include <cmath>

#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::SceneFolder;

namespace {

const std::string kBall = "component = [{ shape = \"sphere\" }]\n";
const std::string kSpin = "[motion]\naxis = [0, 0, 1]\nperiod_s = 10\nstop_s = 10\nstep_deg = 90\n";
const std::string kStation =
    "name = \"GRZL\"\npad = 7839\nsite = { latitude_deg = 0, longitude_deg = 90 }\nranges = \"far.csv\"\n"
    "pulse_fwhm_ps = 10\nrate_Hz = 500\n";

struct Stations : SceneFolder {
  Stations() {
    write("st/graz.toml", kStation);
    write("st/far.csv", "time_s,range_km\n0,800\n10,900\n20,900\n");
    write("pulse.csv", "time_ps,power\n0,0\n10,1\n20,0\n");
  }
};

}  // namespace

TEST_CASE("station file: alone it is the station, with its own files beside it") {
  const Stations f;
  const Scene scene = f.load("station = \"st/graz.toml\"\n" + kBall + kSpin);
  REQUIRE(scene.station.has_value());
  CHECK(scene.station->name == "GRZL");
  CHECK(scene.station->pad == 7839);
  CHECK(scene.station->rate_Hz == 500.0);
  CHECK(scene.station->pulse_fwhm_s == doctest::Approx(10e-12).epsilon(1e-15));
  CHECK(scene.station->ranges.size() == 3);
  CHECK(scene.station->ranges[1].second == 900e3);
  CHECK(scene.station->position_m.y == doctest::Approx(6378137.0).epsilon(1e-12));
  CHECK(scene.station->aperture_m == Station().aperture_m);
  CHECK(load_station(f.path("st/graz.toml")).pad == 7839);
}

TEST_CASE("station file: the scene's own keys stand first, and replace what excludes them") {
  const Stations f;
  const Scene scene =
      f.load(kBall + kSpin + "[station]\nfile = \"st/graz.toml\"\npad = 1234\nrange_m = 7e5\npulse = \"pulse.csv\"\n");
  CHECK(scene.station->name == "GRZL");
  CHECK(scene.station->pad == 1234);
  CHECK(scene.station->ranges.empty());
  CHECK(scene.station->range_m == 7e5);
  CHECK(scene.station->pulse.size() == 3);
  CHECK(scene.station->pulse_fwhm_s == 0.0);
  CHECK(scene.station->rate_Hz == 500.0);
  CHECK(describe_scene(scene).find("graz.toml") != std::string::npos);
}

TEST_CASE("station file: faults are told with the place in the file") {
  const Stations f;
  const auto said = [&](const std::string& station) {
    f.write("st.toml", station);
    return f.complaint("station = \"st.toml\"\n" + kBall + kSpin);
  };
  CHECK(said("pad = -1\n") == "st.toml:1:7: station.pad: expected a whole number in [0..9999], found -1");
  CHECK(said("\nnmae = \"x\"\n") == "st.toml:2:1: unknown key 'nmae' in [station]; did you mean 'name'?");
  CHECK(said("file = \"st.toml\"\n").find("st.toml:1:8: station.file: is a key of scenes") == 0);
  CHECK(said("range_m = 1e6\nranges = \"st/far.csv\"\n").find("st.toml:2:10: station.ranges: given beside range_m") ==
        0);
  CHECK(said("pad = \n").find("st.toml:1:7: not TOML") == 0);
  CHECK(f.complaint("station = \"nowhere.toml\"\n" + kBall).find("s.toml:1:11: station: there is no file") == 0);
  CHECK(f.complaint("station = 7\n" + kBall).find("s.toml:1:11: station: expected a table, found 7") == 0);
  // The table of ranges ends before the motion does.
  f.write("st/far.csv", "time_s,range_km\n0,800\n5,900\n");
  CHECK(f.complaint("station = \"st/graz.toml\"\n" + kBall + kSpin).find("s.toml:1:11: station.ranges: ") == 0);
}

TEST_CASE("station file: those of meshes/ are read") {
  const std::string folder = std::string(CLRAY_SOURCE_DIR) + "/meshes/";
  CHECK(load_station(folder + "station_paper.toml").rate_Hz == 2000.0);
  const Station khz = load_station(folder + "station_khz.toml");
  CHECK(khz.pad == 7839);
  CHECK(khz.normal_point_s == 15.0);
  CHECK(std::sqrt(khz.position_m.x * khz.position_m.x + khz.position_m.y * khz.position_m.y +
                  khz.position_m.z * khz.position_m.z) == doctest::Approx(6.367e6).epsilon(1e-3));
}

TEST_CASE("station file: an observer of a pass has its place, and its name unless he is given one") {
  const Stations f;
  f.write("o.csv", "time_s,x_m,y_m,z_m\n0,7e6,0,0\n100,7e6,1e5,0\n");
  f.write("nowhere.toml", "name = \"n\"\n");
  const std::string pass =
      kBall +
      "[pass]\nstart = 2026-11-25T18:00:00Z\nstop = 2026-11-25T18:01:00Z\nstep_s = 20\nephemeris = "
      "\"o.csv\"\n[source]\nkind = \"sun\"\n";
  const Scene scene = f.load(pass +
                             "[[observer]]\nstation = \"st/graz.toml\"\n"
                             "[[observer]]\nstation = \"st/graz.toml\"\nname = \"other\"\n");
  REQUIRE(scene.observers.size() == 2);
  CHECK(scene.observers[0].name == "GRZL");
  CHECK(scene.observers[1].name == "other");
  for (const Observer& o : scene.observers) {
    CHECK(o.toward == Toward::site);
    CHECK(o.site_m.y == doctest::Approx(6378137.0).epsilon(1e-12));
  }
  CHECK(f.complaint(pass + "[observer]\nstation = \"nowhere.toml\"\n")
            .find("observer.station: the file gives no place") != std::string::npos);
  CHECK(f.complaint(pass + "[observer]\nsite = { latitude_deg = 0, longitude_deg = 0 }\nstation = \"st/graz.toml\"\n")
            .find("given beside site") != std::string::npos);
}
