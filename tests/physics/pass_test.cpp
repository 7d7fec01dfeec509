// SPDX-License-Identifier: Apache-2.0
// Passes against what traces without one: each instant's pulse against a single pose of the same aspect, sessions drawn
// from the instants' ranges and pulses, and detectors in the Earth's penumbra against the share of light.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "clray/session.hpp"
#include "clray/write.hpp"
#include "support/checks.hpp"
#include "unit/pass_support.hpp"

using namespace clray_test;
using clray::test::Circle;
using clray::test::SceneFolder;

namespace {

/// A prediction of a circular orbit about the Earth-fixed frame, 2026-11-25 17:50 to 18:30.
std::string cpf_of(const Circle& orbit) {
  std::string text =
      "H1 CPF  2  CLR 2026 11 25 00  329 01 circle\n"
      "H2  9205201 0000    22076 2026 11 25 17 50 00 2026 11 25 18 30 00    60 1 0 0 0 0 1\nH9\n";
  for (int t = -600; t <= 1800; t += 60) {
    const clray::Vec3 p = orbit.at(t);
    text += fmt::format("10 0 61369 {:.6f} 0 {:.3f} {:.3f} {:.3f}\n", 64800.0 + t, p.x, p.y, p.z);
  }
  return text + "99\n";
}

void copy_box_wing(const SceneFolder& folder) {
  for (const char* file : {"box_wing.obj", "box_wing.mtl"})
    std::filesystem::copy_file(std::string(CLRAY_SOURCE_DIR) + "/meshes/" + file, folder.path(file));
}

std::string site_below(const Circle& orbit, double t) {
  const clray::Vec3 p = orbit.at(t) * (6.375e6 / orbit.radius_m);
  return fmt::format("[{:.3f}, {:.3f}, {:.3f}]", p.x, p.y, p.z);
}

}  // namespace

TEST_CASE("pass of a box-wing in nadir attitude: at each instant the pulse of a single pose of that aspect") {
  const SceneFolder f;
  copy_box_wing(f);
  const Circle orbit;
  f.write("o.cpf", cpf_of(orbit));
  const clray::Scene scene = f.load(
      "component = [{ file = \"box_wing.obj\" }]\ndetector = [{ kind = \"delay\", bins = 64, start_ns = -60, stop_ns = "
      "60 }]\n"
      "[pass]\nstart = 2026-11-25T18:00:00Z\nstop = 2026-11-25T18:15:00Z\nstep_s = 60\nephemeris = \"o.cpf\"\n"
      "min_elevation_deg = 15\n[pass.attitude]\nlaw = \"nadir\"\n[trace]\nrays = 131072\n"
      "[station]\nrate_Hz = 10\nposition_m = " +
      site_below(orbit, 400.0) + "\n");
  const clray::Result result = clray::trace(scene, device());
  REQUIRE(result.orientations.size() > 5);
  REQUIRE(result.delay.size() == result.orientations.size());
  double least = 1e300, most = 0.0;
  for (const clray::PassInstant& instant : result.instants) {
    if (!instant.traced()) continue;
    const clray::Orientation& view = result.orientations[instant.orientation];
    CHECK(view.source == instant.view.source);
    // Nadir attitude by hand: the station as seen from the body, in axes of the Earth-fixed positions. The Earth's
    // turning enters the velocity.
    const clray::Vec3 p = orbit.at(instant.time_s);
    const clray::Vec3 v = orbit.velocity(instant.time_s) + glm::cross(clray::Vec3(0, 0, 7.2921159e-5), p);
    const clray::Vec3 z = glm::normalize(-p), y = glm::normalize(glm::cross(z, v)), x = glm::cross(y, z);
    const clray::Vec3 s = glm::normalize(scene.station->position_m - p);
    const clray::Vec3 aspect(glm::dot(s, x), glm::dot(s, y), glm::dot(s, z));
    CHECK(glm::length(view.source - aspect) < 5e-6);  // the station's way during the flight, 3e-6
    clray::Scene pose = scene;
    pose.pass.reset();
    pose.station.reset();
    pose.source.toward = clray::Toward::fixed;
    pose.source.direction = view.source;
    const clray::DelayResult one = run(pose).delay.at(0), &all = result.delay[instant.orientation];
    const double a = one.intensity_m2_per_sr.value;
    CHECK(all.intensity_m2_per_sr.value == a);
    CHECK(all.bin_m2_per_sr == one.bin_m2_per_sr);
    CHECK(all.mean_delay_s.value == one.mean_delay_s.value);
    least = std::min(least, a);
    most = std::max(most, a);
  }
  CHECK(most > 1.2 * least);  // the aspect matters here
}

TEST_CASE("pass: 25 instants whose phase angle goes from 35 to 120 degrees have the bits of their single poses") {
  const SceneFolder f;
  copy_box_wing(f);
  f.write("o.oem", clray::test::circle_oem(Circle(), -60, 600));
  std::string rows = "time_s,x,y,z,range_km\n";
  for (int i = 0; i < 25; ++i) {
    const double phase = radians(35.0 + 85.0 * i / 24.0);
    rows += fmt::format("{},{:.17g},{:.17g},{:.17g},{}\n", 20 * i, std::cos(phase), 0.6 * std::sin(phase),
                        0.8 * std::sin(phase), 1000 + 10 * i);
  }
  f.write("d.csv", rows);
  const clray::Scene scene = f.load(
      "component = [{ file = \"box_wing.obj\" }]\ndetector = [{ kind = \"spectrometer\" }]\n[pass]\n"
      "start = 2026-11-25T18:00:00Z\nstop = 2026-11-25T18:08:00Z\nstep_s = 20\nephemeris = \"o.oem\"\n[trace]\nrays = "
      "65536\n"
      "[source]\nkind = \"sun\"\ndirection = [1, 0, 0]\nbands = [[500, 600]]\n[[observer]]\ndirections = \"d.csv\"\n"
      "frame = \"gcrf\"\n");
  const clray::Result all = clray::trace(scene, device());
  REQUIRE(all.spectrometer.size() == 25);
  CHECK(all.spectrometer[0].phase_angle_rad == relative(radians(35.0)).epsilon(1e-9));
  CHECK(all.spectrometer[24].phase_angle_rad == relative(radians(120.0)).epsilon(1e-9));
  for (std::size_t i = 0; i < 25; ++i) {
    clray::Scene pose = scene;
    pose.pass.reset();
    pose.source.direction = all.orientations[i].source;
    pose.observers[0].toward = clray::Toward::fixed;
    pose.observers[0].direction = all.orientations[i].observers[0];
    pose.observers[0].range_m = all.orientations[i].ranges_m[0];
    const clray::SpectrometerResult one = run(pose).spectrometer.at(0), &among = all.spectrometer[i];
    CHECK(one.intensity_m2_per_sr.value == among.intensity_m2_per_sr.value);
    CHECK(one.intensity_m2_per_sr.standard_error == among.intensity_m2_per_sr.standard_error);
    CHECK(one.received_W_m2 == among.received_W_m2);
    CHECK(one.phase_angle_rad == among.phase_angle_rad);
  }
}

TEST_CASE("pass: a session draws each shot from the range and the pulse of its instant") {
  const SceneFolder f;
  const Circle orbit;
  f.write("o.cpf", cpf_of(orbit));
  // A ball: all light comes 1 m nearer than its centre, about 6.67 ns early, whatever the aspect.
  const clray::Scene scene = f.load(
      "component = [{ shape = \"sphere\" }]\ndetector = [{ kind = \"delay\", bins = 64 }]\n"
      "[pass]\nstart = 2026-11-25T18:00:00Z\nstop = 2026-11-25T18:15:00Z\nstep_s = 60\nephemeris = \"o.cpf\"\n"
      "min_elevation_deg = 15\n[trace]\nrays = 65536\n[station]\nrate_Hz = 5\npulse_energy_J = 1000\n"
      "noise_per_ns = 0\nposition_m = " +
      site_below(orbit, 400.0) + "\n");
  CHECK(clray::has_session(scene));
  clray::Result result = clray::trace(scene, device());
  clray::expect_photons(scene, &result);
  std::size_t nearest = 0, farthest = 0;
  for (std::size_t i = 0; i < result.delay.size(); ++i) {
    if (result.orientations[i].source_range_m < result.orientations[nearest].source_range_m) nearest = i;
    if (result.orientations[i].source_range_m > result.orientations[farthest].source_range_m) farthest = i;
  }
  const auto photons = [&](std::size_t i) {
    double sum = 0.0;
    for (const double p : result.delay[i].photons_per_ns) sum += p;
    return sum / result.delay[i].intensity_m2_per_sr.value;
  };
  const double ratio = result.orientations[farthest].source_range_m / result.orientations[nearest].source_range_m;
  CHECK(ratio > 1.3);
  CHECK(photons(nearest) / photons(farthest) == relative(std::pow(ratio, 4.0)).epsilon(1e-9));
  clray::SessionOptions options;
  options.plots = false;
  const clray::SessionSummary summary = clray::write_session(result, scene, f.path(""), options);
  double seconds = 0.0;
  for (const clray::PassInstant& instant : result.instants) {
    if (instant.traced()) seconds += instant.until_s - instant.time_s;
  }
  CHECK(static_cast<double>(summary.shots) == relative(5.0 * seconds).epsilon(1e-3));
  CHECK(summary.signal == summary.shots);  // so bright that each has a photon
  std::ifstream csv(f.path("observations.csv"));
  int rows = 0;
  for (std::string line; std::getline(csv, line);) {
    double epoch = 0.0, flight = 0.0, residual = 0.0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &epoch, &flight, &residual) != 3) continue;
    ++rows;
    // Fired at `epoch`, it meets the body half of its flight later. The Earth-fixed distance then is the one way.
    const double range = glm::length(orbit.at(epoch + 0.5 * flight) - scene.station->position_m);
    CHECK(std::fabs(flight - 2.0 * range / 299792458.0 - residual * 1e-9) < 1e-10);
    CHECK(residual > -6.7);
    CHECK(residual < 0.0);
  }
  CHECK(rows == static_cast<int>(summary.signal));
}

TEST_CASE("pass: in the penumbra every detector's light is scaled by the share of the Sun that is seen") {
  const SceneFolder f;
  const Circle orbit;
  f.write("o.oem", clray::test::circle_oem(orbit, 0, 7200));
  const std::string text =
      "component = [{ shape = \"sphere\" }]\ndetector = [{ kind = \"spectrometer\" }, { kind = \"pressure\" }, { kind "
      "= "
      "\"rgb\", width = 16, height = 16 }]\n[trace]\nrays = 16384\n[source]\nkind = \"sun\"\nbands = [[500, 600]]\n"
      "[[observer]]\ndirection = [1, 0, 0]\nrange_m = 1e6\n[pass]\nephemeris = \"o.oem\"\nstart = "
      "2026-11-25T18:00:00Z\n";
  const std::vector<clray::PassInstant> coarse =
      clray::pass_instants(f.load(text + "stop = 2026-11-25T19:56:00Z\nstep_s = 2\n"));
  const auto half =
      std::find_if(coarse.begin(), coarse.end(), [](const auto& x) { return x.sun_share > 0.2 && x.sun_share < 0.8; });
  REQUIRE(half != coarse.end());
  clray::Scene scene = f.load(text + "stop = 2026-11-25T19:56:00Z\nstep_s = 2\n");
  scene.pass->times_s = {half->time_s - 120.0, half->time_s};  // in full light, and in the penumbra
  if (coarse[static_cast<std::size_t>((half - coarse.begin()) - 60)].sun_share != 1.0)
    scene.pass->times_s[0] = half->time_s - 600.0;
  const clray::Result result = clray::trace(scene, device());
  REQUIRE(result.orientations.size() == 2);
  CHECK(result.orientations[0].light == 1.0);
  const double share = result.orientations[1].light;
  CHECK(share == half->sun_share);
  REQUIRE(result.spectrometer.size() == 2);
  const clray::SpectrometerResult &full = result.spectrometer[0], &part = result.spectrometer[1];
  CHECK(part.source_W_m2 == relative(share * full.source_W_m2).epsilon(1e-12));
  // A ball of Lambert's law: A depends on the phase angle alone, so received light scales with A and the share.
  CHECK(part.received_W_m2 / full.received_W_m2 ==
        relative(share * part.intensity_m2_per_sr.value / full.intensity_m2_per_sr.value).epsilon(1e-9));
  CHECK(part.magnitude_AB - full.magnitude_AB ==
        relative(-2.5 * std::log10(part.received_W_m2 / full.received_W_m2)).epsilon(1e-9));
  REQUIRE(result.pressure.size() == 2);
  CHECK(result.pressure[1].source_W_m2 == relative(share * result.pressure[0].source_W_m2).epsilon(1e-12));
  REQUIRE(result.image.size() == 2);
  CHECK(result.image[1].band_source_W_m2[0] == relative(share * result.image[0].band_source_W_m2[0]).epsilon(1e-12));
}
