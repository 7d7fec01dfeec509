// SPDX-License-Identifier: Apache-2.0
// What is wrong with a pass is told with its place before anything is traced.
#include <doctest/doctest.h>

#include "unit/pass_support.hpp"

using namespace clray;
using namespace clray::test;

TEST_CASE("pass: faults of a scene file, before anything is traced") {
  const SceneFolder f;
  f.write("o.oem", circle_oem(Circle(), -60, 900, 30, "ITRF"));
  const std::string good = kSunlit + pass_text("step_s = 20\n");
  CHECK(pass_complaint(f, good) == "fine");
  const auto said = [&](const std::string& text, const std::string& words) {
    const std::string complaint = pass_complaint(f, text);
    CAPTURE(complaint);
    CHECK(complaint.find(words) != std::string::npos);
  };
  const auto change = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  said(good + "[motion]\naxis = [0, 0, 1]\nperiod_s = 1\nstop_s = 1\nstep_deg = 1\n", "pass: given beside [motion]");
  said(change("step_s = 20\n", ""), "pass.step_s: missing; expected a number in (0,1e9], or step_deg, or times");
  said(change("step_s = 20\n", "step_s = 20\nstep_deg = 1\n"), "pass.step_deg: given beside step_s");
  said(change("2026-11-25T18:00:00Z", "\"yesterday\""),
       "pass.start: expected a date such as 2026-11-25T18:02:00Z, found \"yesterday\"");
  said(change("2026-11-25T18:00:00Z", "2026-11-25T19:00:00Z"), "pass.stop: expected a date from the start");
  said(change("2026-11-25T18:00:00Z", "18:00:00"), "pass.start: expected a date");
  said(change("stop = 2026-11-25T18:10:00.000Z\n", ""), "pass.stop: missing");
  said(change("o.oem", "p.oem"), "pass.ephemeris: there is no file \"p.oem\"; did you mean 'o.oem'?");
  said(change("ephemeris", "ephemerides"), "unknown key 'ephemerides' in [pass]; did you mean 'ephemeris'?");
  said(change("step_s = 20", "step_s = 1e-9"), "pass.step_s: makes more than 1e+06 instants");
  said(change("step_s = 20", "step_deg = 1e-3") +
           "[pass.attitude]\nlaw = \"spin\"\nspin = { axis = [0, 0, 1], period_s = 1e-3 }\n",
       "pass.step_deg: makes more than 1e+06 instants");
  said(good + "[pass.attitude]\nlaw = \"spin\"\n", "pass.attitude.spin: missing");
  said(good + "[pass.attitude]\nspin = { axis = [0,0,1], period_s = 1 }\n",
       "pass.attitude.spin: belongs to law = \"spin\"");
  said(good + "[pass.attitude]\nlaw = \"nadir\"\nfile = \"a.aem\"\n", "given beside law");
  said(kPassBall + "[source]\ndirection = \"sun\"\n", "moves with a pass; expected a [pass]");
  said(kPassBall + "[[observer]]\nsite = { latitude_deg = 1, longitude_deg = 1 }\n", "moves with a pass");
  said(change("kind = \"sun\"", "kind = \"laser\""), "station.position_m: missing; the source is at the station");
  said(good + "[[observer]]\nsite = { latitude_deg = 95, longitude_deg = 1 }\n",
       "observer.site.latitude_deg: expected a number in [-90,90]");
  said(good + "[[observer]]\necef_m = [1, 2, 3]\n", "observer.ecef_m: expected Earth-fixed metres");
  said(good + "[[observer]]\necef_m = [6378137, 0, 0]\nrange_m = 1e6\n", "given beside a site");
  f.write("d.csv", "time_s,x,y,z\n0,0,0,1\n1000,0,0,1\n");
  said(good + "[[observer]]\ndirections = \"d.csv\"\n", "observer.frame: missing; expected one of body, gcrf, itrf");
  said(good + "[[observer]]\nframe = \"body\"\n", "observer.frame: belongs to directions");
  said(good + "[station]\ncpf = \"o.oem\"\nposition_m = [6378137, 0, 0]\n", "station.cpf: given beside [pass]");
  said(kPassBall + "[station]\nposition_m = [6378137, 0, 0]\nrate_Hz = 1e11\n" +
           pass_text("step_s = 20\n").substr(kPassBall.size()),
       "station.rate_Hz: makes 6e+13 shots over the pass; expected fewer than 1e+12");
  said(good + "[station]\nrange_m = 2e6\n", "station.range_m: given beside [pass]");
  f.write("metres.csv", "t_s,x_m,y_m,z_m\n0,7000,0,0\n1000,0,7000,0\n");
  said(change("o.oem", "metres.csv"), "from the Earth's centre, inside the Earth");
  f.write("columns.csv", "t_s,x,y,z\n0,7000,0,0\n1000,0,7000,0\n");
  said(change("o.oem", "columns.csv"),
       "columns.csv:1: columns t_s,x,y,z: 'x' is none of them; expected time_s (or time_utc, mjd), x_m (or ");
  f.write("partly.csv", "t_s,x_m,y_m,z_m,vx_m_s\n0,7e6,0,0,0\n1000,0,7e6,0,0\n");
  said(change("o.oem", "partly.csv"), "expected vx, vy and vz, or none of them");
  f.write("t.csv", "time_s\n0\n5\n5\n");
  said(kPassBall + kSunlit + "[pass]\nstart = 2026-11-25T18:00:00Z\ntimes = \"t.csv\"\nephemeris = \"o.oem\"\n",
       "t.csv:4: time: must increase");
  said(kPassBall + kSunlit + "[pass]\ntimes = \"t.csv\"\nephemeris = \"o.oem\"\n",
       "t.csv: its times are seconds; expected pass.start");
}
