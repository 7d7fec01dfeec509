// SPDX-License-Identifier: Apache-2.0
// See traced_self_test.hpp. Known answers guard the kernels' text and the host's compiler; the comparison of every sum
// guards the device's compiler, its driver and itself, for programs of any size and content.
#include "pipeline/traced_self_test.hpp"

#include <fmt/format.h>

#include "clray/error.hpp"
#include "device/kernel_cache.hpp"
#include "pipeline/built_in_scene.hpp"
#include "pipeline/device_pass.hpp"
#include "pipeline/estimate.hpp"
#include "pipeline/host_pass.hpp"
#include "pipeline/outcome.hpp"
#include "text/hash.hpp"

namespace clray {
namespace {

constexpr std::uint32_t kPoints = 128, kChunk = 16;

/// A scene with its digest on PoCL 3.1, which ten other OpenCL implementations share (tests/identity).
struct KnownAnswer {
  ProgramContent content;
  std::uint64_t digest;
};

std::vector<KnownAnswer> known_answers() {
  ProgramContent all;
  all.models = {"lambert", "ashikhmin-shirley", "lommel-seeliger", "mirror", "ggx", "tabulated"};
  all.shapes = {"mesh", "sphere", "cylinder", "disk", "cone", "paraboloid", "rectangle", "box"};
  all.detectors = {"delay", "spectrometer", "pressure"};
  all.lanes = 2;
  all.connections = 2;
  all.components = 3;
  all.scatter = all.hinged = all.one_sided = all.shared_planes = true;
  ProgramContent plain = all;
  plain.models = {"lambert", "ashikhmin-shirley", "lommel-seeliger", "ggx", "tabulated"};
  plain.detectors = {"delay"};
  plain.lanes = plain.connections = 1;
  plain.scatter = plain.hinged = plain.one_sided = plain.shared_planes = plain.strata = plain.sobol = false;
  ProgramContent picture = all;
  picture.detectors = {"rgb"};
  picture.connections = 1;
  picture.pixels = true;
  return {{all, 0x5d35d989950f73fa}, {plain, 0x98feca2e23d0213d}, {picture, 0x36e606da4e9fa6b5}};
}

std::uint64_t digest_with_events(const PassPlan& plan, const Sums& sums) {
  return fnv1a(digest_of(kFnvStart, plan, sums), sums.events.data(), sums.events.size() * sizeof sums.events.front());
}

[[noreturn]] void refuse(const OpenedDevice& opened, const std::string& what) {
  throw Error(ErrorCode::device, "refused: the self-test traced a small scene wrongly: " + what, opened.info.name);
}

/// The sizes that both programs are built with, since the built-in scene has the buffers of one and the code of the
/// other.
void check_sizes(const ProgramOptions& own, const ProgramOptions& other) {
  for (const auto& [name, value] : own.defines) {
    const bool size = name == "CLRAY_LANES" || name == "CLRAY_CONNECTIONS" || name.rfind("CLRAY_COUNT_", 0) == 0 ||
                      name.rfind("CLRAY_FIRST_", 0) == 0 || name.rfind("CLRAY_KEPT", 0) == 0;
    const auto found = other.defines.find(name);
    if (size && (found == other.defines.end() || found->second != value))
      throw Error(ErrorCode::bug, fmt::format("the built-in scene has another {}", name), "self-test");
  }
}

/// Which block of the layout holds value (or count) `at`.
std::string block_name(const PassPlan& plan, std::size_t at, bool counts) {
  for (const PassDetector& d : plan.detectors) {
    for (std::uint32_t b = d.first_block; b < d.last_block; ++b) {
      const SumBlock& block = plan.layout.blocks[b];
      if (block.counts() == counts && at >= block.offset && at < block.offset + block.size())
        return table("detector")[static_cast<std::size_t>(d.row)].id + "." + block.name;
    }
  }
  return "?";
}

void compare(const OpenedDevice& opened, const PassPlan& plan, const Sums& expected, const Sums& found) {
  for (std::size_t v = 0; v < expected.events.size(); ++v) {
    for (std::size_t c = 0; c < CLRAY_COUNTERS; ++c) {
      const std::uint64_t right = expected.events[v][c], seen = found.events[v][c];
      if (right != seen) refuse(opened, fmt::format("event {} happened {} times, not {}", c, seen, right));
    }
  }
  for (std::size_t k = 0; k < expected.values.size(); ++k) {
    if (expected.values[k] != found.values[k])
      refuse(opened, fmt::format("sum {} of {} is wrong", k, block_name(plan, k, false)));
  }
  for (std::size_t k = 0; k < expected.counts.size(); ++k) {
    if (expected.counts[k] != found.counts[k])
      refuse(opened, fmt::format("count {} of {} is wrong", k, block_name(plan, k, true)));
  }
}

}  // namespace

void check_host_kernels() {
  static const std::string wrong = [] {
    std::string found, known;
    for (const KnownAnswer& answer : known_answers()) {
      const BuiltInScene built = built_in_scene(answer.content);
      const Sums sums = trace_on_host(built.plan, built.geometry, kPoints, kChunk);
      found += fmt::format(" {:016x}", digest_with_events(built.plan, sums));
      known += fmt::format(" {:016x}", answer.digest);
    }
    return found == known ? "" : fmt::format("(digests{}, known{})", found, known);
  }();
  if (wrong.empty()) return;
  throw Error(ErrorCode::device,
              "refused: clray itself traces small scenes wrongly " + wrong +
                  "; its kernels were changed, or its compiler breaks them",
              "self-test");
}

void run_traced_self_test(OpenedDevice& opened, const PassPlan& plan, bool specialised, const KernelFiles& files) {
  if (!host_has_room(plan)) return;
  const bool embedded = &files == &embedded_kernels();
  const ProgramOptions& options = plan.program.options;
  const std::string what = std::string("traced\n") + (options.optimised ? "" : "without the optimiser\n") +
                           program_source(opened, "trace.cl", options, files);
  if (embedded && remembered(opened, what)) return;
  check_host_kernels();
  BuiltInScene built = built_in_scene(content_of(plan, specialised));
  check_sizes(built.plan.program.options, options);
  built.plan.program = plan.program;
  const Sums expected = trace_on_host(built.plan, built.geometry, kPoints, kChunk);
  DevicePass device(opened, built.plan, built.geometry, files);
  const std::uint32_t chunk = std::min(kChunk, chunk_of(plan));
  const auto items = static_cast<std::uint32_t>(items_of(built.plan, built.plan.beams.views.size(), kPoints, chunk));
  device.launch_items(0, items, {0, kPoints, chunk}, in_packets(plan) ? 1 : 64);
  Sums found(built.plan.layout);
  device.drain(&found);
  compare(opened, built.plan, expected, found);
  if (embedded) remember(opened, what);
}

}  // namespace clray
