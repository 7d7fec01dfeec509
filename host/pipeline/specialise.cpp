// SPDX-License-Identifier: Apache-2.0
// What the program of a pass contains, and the reasons: the rows of the tables that the scene uses, the kinds of rays
// and sums that the pass needs, and its sizes. What a scene does not need is not compiled.
#include <algorithm>
#include <utility>

#include "device/device_impl.hpp"
#include "device/kernel_cache.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/exact_sights.hpp"
#include "pipeline/plan.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

// Fragments that a work-item of an exact pass has room for. Few need more, and the host finishes those; results do not
// depend on it.
constexpr std::uint64_t kWaiting = 24;
constexpr std::uint64_t kFewKept = 24;  // numbers that a work-item keeps of a row where that is optional
// Building a program with packets takes about half a second longer, once. Fewer rays do not win that back.
constexpr std::uint64_t kManyRays = 1u << 20;
// The compiler's optimiser takes one to four seconds, once. Without it rays are five times as slow: so few of them take
// less than a tenth of a second more.
constexpr std::uint64_t kManyForOptimiser = 1u << 15;
constexpr int kRunsWithoutOptimiser = 8;  // of one program, by any process
constexpr const char* kFewRays = "so few rays are traced sooner without";
constexpr const char* kOptimiser = "the compiler's optimiser";

constexpr const char* kWalk = "walk ";
constexpr std::uint32_t kChunk = 16;         // points of a work-item
constexpr std::uint32_t kPacketChunk = 256;  // points of each replicate of a work-item with packets
constexpr const char* kPackets = "packets of rays: ";

/// Lets rays go as a row of the walks says.
void set_walk(const std::string& walk, Specialised* program) {
  program->options.walk = table_index("walk", walk);
  program->options.defines["CLRAY_PACKET"] = walk == "packet" ? "1" : "0";
  program->options.defines["CLRAY_PLACED"] = walk == "placed" ? "1" : "0";
  std::vector<std::string>& kept = program->kept;
  const auto is_walk = [](const std::string& line) { return line.rfind(kWalk, 0) == 0; };
  kept.erase(std::remove_if(kept.begin(), kept.end(), is_walk), kept.end());
  kept.push_back(kWalk + walk + ": " + table_row("walk", walk).meaning);
}

/// Lets the program be compiled for the speed of its rays, or for a start as soon as possible.
void set_optimised(bool optimised, Specialised* program) {
  program->options.optimised = optimised;
  const std::string line = std::string(kOptimiser) + ": " + kFewRays;
  std::vector<std::string>& out = program->left_out;
  if (optimised)
    out.erase(std::remove(out.begin(), out.end(), line), out.end());
  else
    out.push_back(line);
}

class Specialiser {
 public:
  Specialiser(const Scene& scene, const Geometry& geometry, const PassPlan& plan)
      : scene_(scene), geometry_(geometry), plan_(plan), all_(!scene.trace.specialise) {}

  Specialised run() {
    out_.kept = plan_.request.method;
    if (plan_.request.without_rays()) return faces();
    first_hits();
    tables();
    walk();
    if (at_most(kManyForOptimiser)) set_optimised(false, &out_);
    const TraceOptions& t = scene_.trace;
    out_.open_ended = t.rays == 0 && t.target_error_percent > 0.0 && t.walk != "packet" && !at_most(kManyForOptimiser);
    detectors();
    rays();
    sizes();
    return std::move(out_);
  }

 private:
  // An exact pass has a program of its own (exact.cl), which knows faces and no surfaces.
  Specialised faces() {
    const ExactNumbers numbers = exact_numbers(plan_);
    out_.entry = "exact.cl";
    define("CLRAY_LANES", numbers.lanes);
    define("CLRAY_BINNINGS", numbers.binnings);
    define("CLRAY_FROM_SOURCE", numbers.from_source ? 1 : 0);
    define("CLRAY_CARRY", numbers.carry ? 1 : 0);
    define("CLRAY_EXACT_STACK", kWaiting);
    define("CLRAY_TILES", numbers.tiles ? 1 : 0);
    if (numbers.tiles) {
      out_.kept.push_back("faces, tiles that one face covers, and points in the others");
      if (numbers.carry)
        out_.kept.push_back("points carried into the beam of the light: an observer is not at the source");
      out_.left_out.push_back("rays: points of tiles see the few faces there");
    } else {
      out_.kept.push_back("faces, tiles and their visible parts: visibility is solved");
      if (numbers.carry) out_.kept.push_back("lit pieces carried to other views: an observer is not at the source");
      out_.left_out.push_back("rays, their random numbers and replicates: nothing is sampled");
    }
    if (!numbers.carry) out_.left_out.push_back("views from elsewhere: what is lit is all that is seen");
    if (!geometry_.trees) out_.left_out.push_back("trees: no pass has rays");
    return std::move(out_);
  }

  // What rays leave out of their first hits, since it is solved.
  void first_hits() {
    const bool connected = first_is_exact(scene_, plan_.request, true);
    const bool pushed = first_is_exact(scene_, plan_.request, false);
    define("CLRAY_SKIP_FIRST", plan_.request.mirrors || connected ? 1 : 0);
    define("CLRAY_SKIP_PUSH", pushed ? 1 : 0);
    define("CLRAY_CURVED", plan_.unsolved.bits.empty() ? 0 : 1);
    if (!connected && !pushed) return;
    out_.kept.push_back("faces, tiles and their visible parts: the first bounce is solved");
    if (!plan_.unsolved.bits.empty()) {
      out_.kept.push_back("first hits of curved shapes and of faces that they may shade: they are not solved");
      out_.left_out.push_back("connections of other first hits: they are solved, rays find the rest");
    } else if (connected)
      out_.left_out.push_back("connections of first hits: they are solved, rays find the rest");
    if (pushed) out_.left_out.push_back("push of first hits: it is solved, rays find the rest");
  }

  void define(const std::string& name, std::uint64_t value) { out_.options.defines[name] = std::to_string(value); }

  void decide(const char* name, bool needed, const std::string& what, const std::string& why_kept,
              const std::string& why_not) {
    const bool on = needed || all_;
    define(name, on ? 1 : 0);
    if (on) {
      out_.kept.push_back(what + ": " + (needed ? why_kept : "generic program (--no-specialise)"));
    } else {
      out_.left_out.push_back(what + ": " + why_not);
    }
  }

  void choose(const char* kind, const std::vector<int>& used, std::vector<int>* rows_out, const char* what) {
    std::string kept, left;
    const std::vector<TableRow>& rows = table(kind);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const bool on = all_ || std::find(used.begin(), used.end(), static_cast<int>(r)) != used.end();
      if (on) rows_out->push_back(static_cast<int>(r));
      std::string& list = on ? kept : left;
      list += (list.empty() ? "" : ", ") + rows[r].name;
    }
    if (!kept.empty()) out_.kept.push_back(std::string(what) + " " + kept + ": in the scene");
    if (!left.empty()) out_.left_out.push_back(std::string(what) + " " + left + ": not in the scene");
  }

  void tables() {
    choose("brdf", plan_.materials.models, &out_.options.brdfs, "surface models");
    choose("shape", geometry_.shape_rows, &out_.options.shapes, "shapes");
    std::string others;
    for (const TableRow& row : table("detector")) {
      const bool asked = std::any_of(scene_.detectors.begin(), scene_.detectors.end(),
                                     [&](const DetectorSpec& d) { return d.kind == row.name; });
      if (!asked && !row.inner) others += (others.empty() ? "" : ", ") + row.name;
    }
    if (!others.empty()) out_.left_out.push_back("detectors " + others + ": not asked for");
  }

  // Which detectors look at which moments, where each kind's detectors begin, and what work-items keep of their sums.
  void detectors() {
    std::map<std::string, std::string> hooks;
    const std::vector<TableRow>& rows = table("detector");
    std::vector<std::uint64_t> counts(rows.size()), firsts(rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const TableRow& row = rows[r];
      std::uint64_t first = plan_.detectors.size(), count = 0;
      for (std::size_t d = 0; d < plan_.detectors.size(); ++d) {
        if (plan_.detectors[d].row != static_cast<int>(r)) continue;
        first = std::min<std::uint64_t>(first, d);
        ++count;
      }
      define("CLRAY_COUNT_" + row.id, count);
      if (count == 0) continue;
      define("CLRAY_FIRST_" + row.id, first);
      if (!row.hooks.empty()) out_.options.detectors.push_back(static_cast<int>(r));
      for (const std::string& hook : row.hooks) hooks[hook] += " X(" + row.id + ")";
      counts[r] = count;
      firsts[r] = first;
    }
    // What work-items keep: sums first, then what is the greatest of something (kernels/stage/gather.cl).
    std::uint64_t kept = 0;
    for (const bool greatest : {false, true}) {
      for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t s = 0; counts[r] > 0 && s < rows[r].sums.size(); ++s) {
          const TableSum& sum = rows[r].sums[s];
          if ((sum.scale == SumScale::greatest) != greatest) continue;
          keep(rows[r], sum, plan_.layout.blocks[plan_.detectors[firsts[r]].first_block + s], counts[r], &kept);
        }
      }
      if (!greatest) define("CLRAY_KEPT_SUMS", kept);
    }
    define("CLRAY_KEPT", std::max<std::uint64_t>(kept, 1));
    for (const std::string& hook : detector_hooks()) out_.options.defines["CLRAY_HOOK_" + hook + "(X)"] = hooks[hook];
  }

  void keep(const TableRow& row, const TableSum& sum, const SumBlock& block, std::uint64_t detectors,
            std::uint64_t* kept) {
    if (sum.keep == SumKeep::nothing) return;
    std::uint64_t size = sum.keep == SumKeep::number ? 1 : block.width;
    if (sum.rows != SumRows::view) size *= plan_.request.lanes.size();
    if (sum.rows == SumRows::connection) size *= plan_.traits.connections;
    if (sum.keep == SumKeep::small_row && size > kFewKept) return;
    define("CLRAY_KEPT_" + row.id + "_" + sum.name, *kept);
    *kept += size * detectors;
  }

  bool moving_parts() const {
    return std::any_of(geometry_.parts.begin(), geometry_.parts.end(),
                       [](const Part& part) { return part.hinged_component >= 0; });
  }

  // Whether all rays of the pass are known to be at most so many.
  bool at_most(std::uint64_t rays) const {
    const TraceOptions& t = scene_.trace;
    const std::uint64_t most = t.rays != 0 ? std::min(t.rays, t.max_rays) : t.max_rays;
    return most <= rays && most * plan_.request.orientations.size() <= rays;
  }

  // Why rays do not go in packets on any device, or "". Packets have points of every replicate, in one direction and
  // one frame.
  std::string no_packets() const {
    const std::string& asked = scene_.trace.walk;
    if (asked != "auto" && asked != "packet") return "walk " + asked + " was asked for";
    if (plan_.request.pixels) return "rays of pixels go alone";
    if (scene_.trace.sampler == SamplerKind::random) return "neighbours of random points are not known";
    if (moving_parts()) return "a component is hinged";
    if (plan_.request.replicates != 16) return "they are for 16 replicates";
    if (all_) return "generic program (--no-specialise)";
    return asked == "auto" && at_most(kManyRays - 1) ? kFewRays : "";
  }

  void walk() {
    const std::string &asked = scene_.trace.walk, why = no_packets();
    const bool alone = asked == "auto" || asked == "packet";
    // Random points have no neighbours, and those of a pixel have nowhere else to be.
    out_.walk_is_free = alone && scene_.trace.sampler != SamplerKind::random && !plan_.request.pixels;
    if (!why.empty()) out_.left_out.push_back(kPackets + why);
    set_walk(why.empty() ? "packet" : alone ? "plain" : asked, &out_);
  }

  bool shadows() const {
    return std::any_of(plan_.beams.connections.begin(), plan_.beams.connections.end(),
                       [](const ClrayConnection& c) { return c.shadow != 0; });
  }

  void rays() {
    const PathTraits& t = plan_.traits;
    const bool bistatic = shadows(), may_hide = t.connect && (bistatic || t.max_bounces > 1);
    const bool bounded = std::all_of(plan_.materials.models.begin(), plan_.materials.models.end(),
                                     [](int row) { return table("brdf")[static_cast<std::size_t>(row)].bounded; });
    decide("CLRAY_SHADOW", may_hide && !geometry_.convex(), "shadow rays",
           bistatic ? "an observer is not at the source" : "later bounces are connected",
           !t.connect ? "nothing is connected to an observer"
           : may_hide ? "the body is convex: what faces the observer is seen"
                      : "the observer is at the source: what is lit is seen");
    decide("CLRAY_SCATTER", t.scatter, "scattered directions",
           t.max_bounces > 1       ? "several bounces"
           : plan_.materials.delta ? "mirrors"
                                   : "a detector follows the light on",
           "one bounce, connected directly");
    decide("CLRAY_DELTA", plan_.materials.delta, "ideal reflections", "a mirror is in the scene",
           "no mirror in the scene");
    decide("CLRAY_ONE_SIDED", plan_.materials.one_sided, "black backs", "a material is one-sided",
           "every material reflects from both sides");
    decide("CLRAY_PLANES", geometry_.shared_planes, "faces in one plane",
           "some overlap: the one that faces the ray is hit", "no faces overlap in one plane");
    const bool pieces = !geometry_.leaves.empty();  // a generic program has no list to read where the body has none
    define("CLRAY_PIECES", pieces ? 1 : 0);
    if (pieces)
      out_.kept.push_back("faces in several leaves: some are long and lie askew, and the tree holds pieces of them");
    else
      out_.left_out.push_back("faces in several leaves: the tree holds every face once");
    decide("CLRAY_INSTANCED", moving_parts(), "moving parts and their transforms", "a component is hinged",
           "no component is hinged; fixed transforms are done once on the host");
    decide("CLRAY_WIDE", t.scatter || bistatic || !bounded, "second accumulator",
           "weights may exceed the bound of a first bounce", "weights of these surfaces are bounded");
    define("CLRAY_STRATA", plan_.beams.strata.empty() ? 0 : 1);
    if (!plan_.beams.strata.empty()) {
      out_.kept.push_back("strata of the beam: the Sobol sampler, spread over the body's silhouette, delays and peaks");
      out_.left_out.push_back("rays beside the body: cells of the beam's rectangle that nothing projects into");
    }
    const auto made_of_faces = [](int row) { return table("shape")[static_cast<std::size_t>(row)].faces; };
    const std::vector<int>& rows = geometry_.shape_rows;
    decide("CLRAY_TRIANGLES", std::any_of(rows.begin(), rows.end(), made_of_faces), "triangle test",
           "a mesh is in the scene", "no mesh in the scene");
    decide("CLRAY_ANALYTIC", !std::all_of(rows.begin(), rows.end(), made_of_faces), "analytic shapes", "in the scene",
           "the scene is made of triangles");
    if (plan_.request.lanes.size() == 1)
      out_.left_out.push_back("wavelengths and variants: one lane, one number per material");
  }

  void sizes() {
    define("CLRAY_PIXELS", plan_.request.pixels ? 1 : 0);
    define("CLRAY_MIRRORS_FIRST", plan_.request.mirrors ? 1 : 0);
    define("CLRAY_CONNECT", plan_.traits.connect ? 1 : 0);
    define("CLRAY_SOBOL", scene_.trace.sampler != SamplerKind::random ? 1 : 0);
    define("CLRAY_LANES", plan_.request.lanes.size());
    define("CLRAY_CONNECTIONS", plan_.traits.connections);
    // Few sizes, so that scenes share programs.
    const std::uint32_t stack = geometry_.stack_needed + 1;
    define("CLRAY_STACK", all_ || stack > 96 ? 192 : stack > 48 ? 96 : stack > 24 ? 48 : 24);
  }

  const Scene& scene_;
  const Geometry& geometry_;
  const PassPlan& plan_;
  const bool all_;
  Specialised out_;
};

/// Whether a run is one of the first of its program on that device, in any process, and counts it.
bool among_first_runs(const OpenedDevice& opened, const std::string& program) {
  for (int k = 1; k <= kRunsWithoutOptimiser; ++k) {
    const std::string run = "run " + std::to_string(k) + " without the optimiser\n" + program;
    if (remembered(opened, run)) continue;
    remember(opened, run);
    return true;
  }
  return false;
}

/// Whether the optimised program stands ready for every device, or the other was used often enough.
bool optimiser_pays(Device& device, const Specialised& program) {
  Device::Impl& impl = device.impl();
  ProgramOptions options = program.options;
  options.optimised = true;
  const std::string name = program_name(program.entry, options);
  const auto is_kept = [&](const OpenedDevice& opened) { return program_is_kept(opened, program.entry, options); };
  return ++impl.runs_without_optimiser[name] > kRunsWithoutOptimiser ||
         std::all_of(impl.devices.begin(), impl.devices.end(), is_kept) ||
         !among_first_runs(impl.devices.front(), name);
}

/// Begins with a program that stands sooner.
void begin_without_optimiser(PassPlan* plan) {
  plan->lasting = plan->program;
  if (in_packets(*plan)) {
    set_walk("plain", &plan->program);
    plan->program.left_out.push_back(std::string(kPackets) + kFewRays);
  }
  set_optimised(false, &plan->program);
}

}  // namespace

bool in_packets(const PassPlan& plan) {
  const auto packet = plan.program.options.defines.find("CLRAY_PACKET");
  return packet != plan.program.options.defines.end() && packet->second == "1";
}

std::uint32_t chunk_of(const PassPlan& plan) {
  if (in_packets(plan)) return kPacketChunk;
  return table("walk")[static_cast<std::size_t>(plan.program.options.walk)].name == "placed" ? 1 : kChunk;
}

void set_walk(const std::string& walk, PassPlan* plan) {
  set_walk(walk, &plan->program);
}

void fit_to(Device& device, bool used_again, std::vector<PassPlan>* plans) {
  const std::vector<OpenedDevice>& devices = device.impl().devices;
  const bool all_cpus =
      std::all_of(devices.begin(), devices.end(), [](const OpenedDevice& opened) { return opened.is_cpu(); });
  for (PassPlan& plan : *plans) {
    Specialised& program = plan.program;
    if (!all_cpus && in_packets(plan)) program.left_out.push_back(std::string(kPackets) + "they are for CPUs");
    if (!all_cpus && program.walk_is_free) set_walk("placed", &program);
    if (plan.request.without_rays() || (program.options.optimised && !program.open_ended)) continue;
    const bool pays = used_again || !all_cpus || optimiser_pays(device, program);
    if (pays && !program.options.optimised) set_optimised(true, &program);
    if (!pays && program.options.optimised) begin_without_optimiser(&plan);
  }
}

void take_lasting_program(PassPlan* plan) {
  if (plan->lasting) plan->program = *std::exchange(plan->lasting, std::nullopt);
}

Specialised specialise(const Scene& scene, const Geometry& geometry, const PassPlan& plan) {
  return Specialiser(scene, geometry, plan).run();
}

}  // namespace clray
