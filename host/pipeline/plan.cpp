// SPDX-License-Identifier: Apache-2.0
// Planning a pass, value by value: what paths do, surfaces, beams, scales, detectors with their sums, strata, program.
// Body frame, metres.
#include "pipeline/plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "beam/beams.hpp"
#include "beam/strata.hpp"
#include "clray/error.hpp"
#include "pipeline/detector/room.hpp"
#include "scene/tables.hpp"

namespace clray {
namespace {

PathTraits traits_of(const Scene& scene, const PassRequest& request, const MaterialTable& materials) {
  PathTraits t;
  t.max_bounces = request.one_bounce ? 1 : scene.trace.max_bounces;
  t.components = static_cast<std::uint32_t>(scene.components.size());
  t.connections = static_cast<std::uint32_t>(request.observers.size());
  bool followed = t.max_bounces > 1;
  for (const int d : request.detectors) {
    const TableRow& row = table_row("detector", scene.detectors[static_cast<std::size_t>(d)].kind);
    t.connect = t.connect || row.connects;
    followed = followed || row.scatters;
  }
  t.scatter = followed || (materials.delta && t.connect && !request.without_rays());
  return t;
}

/// The bound of a view's first-bounce weights. The scale of its sums follows from it, and so depends on the scene and
/// the view alone.
double first_bound(const PassPlan& plan, std::size_t v) {
  double bound = 0.0;
  const double* s = plan.beams.views[v].toward;
  for (std::uint32_t c = 0; c < plan.traits.connections; ++c) {
    const double* o = plan.beams.connections[v * plan.traits.connections + c].direction;
    const double x = s[0] + o[0], y = s[1] + o[1], z = s[2] + o[2];
    const double cos_half = 0.5 * std::sqrt(std::fma(x, x, std::fma(y, y, z * z)));
    bound = std::max(bound, weight_bound(plan.materials, std::max(cos_half, 1e-6)));
  }
  return bound;
}

constexpr int kSumBits = 62 - 24;  // of a slice's 2^24 contributions, each below the limit
constexpr int kExactUnitBits = 58;
constexpr int kExactSumBits = 61;  // the pieces of an exact pass have the beam's area at most, all together

Scales scales_of(const Scene& scene, const Geometry& geometry, const PassPlan& plan) {
  Scales scales;
  for (std::size_t v = 0; v < plan.beams.views.size(); ++v) {
    ViewScales view;
    const double bound = first_bound(plan, v);
    int exponent = 0;
    if (bound > 0.0) std::frexp(bound * (1.0 + 0x1p-20), &exponent);
    view.weight_bits = (plan.request.without_rays() ? kExactSumBits : kSumBits) - exponent;
    const auto [low, high] = plan.paths.view(v);
    view.path_middle_m = 0.5 * low + 0.5 * high;
    view.path_half_m = std::max(0.5 * (high - low), std::ldexp(geometry.radius, -10)) * (1.0 + 0x1p-20);
    scales.views.push_back(view);
  }
  double lever = 0.0;
  for (int i = 0; i < 3; ++i) lever += std::fabs(geometry.centre[i] - scene.reference_point[i]);
  scales.lever_m = std::ldexp(1.0, std::ilogb(std::max(lever + geometry.radius, 1e-300)) + 1);
  return scales;
}

void set_scales(const Scales& scales, std::vector<ClrayView>* views) {
  for (std::size_t v = 0; v < views->size(); ++v) {
    const ViewScales& s = scales.views[v];
    ClrayView& view = (*views)[v];
    view.weight_scale = std::ldexp(1.0, s.weight_bits);
    view.weight_limit = std::ldexp(1.0, kSumBits - s.weight_bits);
    view.path_middle_m = s.path_middle_m;
    view.inv_path_per_m = 1.0 / s.path_half_m;
  }
}

/// One side of a square of the beam's rectangle that holds some 16 faces, as a share 1/n: this n.
std::uint32_t finest_of(const Geometry& geometry) {
  return static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(geometry.primitives.size()) / 16.0)));
}

ClrayPass constants_of(const Scene& scene, const Geometry& geometry, const PassPlan& plan) {
  ClrayPass k{};
  k.unit_scale = std::ldexp(1.0, plan.request.without_rays() ? kExactUnitBits : CLRAY_UNIT_BITS);
  for (int i = 0; i < 3; ++i) k.reference[i] = scene.reference_point[i];
  k.inv_lever_per_m = 1.0 / plan.scales.lever_m;
  k.key0 = static_cast<std::uint32_t>(scene.trace.seed);
  k.key1 = static_cast<std::uint32_t>(scene.trace.seed >> 32);
  k.replicates = plan.request.replicates;
  k.views = static_cast<std::uint32_t>(plan.beams.views.size());
  k.max_bounces = static_cast<std::uint32_t>(plan.traits.max_bounces);
  k.materials = plan.materials.columns;
  k.width = plan.request.picture.width;
  k.height = plan.request.picture.height;
  k.finest = finest_of(geometry);
  k.unsolved_words = plan.unsolved.words;
  return k;
}

std::vector<double> settings_of(const Scene& scene, const Geometry& geometry, const PassPlan& plan, const TableRow& row,
                                int index) {
  const auto settings = room_of(row.id).settings;
  if (row.inner && settings == nullptr) return {};
  const DetectorSpec plain{row.name, row.name, {}};
  const DetectorSpec& spec = index < 0 ? plain : scene.detectors[static_cast<std::size_t>(index)];
  return settings != nullptr ? settings({scene, spec, plan, geometry}) : row_values(row, spec.parameters);
}

/// The detectors of a pass, in the order of detector.def: those that were asked for, and the inner ones that they read.
/// The generic program also has every detector that follows light.
std::vector<PassDetector> detectors_of(const Scene& scene, const Geometry& geometry, const PassPlan& plan) {
  const bool all = !scene.trace.specialise && !plan.request.without_rays(), pixels = plan.request.pixels;
  std::vector<PassDetector> detectors;
  for (std::size_t r = 0; r < table("detector").size(); ++r) {
    const TableRow& row = table("detector")[r];
    if (!(pixels ? row.pixel : row.beam) || row.mirrors != plan.request.mirrors) continue;
    std::vector<int> indices;
    for (const int d : plan.request.detectors) {
      if (scene.detectors[static_cast<std::size_t>(d)].kind == row.name && !row.inner) indices.push_back(d);
    }
    const bool needed = row.inner && ((row.connects && plan.traits.connect) || (row.scatters && plan.traits.scatter));
    const bool extra = all && row.scatters && (row.inner ? !needed : indices.empty() && !pixels);
    if (needed || extra) indices.push_back(-1);
    for (const int index : indices) {
      PassDetector detector;
      detector.row = static_cast<int>(r);
      detector.index = index;
      detector.asked = !extra;
      detector.settings = settings_of(scene, geometry, plan, row, index);
      detectors.push_back(detector);
    }
  }
  return detectors;
}

/// Lays out the sums of *detectors and notes the blocks of each.
SumLayout layout_of(const PassPlan& plan, std::vector<PassDetector>* detectors) {
  SumLayout layout;
  layout.shape = {plan.beams.views.size(), plan.request.lanes.size(), plan.traits.connections, plan.request.replicates};
  for (PassDetector& detector : *detectors) {
    const TableRow& row = table("detector")[static_cast<std::size_t>(detector.row)];
    const auto value_of = [&](const std::string& name) -> double {
      if (name == "components") return plan.traits.components;
      if (name == "width") return plan.request.picture.width;
      if (name == "height") return plan.request.picture.height;
      for (std::size_t k = 0; k < row.keys.size(); ++k) {
        if (row.keys[k].name == name) return detector.settings.at(k);
      }
      throw Error(ErrorCode::bug, "a sum's width names '" + name + "', which is no key", "detector.def: " + row.id);
    };
    detector.first_block = static_cast<std::uint32_t>(layout.blocks.size());
    for (const TableSum& sum : row.sums) layout.add(sum, static_cast<std::uint32_t>(sum_width(sum, value_of)));
    detector.last_block = static_cast<std::uint32_t>(layout.blocks.size());
  }
  return layout;
}

/// What of the views of an exact pass curved shapes reflect, or may hide from the source or an observer elsewhere.
UnsolvedPrimitives unsolved_of(const PassPlan& plan, const Geometry& geometry) {
  UnsolvedPrimitives unsolved;
  if (all_polygons(geometry)) return unsolved;
  for (std::size_t v = 0; v < plan.beams.views.size(); ++v) {
    std::vector<vec3> directions{v3_load(plan.beams.views[v].toward)};
    for (std::size_t c = 0; c < plan.traits.connections && plan.traits.connect; ++c) {
      const ClrayConnection& to = plan.beams.connections[v * plan.traits.connections + c];
      if (to.shadow != 0) directions.push_back(v3_load(to.direction));
    }
    add_unsolved(geometry, plan.motions[v], directions, &unsolved);
  }
  return unsolved;
}

/// The exact pass of a request's first bounce, for those of its detectors that have one.
PassRequest first_bounce_of(PassRequest request) {
  request.detectors = std::exchange(request.first_exact, {});
  request.how = PassMethod::exact;
  request.one_bounce = true;
  request.replicates = 1;
  request.phase = "exact";
  return request;
}

/// Which block of `first` adds to each block of a plan.
std::vector<int> added_blocks(const PassPlan& plan, const PassPlan& first) {
  std::vector<int> blocks(plan.layout.blocks.size(), -1);
  for (const PassDetector& d : plan.detectors) {
    for (const PassDetector& f : first.detectors) {
      if (f.row != d.row || f.index != d.index) continue;
      for (std::uint32_t b = d.first_block; b < d.last_block; ++b)
        blocks[b] = static_cast<int>(f.first_block + (b - d.first_block));
    }
  }
  return blocks;
}

std::optional<PathBins> path_bins_of(const std::vector<PassDetector>& detectors) {
  for (const PassDetector& detector : detectors) {
    const auto bins = room_of(detector).path_bins;
    if (bins != nullptr) return bins(detector.settings);
  }
  return std::nullopt;
}

}  // namespace

bool first_is_exact(const Scene& scene, const PassRequest& request, bool connects) {
  return std::any_of(request.first_exact.begin(), request.first_exact.end(), [&](int d) {
    return table_row("detector", scene.detectors[static_cast<std::size_t>(d)].kind).connects == connects;
  });
}

const PassDetector* find_detector(const PassPlan& plan, const std::string& id) {
  for (const PassDetector& detector : plan.detectors) {
    if (table("detector")[static_cast<std::size_t>(detector.row)].id == id) return &detector;
  }
  return nullptr;
}

double detector_value(const DetectorSpec& spec, const std::string& key) {
  const TableRow& row = table_row("detector", spec.kind);
  const std::vector<double> values = row_values(row, spec.parameters);
  for (std::size_t k = 0; k < row.keys.size(); ++k) {
    if (row.keys[k].name == key) return values[k];
  }
  throw Error(ErrorCode::bug, "detector " + spec.kind + " has no key " + key);
}

std::string member_of(const Scene& scene, const DetectorSpec& spec) {
  return "detectors[" + std::to_string(&spec - scene.detectors.data()) + "]";
}

PassPlan plan_pass(const Scene& scene, const Geometry& geometry, PassRequest request, bool reflectances) {
  PassPlan plan;
  plan.request = std::move(request);
  plan.materials = material_table(scene, plan.request.lanes);
  plan.traits = traits_of(scene, plan.request, plan.materials);
  if (reflectances && (plan.traits.scatter || !scene.trace.specialise))
    plan.materials = material_table(scene, plan.request.lanes, true);
  plan.beams = build_beams(scene, geometry, plan.request);
  plan.paths = path_ranges(scene, geometry, plan.request, plan.beams);
  plan.scales = scales_of(scene, geometry, plan);
  set_scales(plan.scales, &plan.beams.views);
  plan.detectors = detectors_of(scene, geometry, plan);
  plan.layout = layout_of(plan, &plan.detectors);
  if (plan.request.without_rays()) {
    for (const Orientation& view : plan.request.orientations) plan.motions.push_back(motions_of(scene, geometry, view));
    plan.unsolved = unsolved_of(plan, geometry);
  } else {
    if (!plan.request.first_exact.empty()) {
      plan.first = std::make_shared<FirstBounce>();
      plan.first->plan = plan_pass(scene, geometry, first_bounce_of(plan.request), reflectances);
      plan.first->blocks = added_blocks(plan, plan.first->plan);
      plan.unsolved = plan.first->plan.unsolved;
    }
    // Where the first bounce is solved, rays serve later ones, whose delays strata do not foresee.
    const bool later = first_is_exact(scene, plan.request, true) && plan.traits.max_bounces > 1;
    const auto by = !plan.traits.connect ? Steering::By::area : later ? Steering::By::exchange : Steering::By::direct;
    Steering steering{plan.materials, plan.request.lanes.size(), by, plan.paths,
                      later ? std::nullopt : path_bins_of(plan.detectors)};
    if (!plan.unsolved.bits.empty())
      steering.counts = [&](std::size_t view, std::uint32_t p) { return plan.unsolved.has(view, p); };
    plan.beams = stratified(std::move(plan.beams), scene, geometry, plan.request, steering);
  }
  plan.constants = constants_of(scene, geometry, plan);
  plan.program = specialise(scene, geometry, plan);
  return plan;
}

std::vector<PassPlan> plan_passes(const Scene& scene, const Geometry& geometry) {
  return plan_passes(scene, geometry, pass_requests(scene, geometry));
}

std::vector<PassPlan> plan_passes(const Scene& scene, const Geometry& geometry, std::vector<PassRequest> requests) {
  std::vector<PassPlan> plans;
  for (PassRequest& request : requests) plans.push_back(plan_pass(scene, geometry, std::move(request)));
  return plans;
}

}  // namespace clray
