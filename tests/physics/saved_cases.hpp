// SPDX-License-Identifier: Apache-2.0
// Small scenes of every method, detector and stopping rule that decides how a run is saved and shared, for tests that
// hold runs in parts against the unbroken run.
#pragma once

#include <string>
#include <vector>

#include "support/scenes.hpp"

namespace clray_test {

struct Case {
  std::string name;
  clray::Scene scene;
  bool fixed = true;  ///< its end is known, so that it can be shared
};

inline clray::Scene turning(clray::Scene scene, int views) {
  for (int v = 0; v < views; ++v) {
    clray::Orientation o;
    o.source = toward(0.1 + 0.2 * v, 0.3);
    o.observers = {toward(0.7, 0.2 * v)};
    scene.views.push_back(o);
  }
  return scene;
}

inline clray::Scene body(clray::Method method, int log2_rays) {
  clray::Scene scene = scene_of(box_mesh(1.0, 0.7, 0.5), lambert(0.4));
  add(scene, plate_mesh(0.6, 2.0), lambert(0.2)).transform.translate = {1.0, 0.0, 0.0};
  window(scene, -20e-9, 20e-9, 64);
  bistatic(scene, toward(0.4), toward(0.9, 1.0));
  scene.trace.rays = log2_rays > 0 ? 1ull << log2_rays : 0;
  scene.trace.method = method;
  scene.trace.slice_points = 128;  // several launches a step, between which it can be saved
  return scene;
}

inline std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"points", turning(body(clray::Method::points, 15), 3)});
  all.back().scene.detectors.push_back({"pressure", "pressure", {}});
  all.push_back({"points to a target", turning(body(clray::Method::points, 0), 3), false});
  all.back().scene.trace.target_error_percent = 0.5;
  all.push_back({"exact", turning(body(clray::Method::exact, 0), 5)});
  clray::Scene tiles = body(clray::Method::tiles, 13);
  monostatic(tiles, toward(0.4));
  all.push_back({"tiles", tiles});
  all.push_back({"tiles to a target", tiles, false});
  all.back().scene.trace.rays = 0;
  all.back().scene.trace.target_error_percent = 0.01;
  all.push_back({"tiles seen from elsewhere", turning(body(clray::Method::tiles, 14), 3)});
  all.push_back({"an exact first bounce", body(clray::Method::exact, 15)});
  all.back().scene.trace.max_bounces = 3;
  all.push_back({"a picture", body(clray::Method::points, 0)});
  detect(all.back().scene, "rgb", {{"width", 32}, {"height", 24}, {"samples", 16}});
  return all;
}

}  // namespace clray_test
