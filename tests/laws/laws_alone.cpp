// SPDX-License-Identifier: Apache-2.0
// The law of the single run: every record of a combined run equals that of a run alone, in any order. See laws.hpp.
#include <algorithm>

#include "laws/laws.hpp"
#include "scene/motion.hpp"
#include "scene/spectrum.hpp"
#include "support/scenes.hpp"

namespace clray_test {

using clray::Result;
using clray::Scene;

namespace {

bool follows(const Scene& scene, clray::Hinge::Follow what) {
  return std::any_of(scene.components.begin(), scene.components.end(),
                     [&](const clray::Component& c) { return c.hinge && c.hinge->follow == what; });
}

/// Hinges at the angles that they have at an orientation: alone, an observer would be the first.
void freeze_hinges(const clray::Vec3& source, const clray::Vec3& first_observer, Scene* scene) {
  for (clray::Component& c : scene->components) {
    if (!c.hinge) continue;
    c.hinge->angle_rad = clray::hinge_angle(*c.hinge, c.transform, source, first_observer);
    c.hinge->follow = clray::Hinge::Follow::none;
  }
}

/// The station's range at a time, from its table where it has one: the polynomial through its rows, which are at most
/// four (docs/laser-ranging.md).
void freeze_range(double time_s, Scene* scene) {
  if (!scene->station || scene->station->ranges.empty()) return;
  const auto& table = scene->station->ranges;
  double range = 0.0;
  for (const auto& [at, value] : table) {
    double weight = 1.0;
    for (const auto& [other, unused] : table) {
      if (other != at) weight *= (time_s - other) / (at - other);
    }
    range += weight * value;
  }
  scene->station->range_m = range;
  scene->station->ranges.clear();
}

void pick_lane(const Pick& pick, Scene* scene, Names* names) {
  if (pick.variant >= 0 && !scene->variants.empty()) {
    const clray::Variant variant = scene->variants[static_cast<std::size_t>(pick.variant)];
    for (clray::Material& m : scene->materials) {
      for (const clray::Material& replaced : variant.materials) {
        if (replaced.name == m.name) m = replaced;
      }
    }
    names->variant = variant.name;
    scene->variants.clear();
  }
  if (pick.band >= 0 && scene->source.kind == clray::Source::Kind::sun) {
    scene->source.bands = {clray::bands_of(*scene)[static_cast<std::size_t>(pick.band)]};
    names->band = scene->source.bands[0].name;
  }
}

/// A histogram's window where the run of many has it: automatic ones depend on the members.
void fix_windows(const Result& combined, const std::string& observer, bool several, Scene* scene) {
  for (clray::DetectorSpec& d : scene->detectors) {
    for (const clray::DelayResult& r : combined.delay) {
      if (r.key.detector != d.name || (several && r.key.observer != observer)) continue;
      const double bins = static_cast<double>(r.bin_m2_per_sr.size());
      d.parameters["bins"] = bins;
      d.parameters["start_ns"] = r.first_bin_start_s * 1e9;
      d.parameters["stop_ns"] = (r.first_bin_start_s + bins * r.bin_width_s) * 1e9;
      d.parameters.erase("bin_ps");
    }
  }
}

}  // namespace

Scene alone(const Scene& scene, const Result& combined, const Pick& pick, Names* names) {
  Scene one = scene;
  if (pick.orientation) {
    const clray::Orientation& o = combined.orientations.at(*pick.orientation);
    const bool grid = pick.detector >= 0 && is_grid(scene.detectors[static_cast<std::size_t>(pick.detector)]);
    names->orientation = orientation_name(combined, *pick.orientation, grid);
    std::vector<clray::Vec3> observers = o.observers;
    if (grid) {  // the observers stay where they are
      for (std::size_t i = 0; i < observers.size(); ++i)
        observers[i] = scene.observers[i].monostatic ? o.source : scene.observers[i].direction;
    }
    freeze_hinges(o.source, observers[0], &one);
    freeze_range(o.time_s, &one);
    one.motion.reset();
    one.pass.reset();
    one.source.direction = o.source;
    one.source.toward = clray::Toward::fixed;
    for (std::size_t i = 0; i < observers.size(); ++i) {
      clray::Observer& observer = one.observers[i];
      observer.direction = observers[i];
      if (observer.toward != clray::Toward::fixed) observer.range_m = o.ranges_m[i];
      observer.toward = clray::Toward::fixed;
    }
  }
  if (pick.detector >= 0) {
    one.detectors = {scene.detectors[static_cast<std::size_t>(pick.detector)]};
    if (pick.orientation && is_grid(one.detectors[0])) {
      one.detectors[0].parameters.erase("azimuth_steps");
      one.detectors[0].parameters.erase("elevation_steps");
    }
  }
  if (pick.observer >= 0) {
    one.observers = {one.observers[static_cast<std::size_t>(pick.observer)]};
    names->observer = one.observers[0].name;
  }
  pick_lane(pick, &one, names);
  if (pick.observer >= 0 || scene.observers.size() == 1)
    fix_windows(combined, one.observers[0].name, scene.observers.size() > 1, &one);
  return one;
}

namespace {

int pick_of(Draw& draw, std::size_t size) {
  return size == 0 ? -1 : draw.whole(0, static_cast<int>(size) - 1);
}

/// Books are of all observers and the mean over all orientations: they compare where these are the same.
bool no_books(const std::string&, const Record& r) {
  return r.kind != "book" && r.kind != "balance";
}

Trial trial_of(const std::string& law, const Scene& scene, const Result& combined, const Pick& pick) {
  Trial t;
  t.law = law;
  t.first = scene;
  t.of_scene = true;
  t.second = alone(scene, combined, pick, &t.second_names);
  const bool whole = pick.observer < 0 && !pick.orientation;
  if (!whole) t.only = no_books;
  return t;
}

/// An orientation that a detector has results of.
std::optional<std::size_t> orientation_of(Draw& draw, const Scene& scene, const Result& combined, int detector) {
  const std::string& name = scene.detectors[static_cast<std::size_t>(detector)].name;
  std::vector<std::size_t> there;
  const auto look = [&](const auto& results) {
    for (const auto& r : results) {
      if (r.key.detector == name) there.push_back(r.key.orientation);
    }
  };
  look(combined.delay);
  look(combined.spectrometer);
  look(combined.pressure);
  look(combined.image);
  if (there.empty()) return {};  // a detector without results: what it finds alone will be missed
  return draw.of(there);
}

}  // namespace

std::vector<Trial> alone_trials(const RandomScene& random, const Result& combined, Draw& draw) {
  const Scene& scene = random.scene;
  const std::size_t bands = clray::bands_of(scene).size();
  std::vector<Trial> trials;
  // One detector, observer, variant, band and orientation, for every detector.
  for (std::size_t d = 0; d < scene.detectors.size(); ++d) {
    Pick pick;
    pick.detector = static_cast<int>(d);
    pick.observer = pick_of(draw, scene.observers.size());
    pick.variant = pick_of(draw, scene.variants.size());
    pick.band = pick_of(draw, bands);
    pick.orientation = orientation_of(draw, scene, combined, pick.detector);
    const bool grid = is_grid(scene.detectors[d]);
    // Which attitude a grid's observers have while the body moves is no law's business.
    if (grid && (scene.motion || scene.pass) && follows(scene, clray::Hinge::Follow::observer)) continue;
    trials.push_back(trial_of("alone", scene, combined, pick));
  }
  if (scene.variants.size() + bands > 1) {
    Pick pick;
    pick.variant = pick_of(draw, scene.variants.size());
    pick.band = pick_of(draw, bands);
    trials.push_back(trial_of("one variant and band", scene, combined, pick));
    trials.back().warnings = true;
  }
  if (scene.detectors.size() > 1) {
    Pick pick;
    pick.detector = pick_of(draw, scene.detectors.size());
    trials.push_back(trial_of("one detector", scene, combined, pick));
  }
  return trials;
}

std::vector<Trial> order_trials(const RandomScene& random, Draw& draw) {
  std::vector<Trial> trials;
  const Scene& scene = random.scene;
  {
    Trial t;
    t.law = "order of detectors, components and materials";
    t.first = t.second = scene;
    t.of_scene = true;
    t.same_bits = true;
    t.warnings = true;
    Scene& s = t.second;
    draw.shuffle(&s.detectors);
    // Points are spread over the beam for the first detector of a kind.
    for (clray::DetectorSpec& d : s.detectors) {
      const auto same = [&](const clray::DetectorSpec& other) { return other.kind == d.kind; };
      const auto first = std::find_if(scene.detectors.begin(), scene.detectors.end(), same);
      const auto now = std::find_if(s.detectors.begin(), s.detectors.end(),
                                    [&](const clray::DetectorSpec& other) { return other.name == first->name; });
      std::iter_swap(now, std::find_if(s.detectors.begin(), s.detectors.end(), same));
    }
    draw.shuffle(&s.components);
    std::vector<std::uint32_t> place(s.materials.size());
    for (std::uint32_t i = 0; i < place.size(); ++i) place[i] = i;
    draw.shuffle(&place);
    for (std::size_t i = 0; i < place.size(); ++i) s.materials[place[i]] = scene.materials[i];
    for (clray::Component& c : s.components) {
      for (std::uint32_t& m : c.materials) m = place[m];
    }
    trials.push_back(t);
  }
  // A program with packets takes seconds to build.
  if (long_tests() || random.seed % 3 == 0) {
    Trial t;
    t.law = "rays in packets";
    t.first = t.second = scene;
    t.of_scene = true;
    t.same_bits = true;
    t.warnings = true;
    t.second.trace.walk = "packet";
    trials.push_back(t);
  }
  if (scene.variants.size() > 1 || scene.source.bands.size() > 1 || scene.observers.size() > 1) {
    Trial t;
    t.law = "order of bands, variants and observers";
    t.first = t.second = scene;
    t.of_scene = true;
    draw.shuffle(&t.second.source.bands);
    draw.shuffle(&t.second.variants);
    // A hinge follows the first observer: the order of observers then means something.
    if (!follows(scene, clray::Hinge::Follow::observer)) draw.shuffle(&t.second.observers);
    trials.push_back(t);
  }
  {
    // Each detector once more under another name: nobody's numbers change.
    Trial t;
    t.law = "a detector twice";
    t.second = scene;
    t.first = scene;
    t.first.detectors.push_back(draw.of(scene.detectors));
    t.first.detectors.back().name = "again";
    t.same_bits = true;
    trials.push_back(t);
  }
  return trials;
}

}  // namespace clray_test
