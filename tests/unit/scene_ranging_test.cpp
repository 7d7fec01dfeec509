// SPDX-License-Identifier: Apache-2.0
// What a station asks of its scene, found when the scene is read: ranges throughout the motion, predictions that can be
// used, one range for one place, and the warnings before a session.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::SceneFolder;

namespace {

const std::string kBall =
    "[[material]]\nname = \"m\"\nmodel = \"lambert\"\n[[component]]\nshape = \"sphere\"\nmaterial = \"m\"\n";

std::string motion(double start, double stop) {
  return fmt::format("[motion]\naxis = [0, 0, 1]\nperiod_s = 100\nstart_s = {}\nstop_s = {}\nstep_deg = 90\n", start,
                     stop);
}

/// Positions every 60 s for 30 min from 2026-01-01 0h UTC (MJD 61041), on a circle of 7000 km in the xz plane that
/// stands over +x after `overhead_s`, 1e-3 rad a second.
std::string prediction(const std::string& head = "H1 CPF  2  TST 2026 01 01 00 001 01 testsat\n",
                       const std::string& end = "99\n", double overhead_s = 900.0) {
  std::string text = head + "H2 2600101 9999 99999 2026 01 01 00 00 00 2026 01 01 00 30 00 60 1 0 0 0 0 1\nH9\n";
  for (int i = 0; i <= 30; ++i) {
    const double angle = 1e-3 * (60.0 * i - overhead_s);
    text +=
        fmt::format("10 0 61041 {:.6f} 0 {:.6f} 0.0 {:.6f}\n", 60.0 * i, 7e6 * std::cos(angle), 7e6 * std::sin(angle));
  }
  return text + end;
}

std::string along(const std::string& more = "") {
  return "[station]\ncpf = \"p.cpf\"\nposition_m = [6378137, 0, 0]\n" + more;
}

bool warns(const Scene& scene, const std::string& words) {
  return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                     [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

}  // namespace

TEST_CASE("a table of ranges must reach as far as the motion, or hold time 0 without one") {
  const SceneFolder f;
  f.write("r.csv", "time_s,range_m\n0,1e6\n10,2e6\n");
  const std::string station = "[station]\nranges = \"r.csv\"\n";
  CHECK(f.complaint(kBall + motion(0, 10) + station) == "fine");
  CHECK(f.complaint(kBall + motion(0, 20) + station) ==
        "s.toml:14:10: station.ranges: the table covers 0 s to 10 s; the motion needs 0 s to 20 s");
  CHECK(f.complaint(kBall + motion(-1, 5) + station).find("the motion needs -1 s to 5 s") != std::string::npos);
  f.write("r.csv", "time_s,range_m\n5,1e6\n10,2e6\n");
  CHECK(f.complaint(kBall + station) ==
        "s.toml:8:10: station.ranges: the table covers 5 s to 10 s; the motion needs 0 s");
  // In Unix seconds as well, and where the light is a sun's.
  f.write("r.csv", "time_s,range_m\n1700000000,1e6\n1700000010,2e6\n");
  CHECK(f.complaint(kBall + motion(1.7e9, 1.7e9 + 10) + station) == "fine");
  CHECK(f.complaint(kBall + motion(1.7e9, 1.7e9 + 11) + "[source]\nkind = \"sun\"\n" + station)
            .find("the table covers 1700000000 s to 1700000010 s; the motion needs 1700000000 s to 1700000011 s") !=
        std::string::npos);
}

TEST_CASE("a prediction that cannot serve is refused with the scene, in words that name the cause") {
  const SceneFolder f;
  f.write("p.cpf", prediction());
  CHECK(f.complaint(kBall + motion(300, 1500) + along()) == "fine");
  // The last pulse meets the target after its flight, 2 ms and more later.
  CHECK(f.complaint(kBall + motion(300, 1800) + along()) ==
        "p.cpf: the prediction covers 2026-01-01 00:00:00 UTC to 2026-01-01 00:30:00 UTC; the motion needs 2026-01-01 "
        "00:05:00 UTC to 2026-01-01 00:30:00 UTC, and 0.019 s more for the last pulse's flight (its time 0 is "
        "2026-01-01 00:00:00 UTC)");
  CHECK(f.complaint(kBall + motion(300, 1799.9) + along()) == "fine");
  CHECK(f.complaint(kBall + motion(-1, 5) + along()).find("the motion needs 2025-12-31 23:59:59 UTC") !=
        std::string::npos);
  CHECK(f.complaint(kBall + motion(0, 5) + along("start_mjd = 61042\n")).find("needs 2026-01-02 00:00:00 UTC to") !=
        std::string::npos);
  // Unix seconds: 2026-01-01 is 1767225600.
  CHECK(f.complaint(kBall + motion(1767225600, 1767225900) + along("start_mjd = 40587\n")) == "fine");
  f.write("p.cpf", prediction("H1 CPF  1  TST 2026 01 01 00 6641 testsat\n"));
  CHECK(f.complaint(kBall + motion(300, 1500) + along()) == "fine");
  f.write("p.cpf", prediction("H1 CPF  3  TST 2026 01 01 00 001 01 testsat\n"));
  CHECK(f.complaint(kBall + motion(300, 1500) + along()) == "p.cpf:1: format version 3; expected 1 or 2");
  f.write("p.cpf", prediction("H1 CPF  2  TST 2026 01 01 00 001 01 testsat notes in many words\n"));
  CHECK(f.complaint(kBall + motion(300, 1500) + along()) == "fine");
  f.write("p.cpf", prediction("H1 CPF  2  TST 2026 01 01 00 001 01 testsat\n", "99\n\n \n"));
  CHECK(f.complaint(kBall + motion(300, 1500) + along()) == "fine");
  f.write("p.cpf", prediction("H1 CPF  2  TST 2026 01 01 00 001 01 testsat\n", "\n99\n"));
  CHECK(f.complaint(kBall + motion(300, 1500) + along()) == "fine");
  f.write("p.cpf", prediction().substr(0, 300) + "\n99\n");
  CHECK(f.complaint(kBall + motion(300, 1500) + along()).find("p.cpf:") == 0);
  f.write("p.cpf", prediction());
  CHECK(f.complaint(kBall + motion(300, 1500) + "[station]\ncpf = \"p.cpf\"\nposition_m = [6378.137, 0, 0]\n")
            .find("station.position_m: lies 6378.14 m from the Earth's centre") != std::string::npos);
}

TEST_CASE("a target below the horizon is said, with its elevation") {
  const SceneFolder f;
  f.write("p.cpf", prediction());
  const Scene above = f.load(kBall + motion(840, 960) + along());
  CHECK_FALSE(warns(above, "through the Earth"));
  // At 1 rad from the zenith a target at 7000 km stands at atan2(7000 cos 1 - 6378.137, 7000 sin 1) = -23.8 degrees.
  f.write("p.cpf", prediction("H1 CPF  2  TST 2026 01 01 00 001 01 testsat\n", "99\n", 0.0));
  const Scene below = f.load(kBall + motion(0, 1000) + along());
  CHECK(warns(below, "the target stands at an elevation of -23.8 degrees, 1000 s after the motion's start"));
  CHECK(describe_scene(below).find("elevation 90.0 and -23.8 degrees") != std::string::npos);
  // The horizon is the ellipsoid's: at 45 degrees of geodetic latitude straight up is 0.19 degrees off the radius.
  const std::string station = "[station]\ncpf = \"p.cpf\"\nposition_m = [4517590.879, 0, 4487348.409]\n";
  std::string straight =
      "H1 CPF  2  TST 2026 01 01 00 001 01 testsat\n"
      "H2 2600101 9999 99999 2026 01 01 00 00 00 2026 01 01 00 30 00 60 1 0 0 0 0 1\nH9\n";
  for (int i = 0; i <= 30; ++i) {
    const double up = 1e6 + 1e3 * i;
    straight += fmt::format("10 0 61041 {} 0 {:.6f} 0 {:.6f}\n", 60 * i, 4517590.879 + up * std::sqrt(0.5),
                            4487348.409 + up * std::sqrt(0.5));
  }
  f.write("p.cpf", straight + "99\n");
  CHECK(describe_scene(f.load(kBall + motion(0, 1000) + station)).find("elevation 90.0 and 90.0 degrees") !=
        std::string::npos);
}

TEST_CASE("an observer whose vector is the source's is at the source; what keeps a session from being is said") {
  const SceneFolder f;
  const std::string station = "[station]\n" + motion(0, 10);
  const auto observed = [&](const std::string& observer, const std::string& more = "") {
    return f.load(kBall + "[source]\ndirection = [0.3, 0.4, 5]\n" + observer + station + more);
  };
  CHECK(observed("").warnings.empty());
  CHECK(observed("[observer]\ndirection = [0.3, 0.4, 5]\n").warnings.empty());
  CHECK(observed("[observer]\ndirection = [0.6, 0.8, 10]\n").warnings.empty());  // a power of two: the same bits
  const Scene same = observed("[observer]\ndirection = [0.3, 0.4, 5]\n");
  CHECK(at_source(same.observers[0], same.source));
  CHECK(
      warns(observed("[observer]\ndirection = [1, 0, 0]\n"), "no laser-ranging session: no observer is at the source"));
  CHECK(warns(observed("[observer]\ndirection = [0.30000001, 0.4, 5]\n"), "direction = \"source\" puts it there"));
  CHECK(warns(observed("", "[[detector]]\nkind = \"spectrometer\"\n"), "no detector is of the kind \"delay\""));
  CHECK(warns(f.load(kBall + "[source]\nkind = \"sun\"\n" + station), "the source is a sun, not a laser"));
  CHECK(f.load(kBall + "[station]\n").warnings.empty());  // without a motion nobody expects a session
}

TEST_CASE("one place has one range") {
  const SceneFolder f;
  const std::string station = "[station]\nrange_m = 2e6\n";
  CHECK(f.complaint(kBall + "[observer]\nrange_m = 2e6\n" + station) == "fine");
  CHECK(f.complaint(kBall + "[observer]\ndirection = [1, 0, 0]\nrange_m = 3e6\n" + station) == "fine");
  CHECK(f.complaint(kBall + "[source]\nkind = \"sun\"\n[observer]\nrange_m = 3e6\n" + station) == "fine");
  CHECK(f.complaint(kBall + "[observer]\nrange_m = 3e6\n" + station) ==
        "s.toml:8:11: observer.range_m: is 3000000 m, but this observer is at the source, whose range [station] gives "
        "as 2000000 "
        "m; expected it there alone");
  f.write("r.csv", "time_s,range_m\n0,3e6\n1,3e6\n");
  CHECK(f.complaint(kBall + "[observer]\nrange_m = 3e6\n[station]\nranges = \"r.csv\"\n")
            .find("s.toml:8:11: observer.range_m: is 3000000 m") == 0);
}

TEST_CASE("a station's numbers are bounded so that no link budget overflows") {
  const SceneFolder f;
  CHECK(f.complaint(kBall + "[station]\npulse_energy_J = 1e308\n") ==
        "s.toml:8:18: station.pulse_energy_J: expected a number in (0,1e9], found 1e+308");
  CHECK(f.complaint(kBall + "[station]\ndivergence_urad = 1e-300\n").find("s.toml:8:19: station.divergence_urad") == 0);
  for (const char* line : {"range_m = 1e300", "range_m = 1e-300", "rate_Hz = 1e300", "aperture_m = 1e200",
                           "noise_per_ns = 1e308", "dark_per_ns = 1e308", "gate_ns = 1e200", "jitter_fwhm_ps = 1e300",
                           "dead_time_ns = 1e308", "pointing_urad = 1e300", "pulse_fwhm_ps = 1e30"}) {
    CAPTURE(line);
    CHECK(f.complaint(kBall + "[station]\n" + line + "\n").find("s.toml:8:") == 0);
  }
  CHECK(
      f.complaint(kBall +
                  "[motion]\naxis = [0, 0, 1]\nperiod_s = 1e9\nstop_s = 1e9\nstep_deg = 90\n[station]\nrate_Hz = 1e4\n")
          .find("station.rate_Hz: makes 1e+13 shots over the motion; expected fewer than 1e+12") != std::string::npos);
}

TEST_CASE("times of 1e9 s and more: read, dated with a word where nobody dates them, and bounded") {
  const SceneFolder f;
  f.write("a.csv", "time_s,qw,qx,qy,qz\n1700000000,1,0,0,0\n1700000001,1,0,0,0\n");
  const std::string table = "[motion]\nattitudes = \"a.csv\"\n";
  CHECK(warns(f.load(kBall + table + "[station]\n"), "dated 2053-11-13 22:13:20 UTC"));
  CHECK(f.load(kBall + table + "[station]\nstart_mjd = 40587\n").warnings.empty());
  CHECK(f.load(kBall + table).warnings.empty());
  CHECK(f.complaint(kBall + motion(0, 1e13)).find("motion.stop_s") != std::string::npos);
}
