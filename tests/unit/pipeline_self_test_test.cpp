// SPDX-License-Identifier: Apache-2.0
// The self-test that traces passes here for programs of every kind, and refuses one that traces wrongly (played by
// edits of the kernels' text). The host's kernels, which it is held against, give a device's bits for other scenes as
// well.
#include <doctest/doctest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "device/kernel_cache.hpp"
#include "device/platforms.hpp"
#include "pipeline/built_in_scene.hpp"
#include "pipeline/device_pass.hpp"
#include "pipeline/host_pass.hpp"
#include "pipeline/traced_self_test.hpp"
#include "scene/tables.hpp"
#include "support/sanitized.hpp"
#include "unit/device_support.hpp"

using namespace clray;
using clray::test::files_with_fault;
using clray::test::opened_cpu;

namespace {

/// Everything in the tables that a beam can meet.
ProgramContent everything() {
  ProgramContent content;
  for (const TableRow& row : table("brdf")) content.models.push_back(row.name);
  for (const TableRow& row : table("shape")) content.shapes.push_back(row.name);
  for (const TableRow& row : table("detector")) {
    if (row.beam && !row.inner) content.detectors.push_back(row.name);
  }
  content.lanes = content.connections = 2;
  content.components = 4;
  content.scatter = content.hinged = content.one_sided = content.shared_planes = true;
  return content;
}

/// One bounce toward an observer at the source, of one shape and surface.
ProgramContent simple(const std::string& shape, const std::string& model, const std::string& detector = "delay") {
  ProgramContent content;
  content.shapes = {shape};
  content.models = {model};
  content.detectors = {detector};
  return content;
}

/// The plan of a built-in scene, of which every other primitive is as if solved where the content says so.
PassPlan plan_of(const ProgramContent& content) {
  PassPlan plan = built_in_scene(content).plan;
  if (content.curved) {
    plan.program.options.defines["CLRAY_SKIP_FIRST"] = "1";
    plan.program.options.defines["CLRAY_CURVED"] = "1";
  }
  return plan;
}

/// What the self-test says when `text` in kernel file `path` reads `fault` instead.
std::string refusal(const ProgramContent& content, const std::string& path, const std::string& text,
                    const std::string& fault) {
  static OpenedDevice opened = opened_cpu();  // one context: each reads the driver's library of built-in functions
  const KernelFiles files = files_with_fault(path, text, fault);
  PassPlan plan = plan_of(content);
  plan.program.options.optimised = false;  // the fault is in the text
  try {
    run_traced_self_test(opened, plan, true, files);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::device);
    CHECK(error.context() == opened.info.name);
    return error.message();
  }
  return "passed";
}

void check_refused(const ProgramContent& content, const std::string& path, const std::string& text,
                   const std::string& fault) {
  const std::string message = refusal(content, path, text, fault);
  INFO(path << ": " << fault << ": " << message);
  CHECK(message.find("refused: the self-test traced a small scene wrongly: ") == 0);
}

}  // namespace

TEST_CASE("the host's kernels give their known answers") {
  CHECK_NOTHROW(check_host_kernels());
}

TEST_CASE("rays of the built-in scene hit, miss, scatter and end in every way, on shallow stacks") {
  for (const bool pixels : {false, true}) {
    ProgramContent content = everything();
    content.pixels = pixels;
    if (pixels) {
      content.detectors = {"rgb"};
      content.connections = 1;
    }
    const BuiltInScene built = built_in_scene(content);
    CHECK(built.geometry.stack_needed < 24);  // the smallest stack that programs have
    const Sums sums = trace_on_host(built.plan, built.geometry, 128, 16);
    REQUIRE(sums.events.size() == 2);
    for (const auto& events : sums.events) {
      CHECK(events[CLRAY_COUNT_STARTED] == 128u * built.plan.request.replicates * (pixels ? 12 : 1));
      for (const int event : {CLRAY_COUNT_NON_FINITE, CLRAY_COUNT_STACK, CLRAY_COUNT_LOST, CLRAY_COUNT_OVERFLOW})
        CHECK(events[event] == 0);
    }
    for (const int event : {CLRAY_COUNT_ESCAPED, CLRAY_COUNT_KILLED, CLRAY_COUNT_CAPPED}) {
      INFO("event " << event << ", pixels " << pixels);
      CHECK(sums.events[0][event] + sums.events[1][event] > 0);
    }
    std::size_t filled = 0;
    for (std::size_t k = 0; k < sums.values.size(); ++k) filled += sums.values[k] != 0;
    CHECK(filled * 3 > sums.values.size());
  }
}

TEST_CASE("programs of every kind pass") {
  std::vector<ProgramContent> contents{simple("mesh", "tabulated"), simple("sphere", "ggx", "pressure")};
  contents[0].sobol = contents[0].strata = false;
  contents[1].components = 2;
  contents[1].lanes = 2;
  contents[1].scatter = true;
  contents.push_back(simple("box", "mirror", "rgb"));
  contents.back().pixels = contents.back().scatter = contents.back().shared_planes = true;
  contents.push_back(contents.back());
  contents.back().pixels = false;
  contents.back().mirrors = true;
  contents.push_back(everything());
  contents.back().detectors = {"delay", "pressure", "delay"};
  contents.back().specialised = false;
  for (const char* walk : {"packet", "placed"}) {
    contents.push_back(simple("mesh", "lambert"));
    contents.back().walk = walk;
    contents.push_back(everything());
    contents.back().hinged = false;
    contents.back().walk = walk;
  }
  contents.push_back(simple("box", "mirror", "rgb"));
  contents.back().pixels = contents.back().scatter = true;
  contents.back().walk = "placed";
  contents.push_back(everything());
  contents.back().curved = true;
  if (std::getenv("CLRAY_LONG_TESTS") == nullptr) contents.resize(5);  // each run of a new program passes one, too
  OpenedDevice opened = opened_cpu();
  for (const ProgramContent& content : contents) {
    const BuiltInScene built = built_in_scene(content);
    CHECK(in_packets(built.plan) == (content.walk == "packet"));
    CHECK_NOTHROW(run_traced_self_test(opened, plan_of(content), content.specialised, KernelFiles(embedded_kernels())));
  }
}

TEST_CASE("a program that traces wrongly is refused") {
  const ProgramContent mesh = simple("mesh", "lambert"), sphere = simple("sphere", "lambert");
  // Compilers that cut a loop, count bits wrongly, place shapes wrongly.
  check_refused(mesh, "walk/plain.cl", "k < 4", "k < 3");
  check_refused(mesh, "trace.cl", "clz(parts)", "(clz(parts) + 1u)");
  check_refused(sphere, "stage/intersect.cl", "v3_sub(point, v3_load(data + CLRAY_SHAPE_ORIGIN))", "point");
  // And elsewhere: surfaces, sums, strata, lanes, hinges.
  check_refused(sphere, "brdf/lambert.cl", "CLRAY_INV_PI", "0.3183");
  check_refused(sphere, "detector/delay.cl", "floor(x)", "(x + 0.5)");
  check_refused(sphere, "math/strata.cl", "1.0 - along", "along");
  ProgramContent lanes = simple("sphere", "lambert", "pressure");
  lanes.lanes = 2;
  lanes.scatter = true;
  check_refused(lanes, "stage/scatter.cl", "sum / (f64)CLRAY_LANES", "sum");
  check_refused(lanes, "detector/books.cl", "1.0 - surface_reflectance", "surface_reflectance");
  ProgramContent hinged = mesh;
  hinged.hinged = true;
  check_refused(hinged, "stage/intersect.cl", "instance->moved", "0");
  ProgramContent curved = everything();
  curved.curved = true;
  check_refused(curved, "stage/shade.cl", "primitive & 31u", "(primitive ^ 1u) & 31u");
  ProgramContent packets = mesh;
  packets.walk = "packet";
  check_refused(packets, "stage/packet.cl", "const double4 edge = x1 * y2 - y1 * x2",
                "const double4 edge = x1 * y2 + y1 * x2");
  check_refused(packets, "stage/packet.cl", "hit->weights = v3(us[k], vs[k], ws[k])",
                "hit->weights = v3(us[k], ws[k], vs[k])");
  check_refused(packets, "stage/packet_points.cl", "even_bits(part >> 1)", "even_bits(part)");
  ProgramContent placed = mesh;
  placed.walk = "placed";
  check_refused(placed, "math/sobol_place.cl", "v = a == b ? even : odd", "v = even");
  check_refused(placed, "stage/gather.cl", "(i64)all->greatest[CLRAY_KEPT * r + k]", "(i64)all->greatest[k]");
  check_refused(placed, "stage/gather.cl", "tally.escaped = all->events[1]", "tally.escaped = all->events[2]");
  packets.connections = 2;
  check_refused(packets, "stage/packet.cl", "least - packet_along(p, o)", "0.5");
  check_refused(packets, "stage/packet_item.cl", "of[p.rays++] = k", "of[p.rays++] = p.rays");
}

TEST_CASE("what passed is remembered for that device and program, with a checksum, and costs less than 5 ms") {
  namespace fs = std::filesystem;
  OpenedDevice opened = opened_cpu();
  const BuiltInScene built = built_in_scene(simple("sphere", "lommel-seeliger"));
  run_traced_self_test(opened, built.plan, true);
  const std::string what =
      "traced\n" + program_source(opened, "trace.cl", built.plan.program.options, embedded_kernels());
  CHECK(remembered(opened, what));
  CHECK_FALSE(remembered(opened, what + " "));
  OpenedDevice other = opened_cpu();
  other.info.driver += " of tomorrow";
  CHECK_FALSE(remembered(other, what));
  double best_s = 1e9;
  for (int i = 0; i < 20; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run_traced_self_test(opened, built.plan, true);
    best_s = std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  MESSAGE("warm self-test: " << 1000.0 * best_s << " ms");
  if (!clray_test::kSanitized) CHECK(best_s < 0.005);
}
