// SPDX-License-Identifier: Apache-2.0
// Random scenes: frame, light, observers, motion, station and detectors. See generator.hpp.
#include "laws/generator.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "scene/scene_parts.hpp"
#include "scene/spectrum.hpp"
#include "scene/tables.hpp"
#include "support/scenes.hpp"

namespace clray_test {

using clray::Band;
using clray::Component;
using clray::DetectorSpec;
using clray::Scene;
using clray::TableRow;

void draw_components(Draw& draw, RandomScene* out);  // generator_body.cpp

Frame draw_frame(int number) {
  Draw draw(0xf00d + static_cast<std::uint64_t>(number));
  const std::vector<std::string> kinds = clray::row_names("detector");
  Frame frame;
  frame.bounces = 1 + number % 4;
  frame.variants = draw.whole(0, 3);
  frame.bands = draw.whole(1, 3);
  if (frame.variants > 0) frame.bands = std::min(frame.bands, 2);
  frame.observers = draw.whole(1, 2);
  frame.sobol = !draw.chance(0.15);
  // Every row has its turn, now and then twice.
  frame.detectors.push_back(kinds[static_cast<std::size_t>(number) % kinds.size()]);
  if (draw.chance(0.4)) frame.detectors.push_back(frame.detectors.front());
  while (frame.detectors.size() < 4 && draw.chance(0.7)) frame.detectors.push_back(draw.of(kinds));
  draw.shuffle(&frame.detectors);
  return frame;
}

namespace {

void draw_source(Draw& draw, const Frame& frame, Scene* scene) {
  clray::Source& s = scene->source;
  s.direction = draw.chance(0.2) ? clray::Vec3(0, 0, draw.chance(0.5) ? 1 : -1) : draw.direction();
  if (frame.bands == 1 && draw.chance(0.7)) {
    s.kind = clray::Source::Kind::laser;
    s.wavelength_nm = draw.between(400.0, 1100.0);
    return;
  }
  s.kind = clray::Source::Kind::sun;
  double at = draw.between(350.0, 450.0);
  for (int b = 0; b < frame.bands; ++b) {
    const double low = at, high = at + draw.between(20.0, 120.0);
    Band band{fmt::format("b{}", b), low, high};
    if (draw.chance(0.25))
      band.response = std::make_shared<clray::Spectrum>(
          clray::Spectrum{{low, 0.5 * (low + high), high}, {0.0, draw.between(0.2, 1.0), draw.between(0.0, 1.0)}});
    s.bands.push_back(band);
    at = high + draw.between(1.0, 60.0);
  }
  if (draw.chance(0.3)) s.blackbody_K = draw.between(2500.0, 9000.0);
  if (s.blackbody_K == 0.0 && draw.chance(0.3))
    s.spectrum = clray::Spectrum{{300.0, 600.0, 1200.0}, {draw.between(0.1, 2.0), draw.between(0.1, 2.0), 0.5}};
  draw.shuffle(&s.bands);
}

void draw_observers(Draw& draw, const Frame& frame, Scene* scene) {
  const bool mirrors = has_delta(*scene);
  for (int i = 0; i < frame.observers; ++i) {
    clray::Observer o;
    o.name = fmt::format("o{}", i);
    o.monostatic = draw.chance(0.4);
    o.direction = o.monostatic ? scene->source.direction : draw.direction();
    // Wide cones: a narrow one around a flat mirror's beam would be a matter of luck.
    if (mirrors && draw.chance(0.7)) o.acceptance_rad = draw.between(0.2, 0.8);
    // At the source stands the station, which has its own range.
    if (draw.chance(0.3) && !(o.monostatic && scene->station)) o.range_m = draw.between(1e5, 1e7);
    scene->observers.push_back(o);
  }
}

void draw_motion(Draw& draw, Scene* scene) {
  clray::Motion m;
  if (draw.chance(0.5)) {
    m.axis = draw.direction();
    m.period_s = draw.between(10.0, 100.0);
    m.phase_rad = draw.between(0.0, 6.0);
    m.start_s = draw.between(-20.0, 20.0);
    m.step_rad = draw.between(0.3, 2.0);
    m.stop_s = m.start_s + draw.between(1.1, 2.9) * m.step_rad / (2.0 * kPi) * m.period_s;
  } else {
    for (int k = 0; k < 3; ++k) {
      const clray::Vec3 axis = draw.direction();
      const double half = draw.between(0.0, kPi / 2.0);
      m.attitudes.push_back(
          {10.0 * k, {std::cos(half), std::sin(half) * axis.x, std::sin(half) * axis.y, std::sin(half) * axis.z}});
    }
    m.start_s = draw.between(0.0, 9.0);
    m.stop_s = draw.between(10.0, 20.0);
  }
  scene->motion = m;
}

/// A file that lives as long as the program.
const std::string& orbit_file() {
  struct File {
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / fmt::format("clray-laws-{}", static_cast<long>(::getpid()));
    std::string name = (folder / "orbit.csv").string();
    File() {
      std::filesystem::create_directories(folder);
      std::ofstream(name) << kOrbitStates;
    }
    ~File() { std::filesystem::remove_all(folder); }
  };
  static const File file;
  return file.name;
}

/// A pass instead of the motion: the same attitudes along an orbit, with sites and the Sun for some of those who look
/// and shine.
void make_pass(Draw& draw, Scene* scene) {
  const clray::Motion m = *scene->motion;
  scene->motion.reset();
  clray::Pass p;
  p.start = {61369, 18 * 3600 * std::int64_t{1000000000000}};
  p.ephemeris = orbit_file();
  p.min_elevation_rad = -kPi / 2.0;
  p.aberration = draw.chance(0.5);
  p.times_s = {draw.between(0.0, 5.0), draw.between(6.0, 10.0)};
  p.stop_s = p.times_s.back();
  if (m.attitudes.empty()) {
    p.attitude.law = clray::PassAttitude::Law::spin;
    p.attitude.spin_axis = m.axis;
    p.attitude.spin_period_s = m.period_s;
    p.attitude.spin_phase_rad = m.phase_rad;
    p.attitude.spin_in_orbit_frame = draw.chance(0.5);
  }
  p.attitude.attitudes = m.attitudes;
  if (scene->source.kind == clray::Source::Kind::sun && draw.chance(0.5)) scene->source.toward = clray::Toward::sun;
  for (clray::Observer& o : scene->observers) {
    if (o.monostatic || !draw.chance(0.5)) continue;
    o.toward = clray::Toward::site;
    o.site_m = 6.371e6 * draw.direction();
    o.range_m = 0.0;
  }
  scene->pass = p;
}

void draw_station(Draw& draw, Scene* scene) {
  clray::Station s;
  s.range_m = draw.between(3e5, 3e7);
  if (draw.chance(0.5))
    s.ranges = {{-100.0, draw.between(3e5, 3e7)}, {0.0, draw.between(3e5, 3e7)}, {300.0, draw.between(3e5, 3e7)}};
  if (draw.chance(0.3)) s.pulse_fwhm_s = draw.between(1e-11, 1e-9);
  scene->station = s;
}

DetectorSpec draw_detector(Draw& draw, const std::string& kind) {
  const TableRow& row = clray::table_row("detector", kind);
  for (;;) {
    DetectorSpec d;
    d.kind = kind;
    for (const clray::TableKey& key : row.keys) {
      if (draw.chance(0.4)) d.parameters[key.name] = draw.key(key);
    }
    // Keys that mean sizes must be small: their defaults are those of a picture to look at.
    for (const clray::TableKey& key : row.keys) {
      if (key.is_whole && key.low >= 1.0 && d.parameters.count(key.name) == 0) d.parameters[key.name] = draw.key(key);
    }
    // A window of which one end is drawn may miss the body: both or none.
    if (d.parameters.count("start_ns") != d.parameters.count("stop_ns")) continue;
    if (clray::detector_fault(d).empty()) return d;
  }
}

void draw_detectors(Draw& draw, const Frame& frame, Scene* scene) {
  for (const std::string& kind : frame.detectors) {
    DetectorSpec d = draw_detector(draw, kind);
    d.name = fmt::format("{}{}", kind, scene->detectors.size());
    scene->detectors.push_back(d);
  }
}

void draw_variants(Draw& draw, const Frame& frame, Scene* scene) {
  const std::vector<Band> bands = clray::bands_of(*scene);
  for (int v = 0; v < frame.variants; ++v) {
    clray::Variant variant;
    variant.name = fmt::format("v{}", v);
    for (const clray::Material& base : scene->materials) {
      if (!draw.chance(0.5) && !(variant.materials.empty() && &base == &scene->materials.back())) continue;
      clray::Material m = base;
      if (draw.chance(0.3)) {
        m.two_sided = !m.two_sided;  // the same surface but for its back
      } else {
        m = draw_material(draw, base.name, bands);
      }
      variant.materials.push_back(m);
    }
    scene->variants.push_back(variant);
  }
}

}  // namespace

RandomScene draw_scene(std::uint64_t seed, int frames, bool flat) {
  RandomScene out;
  out.flat = flat;
  Draw draw(seed);
  out.seed = seed;
  out.frame = static_cast<int>(seed % static_cast<std::uint64_t>(frames));
  const Frame frame = draw_frame(out.frame);
  Scene& scene = out.scene;
  scene.name = fmt::format("law-{}", seed);
  scene.trace.specialise = false;
  scene.trace.max_bounces = frame.bounces;
  const bool strata = draw.chance(0.8);
  scene.trace.sampler = !frame.sobol ? clray::SamplerKind::random
                        : strata     ? clray::SamplerKind::strata
                                     : clray::SamplerKind::sobol;
  if (draw.chance(0.3)) scene.reference_point = draw.place(1.0);
  draw_source(draw, frame, &scene);
  for (int m = 0; m < kMaterials; ++m)
    scene.materials.push_back(draw_material(draw, fmt::format("m{}", m), clray::bands_of(scene)));
  draw_components(draw, &out);
  draw_variants(draw, frame, &scene);
  if (draw.chance(scene.source.kind == clray::Source::Kind::laser ? 0.9 : 0.3)) draw_station(draw, &scene);
  draw_observers(draw, frame, &scene);
  if (draw.chance(0.25)) draw_motion(draw, &scene);
  draw_detectors(draw, frame, &scene);
  if (scene.motion && !scene.station && draw.chance(0.7)) make_pass(draw, &scene);
  clray::check_scene(scene);
  return out;
}

}  // namespace clray_test
