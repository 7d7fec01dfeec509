// SPDX-License-Identifier: Apache-2.0
// Scenes of passes: a ball on a circular orbit, given as an OEM in a frame of the test's choice, and what load and
// instants say of it.
#pragma once

#include "clray/error.hpp"
#include "clray/pass.hpp"
#include "ephemeris/epoch.hpp"
#include "unit/ephemeris_support.hpp"
#include "unit/scene_files.hpp"

namespace clray::test {

/// A circular orbit in its frame: radius, inclination, node and argument of latitude at 2026-11-25T18:00:00.
struct Circle {
  double radius_m = 7.714e6, inclination = 1.15, node = 0.3, argument = 3.4;
  double rate() const { return std::sqrt(3.986004418e14 / (radius_m * radius_m * radius_m)); }
  Vec3 at(double t) const {
    const double u = argument + rate() * t, i = inclination;
    const double x = std::cos(u), y = std::sin(u) * std::cos(i), z = std::sin(u) * std::sin(i);
    return radius_m * Vec3(x * std::cos(node) - y * std::sin(node), x * std::sin(node) + y * std::cos(node), z);
  }
  Vec3 velocity(double t) const {
    const double h = 0.5;
    return (at(t + h) - at(t - h)) / (2.0 * h) * (rate() * h / std::sin(rate() * h));  // exact on a circle
  }
};

inline std::string date_after(double seconds) {
  Epoch start;
  ephemeris::read_date("2026-11-25T18:00:00", &start);
  std::string text = ephemeris::iso_text(ephemeris::later(start, seconds));
  text.pop_back();
  return text;
}

/// An OEM from `first` to `last`, a state every `step` seconds.
inline std::string circle_oem(const Circle& orbit, int first, int last, int step = 30,
                              const std::string& frame = "ICRF") {
  std::string text =
      "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-11-25T00:00:00\nORIGINATOR = CLR\nMETA_START\n"
      "OBJECT_NAME = CIRCLE\nOBJECT_ID = 1998-999A\nCENTER_NAME = EARTH\nREF_FRAME = " +
      frame + "\nTIME_SYSTEM = UTC\nSTART_TIME = " + date_after(first) + "\nSTOP_TIME = " + date_after(last) +
      "\nINTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 9\nMETA_STOP\n";
  for (int t = first; t <= last; t += step) {
    const Vec3 p = orbit.at(t) / 1e3, v = orbit.velocity(t) / 1e3;
    text += fmt::format("{} {:.10f} {:.10f} {:.10f} {:.12f} {:.12f} {:.12f}\n", date_after(t), p.x, p.y, p.z, v.x, v.y,
                        v.z);
  }
  return text;
}

const std::string kPassBall = "component = [{ shape = \"sphere\" }]\n";

inline std::string vector_text(const Vec3& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x, v.y, v.z);
}

/// A pass of `seconds` from the start along o.oem.
inline std::string pass_text(const std::string& more, int seconds = 600) {
  return kPassBall + "[pass]\nstart = 2026-11-25T18:00:00Z\nstop = " + date_after(seconds) +
         "Z\nephemeris = \"o.oem\"\n" + more;
}

const std::string kSunlit = "source = { kind = \"sun\" }\n";

/// What load_scene() and then pass_instants() say of a scene; "fine" if nothing.
inline std::string pass_complaint(const SceneFolder& folder, const std::string& text) {
  std::string said = folder.complaint(text);
  if (said != "fine") return said;
  try {
    pass_instants(folder.load(text));
  } catch (const Error& e) {
    said = e.what();
    const std::string prefix = folder.path("");
    for (std::size_t at; (at = said.find(prefix)) != std::string::npos;) said.erase(at, prefix.size());
  }
  return said;
}

}  // namespace clray::test
