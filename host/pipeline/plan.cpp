// SPDX-License-Identifier: Apache-2.0
// Planning a scene's passes: views and windows, the layout of the sums, and the specialisation map. Body frame, metres.
#include "pipeline/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "pipeline/beam_strata.hpp"
#include "pipeline/views.hpp"
#include "scene/tables.hpp"

namespace clray {

double detector_value(const DetectorSpec& spec, const std::string& key) {
  const TableRow& row = table("detector")[table_index("detector", spec.kind)];
  const std::vector<double> values = row_values(row, spec.parameters);
  for (std::size_t k = 0; k < row.keys.size(); ++k) {
    if (row.keys[k].name == key) return values[k];
  }
  throw Error(ErrorCode::bug, "detector " + spec.kind + " has no key " + key);
}

namespace {

constexpr double kNsToMetres = 0.299792458;

/// Planning one pass, step by step.
class Planner {
 public:
  Planner(const Scene& scene, const Geometry& geometry, PassPlan plan)
      : scene_(scene), geometry_(geometry), p_(std::move(plan)) {}

  PassPlan finish() {
    p_.max_bounces = scene_.trace.max_bounces;
    p_.components = static_cast<std::uint32_t>(scene_.components.size());
    p_.surfaces = build_surfaces(scene_, p_.lanes, false, false);
    p_.scatter = p_.max_bounces > 1 || p_.pressure || (p_.surfaces.delta && p_.connect);
    if (p_.scatter || !scene_.trace.specialise) p_.surfaces = build_surfaces(scene_, p_.lanes, true, p_.thermal);
    build_views(scene_, geometry_, &p_);
    windows();
    stratify_beams(scene_, geometry_, &p_);
    scales();
    layout();
    specialise();
    return std::move(p_);
  }

 private:
  // Path lengths that one bounce can have, over all views; and each detector's window.
  void windows() {
    std::vector<double> low(p_.connections, 1e300), high(p_.connections, -1e300);
    for (std::size_t v = 0; v < p_.views.size(); ++v) {
      for (std::uint32_t c = 0; c < p_.connections; ++c) {
        double a, b;
        path_extent(scene_, geometry_, p_, v, c, &a, &b);
        low[c] = std::min(low[c], a);
        high[c] = std::max(high[c], b);
      }
    }
    p_.path_low_m = *std::min_element(low.begin(), low.end());
    p_.path_high_m = *std::max_element(high.begin(), high.end());
    const double least = std::ldexp(2.0 * geometry_.radius, -10);
    for (std::size_t d = 0; d < scene_.detectors.size() && !p_.pixels && !p_.grid; ++d) {
      const DetectorSpec& spec = scene_.detectors[d];
      if (spec.kind != "delay") continue;
      DelayPlan delay;
      delay.detector = static_cast<int>(d);
      delay.bins = static_cast<std::uint32_t>(detector_value(spec, "bins"));
      const double start_ns = detector_value(spec, "start_ns"), stop_ns = detector_value(spec, "stop_ns");
      const double bin_ps = detector_value(spec, "bin_ps");
      for (std::uint32_t c = 0; c < p_.connections; ++c) {
        const double extent = high[c] - low[c];
        const double margin = std::max(extent / std::max(1.0, delay.bins - 2.0), least);
        double first = std::isnan(start_ns) ? low[c] - margin : start_ns * kNsToMetres;
        double last = std::isnan(stop_ns) ? high[c] + margin : stop_ns * kNsToMetres;
        if (!(last > first))
          throw Error(ErrorCode::input,
                      fmt::format("the delay window is empty: it starts at {} ns and stops at {} ns",
                                  first / kNsToMetres, last / kNsToMetres),
                      "detector " + spec.name);
        double bin = (last - first) / delay.bins;
        if (!std::isnan(bin_ps)) {
          bin = bin_ps * 1e-3 * kNsToMetres;
          const double bins = std::ceil((last - first) / bin);
          if (!(bins <= 1e7))
            throw Error(ErrorCode::input,
                        fmt::format("bin_ps = {} makes {:.3g} bins, at most 1e7 expected", bin_ps, bins),
                        "detector " + spec.name);
          delay.bins = std::max(c == 0 ? 1u : delay.bins, static_cast<std::uint32_t>(bins));
        }
        delay.first_m.push_back(first);
        delay.bin_m.push_back(bin);
      }
      p_.delays.push_back(delay);
    }
  }

  // The fixed-point scale: from the bound of first-bounce weights, so from the scene alone (DESIGN, kernels).
  void scales() {
    double bound = 0.0;
    for (std::size_t v = 0; v < p_.views.size(); ++v) {
      const double* s = p_.views[v].toward;
      for (std::uint32_t c = 0; c < p_.connections; ++c) {
        const double* o = p_.connection_rows[v * p_.connections + c].direction;
        const double x = s[0] + o[0], y = s[1] + o[1], z = s[2] + o[2];
        const double cos_half = 0.5 * std::sqrt(std::fma(x, x, std::fma(y, y, z * z)));
        bound = std::max(bound, weight_bound(p_.surfaces, std::max(cos_half, 1e-6)));
      }
    }
    int exponent = 0;
    if (bound > 0.0) std::frexp(bound * (1.0 + 0x1p-20), &exponent);
    p_.scale_bits = 62 - 24 - exponent;
    ClrayPass& k = p_.constants;
    k.weight_scale = std::ldexp(1.0, p_.scale_bits);
    k.weight_limit = std::ldexp(1.0, exponent);
    k.unit_scale = std::ldexp(1.0, CLRAY_UNIT_BITS);
    const double half = std::max(0.5 * (p_.path_high_m - p_.path_low_m), std::ldexp(geometry_.radius, -10));
    k.path_middle_m = 0.5 * p_.path_low_m + 0.5 * p_.path_high_m;
    k.inv_path_per_m = 1.0 / (half * (1.0 + 0x1p-20));
    const Vec3& r = scene_.reference_point;
    double lever = 0.0;
    for (int i = 0; i < 3; ++i) {
      k.reference[i] = r[i];
      lever += std::fabs(geometry_.centre[i] - r[i]);
    }
    p_.lever_m = std::ldexp(1.0, std::ilogb(std::max(lever + geometry_.radius, 1e-300)) + 1);
    k.inv_lever_per_m = 1.0 / p_.lever_m;
  }

  void layout() {
    ClrayPass& k = p_.constants;
    const std::uint64_t slots = static_cast<std::uint64_t>(p_.views.size()) * p_.lanes.size() * p_.connections;
    const std::uint64_t rows = slots * p_.replicates;
    const std::uint64_t view_rows = static_cast<std::uint64_t>(p_.views.size()) * p_.lanes.size() * p_.replicates;
    const bool all = !scene_.trace.specialise;
    p_.totals_size = p_.connect && !p_.pixels ? 3 * rows : 0;
    p_.pressure_size = p_.pressure || all ? view_rows * p_.components * 6 : 0;
    p_.books_size = p_.scatter || all ? view_rows * CLRAY_BOOKS : 0;
    p_.pixels_size = p_.pixels ? view_rows * p_.width * p_.height : 0;
    k.totals = 0;
    k.pressure = p_.totals_size;
    k.books = k.pressure + p_.pressure_size;
    k.pixels = k.books + p_.books_size;
    p_.sums_size = k.pixels + p_.pixels_size;
    p_.hits_size = p_.pixels ? static_cast<std::uint64_t>(p_.views.size()) * p_.width * p_.height : 0;
    for (DelayPlan& delay : p_.delays) {
      delay.sums = p_.sums_size;
      delay.hits = p_.hits_size;
      p_.sums_size += rows * (delay.bins + 2ull);
      p_.hits_size += rows * (delay.bins + 3ull);
      for (std::uint32_t c = 0; c < p_.connections; ++c) {
        ClrayDelay row{};
        row.first_m = delay.first_m[c];
        row.inv_bin_per_m = 1.0 / delay.bin_m[c];
        row.bins = delay.bins;
        row.sums = delay.sums;
        row.hits = delay.hits;
        p_.delay_rows.push_back(row);
      }
    }
    k.key0 = static_cast<std::uint32_t>(scene_.trace.seed);
    k.key1 = static_cast<std::uint32_t>(scene_.trace.seed >> 32);
    k.replicates = p_.replicates;
    k.views = static_cast<std::uint32_t>(p_.views.size());
    k.width = p_.width;
    k.height = p_.height;
  }

  void decide(const char* name, bool needed, const std::string& what, const std::string& why_kept,
              const std::string& why_not) {
    const bool on = needed || !scene_.trace.specialise;
    p_.options.defines[name] = on ? "1" : "0";
    if (on) {
      p_.kept.push_back(what + ": " + (needed ? why_kept : "generic program (--no-specialise)"));
    } else {
      p_.left_out.push_back(what + ": " + why_not);
    }
  }

  void size(const char* name, std::uint64_t value) { p_.options.defines[name] = std::to_string(value); }

  void specialise();
  void specialise_tables();

  const Scene& scene_;
  const Geometry& geometry_;
  PassPlan p_;
};

void Planner::specialise_tables() {
  const bool all = !scene_.trace.specialise;
  const auto choose = [&](const char* kind, const std::vector<int>& used, std::vector<int>* out, const char* what) {
    std::string kept, left;
    const std::vector<TableRow>& rows = table(kind);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const bool on = std::find(used.begin(), used.end(), static_cast<int>(r)) != used.end();
      if (on || all) out->push_back(static_cast<int>(r));
      std::string& list = on || all ? kept : left;
      list += (list.empty() ? "" : ", ") + rows[r].name;
    }
    if (!kept.empty()) p_.kept.push_back(std::string(what) + " " + kept + ": in the scene");
    if (!left.empty()) p_.left_out.push_back(std::string(what) + " " + left + ": not in the scene");
  };
  choose("brdf", p_.surfaces.models, &p_.options.brdfs, "surface models");
  choose("shape", geometry_.shape_rows, &p_.options.shapes, "shapes");
  std::string others;
  for (std::size_t r = 0; r < table("detector").size(); ++r) {
    const TableRow& row = table("detector")[r];
    const bool asked = std::any_of(scene_.detectors.begin(), scene_.detectors.end(),
                                   [&](const DetectorSpec& d) { return d.kind == row.name; });
    if (asked && (row.side == "pixel") == p_.pixels) {
      p_.options.detectors.push_back(static_cast<int>(r));
    } else if (all && row.id == "pressure") {
      p_.options.detectors.push_back(static_cast<int>(r));
    }
    if (!asked) others += (others.empty() ? "" : ", ") + row.name;
  }
  if (!others.empty()) p_.left_out.push_back("detectors " + others + ": not asked for");
}

void Planner::specialise() {
  specialise_tables();
  const bool all = !scene_.trace.specialise;
  const int mesh_row = table_index("shape", "mesh");
  const bool triangles = std::count(geometry_.shape_rows.begin(), geometry_.shape_rows.end(), mesh_row) > 0;
  const bool analytic = geometry_.shape_rows.size() > (triangles ? 1u : 0u);
  const bool bistatic = std::any_of(p_.connection_rows.begin(), p_.connection_rows.end(),
                                    [](const ClrayConnection& c) { return c.shadow != 0; });
  const bool moving_parts = std::any_of(geometry_.parts.begin(), geometry_.parts.end(),
                                        [](const Part& part) { return part.hinged_component >= 0; });
  const bool bounded = std::all_of(p_.surfaces.models.begin(), p_.surfaces.models.end(),
                                   [](int row) { return table("brdf")[row].bounded; });
  const bool connects_again = p_.connect && p_.max_bounces > 1;
  std::string why_no_shadow = !p_.connect        ? "nothing is connected to an observer"
                              : geometry_.convex ? "the body is convex: what faces the observer is seen"
                                                 : "the observer is at the source: what is lit is seen";
  decide("CLRAY_SHADOW", p_.connect && !geometry_.convex && (bistatic || connects_again), "shadow rays",
         bistatic ? "an observer is not at the source" : "later bounces are connected", why_no_shadow);
  decide("CLRAY_SCATTER", p_.scatter, "scattered directions",
         p_.max_bounces > 1 ? "several bounces"
         : p_.pressure      ? "radiation pressure"
                            : "mirrors",
         "one bounce, connected directly");
  p_.options.defines["CLRAY_ENERGY"] = p_.options.defines["CLRAY_SCATTER"];
  decide("CLRAY_DELTA", p_.surfaces.delta, "ideal reflections", "a mirror is in the scene", "no mirror in the scene");
  decide("CLRAY_ONE_SIDED", p_.surfaces.one_sided, "black backs", "a material is one-sided",
         "every material reflects from both sides");
  decide("CLRAY_PLANES", geometry_.shared_planes, "faces in one plane",
         "some overlap: the one that faces the ray is hit", "no faces overlap in one plane");
  decide("CLRAY_INSTANCED", moving_parts, "moving parts and their transforms", "a component is hinged",
         "no component is hinged; fixed transforms are done once on the host");
  decide("CLRAY_WIDE", p_.scatter || bistatic || !bounded, "second accumulator",
         "weights may exceed the bound of a first bounce", "weights of these surfaces are bounded");
  p_.options.defines["CLRAY_STRATA"] = p_.strata.empty() ? "0" : "1";
  if (!p_.strata.empty()) {
    p_.kept.push_back("strata of the beam: the Sobol sampler, spread over the body's silhouette, delays and peaks");
    p_.left_out.push_back("rays beside the body: cells of the beam's rectangle that nothing projects into");
  }
  decide("CLRAY_TRIANGLES", triangles, "triangle test", "a mesh is in the scene", "no mesh in the scene");
  decide("CLRAY_ANALYTIC", analytic, "analytic shapes", "in the scene", "the scene is made of triangles");
  decide("CLRAY_PRESSURE", p_.pressure, "momentum and torque", "the pressure detector", "no pressure detector");
  decide("CLRAY_THERMAL", p_.thermal, "thermal re-radiation", "asked for by the pressure detector", "not asked for");
  if (p_.lanes.size() == 1) p_.left_out.push_back("wavelengths and variants: one lane, one number per material");
  p_.options.defines["CLRAY_BEAM"] = p_.pixels ? "0" : "1";
  p_.options.defines["CLRAY_PIXELS"] = p_.pixels ? "1" : "0";
  p_.options.defines["CLRAY_CONNECT"] = p_.connect ? "1" : "0";
  p_.options.defines["CLRAY_SOBOL"] = scene_.trace.sobol ? "1" : "0";
  size("CLRAY_DELAYS", p_.delays.size());
  size("CLRAY_LANES", p_.lanes.size());
  size("CLRAY_CONNECTIONS", p_.connections);
  size("CLRAY_MATERIALS", p_.surfaces.columns);
  size("CLRAY_COMPONENTS", p_.components);
  size("CLRAY_MAX_BOUNCES", static_cast<std::uint64_t>(p_.max_bounces));
  // Few sizes, so that scenes share programs.
  const std::uint32_t stack = geometry_.stack_needed + 1;
  size("CLRAY_STACK", all || stack > 96 ? 192 : stack > 48 ? 96 : stack > 24 ? 48 : 24);
}

}  // namespace

PassPlan plan_pass(const Scene& scene, const Geometry& geometry, PassPlan plan) {
  return Planner(scene, geometry, std::move(plan)).finish();
}

}  // namespace clray
