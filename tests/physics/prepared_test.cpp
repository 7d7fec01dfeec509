// SPDX-License-Identifier: Apache-2.0
// A prepared scene gives the bits of single runs, whatever changed between two traces, and builds no program twice.
// Views that are given one by one are those of runs alone.
#include "clray/prepared.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "clray/error.hpp"
#include "device/device_impl.hpp"
#include "support/scenes.hpp"

using namespace clray_test;

namespace {

/// A body with a hinged part, two materials, several detectors.
clray::Scene body(clray::Method method = clray::Method::points) {
  clray::Scene scene = scene_of(box_mesh(1.0, 0.7, 0.5), lambert(0.4));
  clray::Component& wing = add(scene, plate_mesh(0.6, 2.0), lambert(0.2));
  wing.transform.translate = {1.0, 0.0, 0.0};
  wing.hinge = clray::Hinge{{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, 0.2, clray::Hinge::Follow::none};
  window(scene, -20e-9, 20e-9, 64);  // an automatic one depends on all views
  scene.detectors.push_back({"pressure", "pressure", {}});
  bistatic(scene, toward(0.4), toward(0.9, 1.0));
  rays(scene, 12);
  scene.trace.method = method;
  if (method == clray::Method::exact) scene.trace.rays = 0;
  return scene;
}

using Change = std::function<void(clray::Scene&)>;

struct Named {
  std::string what;
  Change change;
};

const std::vector<Named>& changes() {
  static const std::vector<Named> all{
      {"nothing", [](clray::Scene&) {}},
      {"the Sun", [](clray::Scene& s) { s.source.direction = toward(1.1, 0.3); }},
      {"the observer", [](clray::Scene& s) { s.observers[0].direction = toward(0.2, 2.0); }},
      {"a second observer", [](clray::Scene& s) { s.observers.push_back(s.observers[0]), s.observers[1].name = "b"; }},
      {"a material's number", [](clray::Scene& s) { s.materials[0].parameters["rho"] = 0.9; }},
      {"a material's model", [](clray::Scene& s) { s.materials[1] = ashikhmin_shirley(0.2, 0.3, 40.0); }},
      {"a material's name", [](clray::Scene& s) { s.materials[1].name = "wing"; }},
      {"materials' order by content", [](clray::Scene& s) { s.materials[0].parameters["rho"] = 0.01; }},
      {"the hinge's angle", [](clray::Scene& s) { s.components[1].hinge->angle_rad = 1.0; }},
      {"what the hinge follows", [](clray::Scene& s) { s.components[1].hinge->follow = clray::Hinge::Follow::source; }},
      {"the hinge's place", [](clray::Scene& s) { s.components[1].hinge->point.x = 1.3; }},
      {"a mesh", [](clray::Scene& s) { s.components[0].mesh = box_mesh(1.0, 0.7, 0.8); }},
      {"a transform", [](clray::Scene& s) { s.components[0].transform.translate.z = 0.25; }},
      {"a component more",
       [](clray::Scene& s) { add(s, plate_mesh(0.3, 0.3), lambert(0.7)).transform.translate.z = 2; }},
      {"a component's materials", [](clray::Scene& s) { s.components[0].materials = {1}; }},
      {"a shape's size",
       [](clray::Scene& s) {
         s.components[0] = s.components[1], s.components[0].name = "other", s.components.pop_back();
       }},
      {"the reference point", [](clray::Scene& s) { s.reference_point.x = 0.5; }},
      {"the detectors", [](clray::Scene& s) { s.detectors.pop_back(); }},
      {"bins", [](clray::Scene& s) { s.detectors[0].parameters["bins"] = 77; }},
      {"the seed", [](clray::Scene& s) { s.trace.seed = 7; }},
      {"a variant",
       [](clray::Scene& s) {
         s.variants.push_back({"dull", {}}), s.variants.push_back({"dark", {lambert(0.01)}}),
             s.variants[1].materials[0].name = s.materials[0].name;
       }},
      {"a motion",
       [](clray::Scene& s) {
         s.motion.emplace(), s.motion->period_s = 10, s.motion->stop_s = 5, s.motion->step_rad = 0.7;
       }},
  };
  return all;
}

void check_same(const clray::Result& found, const clray::Result& right) {
  CHECK(found.digest == right.digest);
  CHECK(found.warnings == right.warnings);
  CHECK(found.kept == right.kept);
  REQUIRE(found.delay.size() == right.delay.size());
  for (std::size_t k = 0; k < found.delay.size(); ++k) {
    CHECK(found.delay[k].intensity_m2_per_sr.value == right.delay[k].intensity_m2_per_sr.value);
    CHECK(found.delay[k].intensity_m2_per_sr.standard_error == right.delay[k].intensity_m2_per_sr.standard_error);
    CHECK(found.delay[k].bin_m2_per_sr == right.delay[k].bin_m2_per_sr);
    CHECK(found.delay[k].bin_upper_bound == right.delay[k].bin_upper_bound);
  }
  REQUIRE(found.pressure.size() == right.pressure.size());
  for (std::size_t k = 0; k < found.pressure.size(); ++k)
    CHECK(found.pressure[k].coefficient_m2.value == right.pressure[k].coefficient_m2.value);
}

std::size_t programs() {
  return device().impl().devices.front().programs.size();
}

std::vector<clray::Orientation> some_views(int count) {
  std::vector<clray::Orientation> views;
  for (int k = 0; k < count; ++k) {
    clray::Orientation view;
    view.time_s = 0.5 * k;
    view.source = toward(0.1 + 0.2 * k, 0.3 * k);
    views.push_back(view);
  }
  return views;
}

}  // namespace

TEST_CASE("whatever changes between two traces of a prepared scene, the bits are those of a run alone") {
  for (const clray::Method method : {clray::Method::points, clray::Method::exact}) {
    clray::Prepared prepared(body(method), device());
    check_same(prepared.trace(), run(body(method)));
    for (const Named& each : changes()) {
      CAPTURE(each.what);
      clray::Scene scene = body(method);
      each.change(scene);
      if (method == clray::Method::exact && scene.materials[1].model != "lambert") continue;
      check_same(prepared.trace(scene), run(scene));
      check_same(prepared.trace(), run(body(method)));  // and back
    }
  }
}

TEST_CASE("suns, observers, angles, numbers of materials and motions build no program") {
  clray::Prepared prepared(body(), device());
  const std::size_t before = programs();
  for (const Named& each : changes()) {
    const std::string& what = each.what;
    if (what != "the Sun" && what != "the observer" && what != "a material's number" && what != "the hinge's angle" &&
        what != "the seed" && what != "a motion")
      continue;
    CAPTURE(what);
    clray::Scene scene = body();
    each.change(scene);
    prepared.trace(scene);
    CHECK(programs() == before);
  }
}

TEST_CASE("views given one by one have the bits of runs alone, in one call or in many") {
  for (const clray::Method method : {clray::Method::points, clray::Method::exact}) {
    clray::Prepared prepared(body(method), device());
    const std::vector<clray::Orientation> views = some_views(5);
    const clray::Result all = prepared.trace(views);
    REQUIRE(all.orientations.size() == 5);
    REQUIRE(all.delay.size() == 5);
    for (std::size_t k = 0; k < views.size(); ++k) {
      CAPTURE(k);
      clray::Scene alone = body(method);
      alone.source.direction = views[k].source;
      const clray::Result one = run(alone);
      CHECK(all.orientations[k].observers[0] == alone.observers[0].direction);
      CHECK(all.delay[k].key.orientation == k);
      CHECK(all.delay[k].intensity_m2_per_sr.value == one.delay[0].intensity_m2_per_sr.value);
      CHECK(all.pressure[k].coefficient_m2.value == one.pressure[0].coefficient_m2.value);
      CHECK(prepared.trace({views[k]}).digest == one.digest);
    }
  }
}

TEST_CASE("observers of a view: one at the source goes with it, another may stand anywhere") {
  clray::Scene scene = monostatic(*std::make_unique<clray::Scene>(body()), toward(0.3));
  scene.views = some_views(2);
  const clray::Result result = run(scene);
  CHECK(result.orientations[1].observers[0] == scene.views[1].source);
  clray::Scene two = body();
  two.views = some_views(1);
  two.views[0].observers = {toward(1.0, 2.0)};
  clray::Scene alone = body();
  alone.source.direction = two.views[0].source;
  alone.observers[0].direction = toward(1.0, 2.0);
  CHECK(run(two).digest == run(alone).digest);
}

TEST_CASE("views that make no sense are refused, with their place") {
  const auto message = [](const Change& change) -> std::string {
    clray::Scene scene = body();
    scene.views = some_views(3);
    change(scene);
    try {
      clray::check_scene(scene);
    } catch (const clray::Error& error) {
      return error.what();
    }
    return "";
  };
  CHECK(message([](clray::Scene&) {}) == "");
  const auto says = [&](const Change& change, const char* place) { CHECK(message(change).rfind(place, 0) == 0); };
  says([](clray::Scene& s) { s.views[1].source = {0, 0, 0.5}; }, "views[1].source: ");
  says([](clray::Scene& s) { s.views[2].observers = {toward(0), toward(1)}; }, "views[2].observers: ");
  says([](clray::Scene& s) { s.views[0].observers = {{0, 0, 2}}; }, "views[0].observers[0]: ");
  says([](clray::Scene& s) { s.views[0].ranges_m = {1.0, 2.0}; }, "views[0].ranges_m: ");
  says([](clray::Scene& s) { s.views[0].ranges_m = {-1.0}; }, "views[0].ranges_m: ");
  says([](clray::Scene& s) { s.views[0].light = -1.0; }, "views[0].light: ");
  says([](clray::Scene& s) { s.views[0].time_s = HUGE_VAL; }, "views[0].time_s: ");
  says([](clray::Scene& s) { s.views[0].body_to_space = {2, 0, 0, 0}; }, "views[0].body_to_space: ");
  says(
      [](clray::Scene& s) { s.motion.emplace(), s.motion->period_s = 1, s.motion->step_rad = 1, s.motion->stop_s = 1; },
      "views: ");
  says([](clray::Scene& s) { monostatic(s, toward(0.1)), s.views[0].observers = {toward(1.0)}; },
       "views[0].observers[0]: ");
}

TEST_CASE("a trace that another thread stops leaves nothing behind") {
  clray::Scene scene = rays(*std::make_unique<clray::Scene>(body()), 22);
  clray::Prepared prepared(scene, device());
  std::atomic<bool> stop{false};
  clray::TraceHooks hooks;
  hooks.stop = &stop;
  std::thread other;
  hooks.progress = [&](const clray::Progress& p) {
    if (p.rays > 0 && !other.joinable()) other = std::thread([&] { stop = true; });
  };
  const clray::Result cut = prepared.trace(hooks);
  if (other.joinable()) other.join();
  CHECK(cut.partial);
  CHECK(prepared.trace(body()).digest == run(body()).digest);
}

TEST_CASE("an error, from a callback or a scene, leaves a prepared scene sound") {
  clray::Prepared prepared(body(), device());
  clray::TraceHooks hooks;
  hooks.progress = [](const clray::Progress&) { throw std::runtime_error("enough"); };
  CHECK_THROWS_WITH(prepared.trace(hooks), "enough");
  check_same(prepared.trace(), run(body()));
  clray::Scene bad = body();
  bad.materials[0].parameters["rho"] = 2.0;
  CHECK_THROWS_AS(prepared.trace(bad), clray::Error);
  check_same(prepared.trace(), run(body()));
}

TEST_CASE("threads, each with a prepared scene of its own, on one device") {
  std::vector<std::uint64_t> found(4), right(4);
  std::vector<std::thread> threads;
  const auto scene_of_thread = [](std::size_t t) {
    clray::Scene scene = body();
    scene.source.direction = toward(0.2 + 0.1 * static_cast<double>(t));
    return scene;
  };
  for (std::size_t t = 0; t < found.size(); ++t) {
    right[t] = run(scene_of_thread(t)).digest;
    threads.emplace_back([&, t] {
      clray::Prepared prepared(body(), device());
      for (int again = 0; again < 3; ++again) found[t] = prepared.trace(scene_of_thread(t)).digest;
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(found == right);
}

TEST_CASE("a prepared scene that was moved from says so") {
  clray::Prepared first(body(), device());
  const clray::Prepared second = std::move(first);
  CHECK_THROWS_WITH_AS(first.trace(), doctest::Contains("moved from"), clray::Error);
  CHECK(second.scene().components.size() == 2);
}
