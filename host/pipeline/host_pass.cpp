// SPDX-License-Identifier: Apache-2.0
// See host_pass.hpp. The kernels read the sizes and choices that a device's program is built with from `numbers`.
#include "pipeline/host_pass.hpp"

#include <algorithm>
#include <string>

#include "body/host_opencl.hpp"
#include "clray/error.hpp"
#include "pipeline/pass_buffers.hpp"
#include "shared/abi.h"
#include "shared/elementary.h"
#include "shared/philox.h"

// Some functions of the kernels stay unused.
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wsign-compare"

#include "generated/program_numbers.inc"

#define CLRAY_TRIANGLES 1
#define CLRAY_ANALYTIC 1
#define CLRAY_LANE_ROOM 64
#define CLRAY_KEPT_ROOM 65536

namespace clray {
namespace {

/// The numbers that are macros in a device's program.
struct ProgramNumbers {
#define CLRAY_NUMBER(name) u32 name##_ = 0;
  CLRAY_PROGRAM_NUMBERS(CLRAY_NUMBER)
#undef CLRAY_NUMBER
};

thread_local ProgramNumbers numbers;

#include "trace.cl"

ProgramNumbers numbers_of(const ProgramOptions& options) {
  ProgramNumbers n;
  const auto read = [&](const char* name) -> u32 {
    const auto define = options.defines.find(name);
    return define == options.defines.end() ? 0u : static_cast<u32>(std::stoul(define->second));
  };
#define CLRAY_NUMBER(name) n.name##_ = read(#name);
  CLRAY_PROGRAM_NUMBERS(CLRAY_NUMBER)
#undef CLRAY_NUMBER
  return n;
}

}  // namespace

bool host_has_room(const PassPlan& plan) {
  const ProgramNumbers n = numbers_of(plan.program.options);
  return n.CLRAY_LANES_ <= CLRAY_LANE_ROOM && n.CLRAY_KEPT_ <= CLRAY_KEPT_ROOM;
}

namespace {

/// Replicates and pixels of a view, each with points of its own.
std::uint64_t streams_of(const PassPlan& plan) {
  const PictureSize& size = plan.request.picture;
  const std::uint64_t pixels = plan.request.pixels ? static_cast<std::uint64_t>(size.width) * size.height : 1;
  return plan.request.replicates * pixels;
}

std::uint64_t parts_of(std::uint32_t points, std::uint32_t chunk) {
  return (static_cast<std::uint64_t>(points) + chunk - 1) / chunk;
}

}  // namespace

std::uint64_t items_of(const PassPlan& plan, std::size_t views, std::uint32_t points, std::uint32_t chunk) {
  return parts_of(points, chunk) * views * (in_packets(plan) ? 1 : streams_of(plan));
}

Sums trace_on_host(const PassPlan& plan, const Geometry& geometry, std::uint32_t points, std::uint32_t chunk) {
  if (!host_has_room(plan)) throw Error(ErrorCode::bug, "no room for the pass's lanes or sums", "trace_on_host");
  const PassBuffers in(plan, geometry);
  numbers = numbers_of(plan.program.options);
  std::vector<i64> sums(in.sums.count), wide(in.wide.count), counters(in.counters.count);
  std::vector<u32> counts(in.counts.count);
  const std::uint64_t items = parts_of(points, chunk) * plan.beams.views.size() * streams_of(plan);
  for (global_id = 0; global_id < items; ++global_id) {
    clray_trace(in.pass.data, in.views.data, in.asked.data, in.connections.data, in.nodes.data, in.leaves.data,
                in.primitives.data, in.shapes.data, in.instances.data, in.materials.data, in.tables.data,
                in.directions.data, in.detectors.data, in.blocks.data, in.settings.data, in.strata.data,
                in.unsolved.data, sums.data(), wide.data(), counts.data(), counters.data(), 0, static_cast<u32>(items),
                0, points, chunk);
  }
  Sums out(plan.layout);
  for (std::uint64_t& view : out.points) view = points;
  for (std::size_t k = 0; k < sums.size(); ++k)
    out.values.set(k, sums[k] + (wide.size() == sums.size() ? static_cast<Sum>(wide[k]) * 4294967296 : 0));
  for (std::size_t k = 0; k < counts.size(); ++k) out.counts.set(k, counts[k]);
  for (std::size_t k = 0; k < counters.size(); ++k)
    out.events[k / CLRAY_COUNTERS][k % CLRAY_COUNTERS] = static_cast<std::uint64_t>(counters[k]);
  return out;
}

}  // namespace clray
