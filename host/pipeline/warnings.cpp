// SPDX-License-Identifier: Apache-2.0
// See warnings.hpp.
#include "pipeline/warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "body/geometry.hpp"
#include "pipeline/detector/intensity.hpp"
#include "pipeline/estimate.hpp"
#include "scene/tables.hpp"
#include "text/text.hpp"

namespace clray {

namespace {

std::string reason(const Scene& scene, const std::string& by) {
  if (by == "rays") return "these are the rays given";
  if (by == "max_rays") return fmt::format("more than max_rays = {} are not allowed", scene.trace.max_rays);
  if (by == "samples") return "a picture's search ends there: give it samples or rays";
  if (by == "time limit") return fmt::format("stopped by the time limit of {:g} s", scene.trace.time_limit_s);
  return "interrupted";
}

std::string missed_target(const Scene& scene, const Ending& ending, bool partial) {
  const double target = scene.trace.target_error_percent, reached = 100.0 * ending.half_width;
  const std::string asked = fmt::format("the target error of {:g} %", target);
  const std::string why = reason(scene, ending.by);
  if (ending.rays == 0) return fmt::format("{} was not reached: {}", asked, why);
  if (std::isnan(reached)) return fmt::format("{} is n/a: all totals are zero after {} rays", asked, ending.rays);
  if (reached <= target && partial)
    return fmt::format("{} was met ({:.3g} % after {} rays) by what is finished; other parts are missing: {}", asked,
                       reached, ending.rays, why);
  if (reached <= target)
    return fmt::format("{} was met ({:.3g} % after {} rays) but not confirmed on fresh rays: {}", asked, reached,
                       ending.rays, why);
  return fmt::format("{} was not reached: {:.3g} % (95 % half-width over the value) after {} rays; {}", asked, reached,
                     ending.rays, why);
}

constexpr double kTimesNormal = 4.0;   // over that of normal replicates; 1 in 2000 sets of 16 normal ones exceeds it
constexpr double kLeastError = 1e-6;   // relative; a smaller spread is that of fixed-point rounding
constexpr double kUnseenShare = 0.10;  // of a total

/// Whether the body has normals that no ray may have met: true of curved shapes, and of any face so small that few rays
/// came to it, in a fine mesh or alone. A flat face has one normal, which its first ray meets. `rays`: for each m² of
/// the beam.
bool may_be_unmet(const Geometry& geometry, double rays_per_m2) {
  constexpr double kRaysPerFacet = 100.0;
  const std::vector<TableRow>& shapes = table("shape");
  for (const int row : geometry.shape_rows) {
    if (!shapes[static_cast<std::size_t>(row)].flat) return true;
  }
  return std::any_of(geometry.primitives.begin(), geometry.primitives.end(), [&](const ClrayPrimitive& p) {
    return rays_per_m2 * primitive_area(geometry, p) < kRaysPerFacet;
  });
}

/// The largest share of a total that could be missing because no ray met it; 0 where the claimed error covers it.
double unseen_share(const PassPlan& plan, const Sums& sums) {
  const SumReader read(plan, sums);
  const double t95 = student_t95(static_cast<int>(plan.request.replicates) - 1);
  double largest = 0.0;
  for (std::size_t v = 0; v < plan.beams.views.size(); ++v) {
    for (std::size_t c = 0; c < plan.traits.connections; ++c) {
      for (std::size_t l = 0; l < plan.request.lanes.size(); ++l) {
        const Estimate a = estimate_mean(intensities(plan, read, v, l, c));
        if (!(a.value > 0.0)) continue;
        const double share = poisson_upper95(0) * most_intensity(plan, v, l, c) / rays_of(read, v) /
                             static_cast<double>(plan.request.replicates) / a.value;
        if (share > 2.0 * t95 * a.standard_error / a.value) largest = std::max(largest, share);
      }
    }
  }
  return largest;
}

}  // namespace

std::vector<std::string> doubtful_claims(const PassPlan& plan, const Geometry& geometry, const Sums& sums) {
  std::vector<std::string> warnings;
  if (plan.request.paints() || plan.request.without_rays()) return warnings;
  const std::uint64_t fewest = *std::min_element(sums.points.begin(), sums.points.end());
  const double rays = static_cast<double>(fewest) * plan.request.replicates;
  // Beside a solved first bounce rays find later ones, whose peaks are wide, and first hits of what is not solved. What
  // connects to no observer has no intensity.
  const auto solved = [&] {
    return plan.unsolved.bits.empty() && SumReader(plan, sums).adds_to(find_detector(plan, "intensity")->first_block);
  };
  const bool sampled = plan.traits.connect && !solved();
  const double beam_m2 = *std::max_element(plan.beams.area_m2.begin(), plan.beams.area_m2.end());
  const double share = sampled && may_be_unmet(geometry, rays / beam_m2) ? unseen_share(plan, sums) : 0.0;
  if (share > kUnseenShare) {
    warnings.push_back(
        fmt::format("these surfaces can return a peak that the rays may have missed, with up to {:.2g} times a total: "
                    "the claimed error knows nothing of it; {:.1g} rays would rule out {:g} %",
                    share, rays * share / kUnseenShare, 100.0 * kUnseenShare));
  }
  return warnings;
}

namespace {

/// What no picture shows: light that comes by a mirror, and by a mirror leaves.
void warn_unseen(Result* result) {
  std::vector<std::string> known;
  for (const ImageResult& i : result->image) {
    const std::string name = record_label(i.key);
    if (!(i.unseen_caustics_m2 > 0.0) || std::find(known.begin(), known.end(), name) != known.end()) continue;
    known.push_back(name);
    result->warnings.push_back(
        fmt::format("light that mirrors throw on surfaces, which mirrors show, is not in the picture: {:.4g} m² of it "
                    "leave in all directions ({}); give the observer acceptance_mrad",
                    i.unseen_caustics_m2, name));
  }
}

/// A record's name with its orientation, where there are several, and how many others share its fault.
std::string record_place(const Result& result, const ResultKey& key, const char* fallback, std::size_t count) {
  std::string where = record_label(key, fallback);
  if (result.orientations.size() > 1) where += fmt::format(", orientation {}", key.orientation);
  if (count > 1) where += fmt::format("; {} in all", text::counted(count, "record"));
  return where;
}

/// Totals whose claimed errors rest on few replicates.
void warn_few_replicates(Result* result) {
  const double normal = normal_variance_of_variance(result->replicates);
  const ResultKey* worst = nullptr;
  double most = 0.0;
  std::size_t count = 0;
  const auto look = [&](const ResultKey& key, std::initializer_list<Estimate> numbers, double scale) {
    double largest = 0.0;
    for (const Estimate& e : numbers) {
      if (e.standard_error > kLeastError * scale) largest = std::max(largest, e.relative_variance_of_variance);
    }
    if (!(largest > kTimesNormal * normal)) return;
    ++count;
    if (largest <= most) return;
    most = largest;
    worst = &key;
  };
  const auto axis = [](const VectorEstimate& v, int k, double lever) {
    return Estimate{v.value[k] / lever, v.standard_error[k] / lever, 0.0, 0.0, v.relative_variance_of_variance[k]};
  };
  for (const DelayResult& d : result->delay) look(d.key, {d.intensity_m2_per_sr}, d.intensity_m2_per_sr.value);
  for (const SpectrometerResult& s : result->spectrometer)
    look(s.key, {s.intensity_m2_per_sr}, s.intensity_m2_per_sr.value);
  for (const PressureResult& p : result->pressure) {
    const VectorEstimate &c = p.coefficient_m2, &m = p.torque_coefficient_m3;
    const double size = std::sqrt(c.value.x * c.value.x + c.value.y * c.value.y + c.value.z * c.value.z);
    const double lever = 0.5 * result->extent_m;
    look(p.key,
         {axis(c, 0, 1.0), axis(c, 1, 1.0), axis(c, 2, 1.0), axis(m, 0, lever), axis(m, 1, lever), axis(m, 2, lever)},
         size);
  }
  for (const TableResult& table : result->table) {
    for (const Estimate& e : table.values) look(table.key, {e}, std::fabs(e.value));
  }
  if (worst == nullptr) return;
  result->warnings.push_back(
      fmt::format("a claimed error rests on few of the {} replicates ({}; relative variance of the variance {:.2g}, "
                  "normal is {:.2g}): do not trust it; trace more rays",
                  result->replicates, record_place(*result, *worst, "total", count), most, normal));
}

/// Light outside the window of a delay record.
void warn_outside_window(Result* result) {
  const DelayResult* worst = nullptr;
  double most = 0.01;
  std::size_t count = 0;
  for (const DelayResult& d : result->delay) {
    const double share = (d.below_m2_per_sr + d.above_m2_per_sr) / d.intensity_m2_per_sr.value;
    if (!(share > 0.01)) continue;
    ++count;
    if (!(share > most)) continue;
    most = share;
    worst = &d;
  }
  if (worst == nullptr) return;
  const std::string where = record_place(*result, worst->key, "delay", count);
  result->warnings.push_back(
      fmt::format("{} of the light lies outside the delay window ({}): give start_ns and stop_ns",
                  most > 0.995 ? "all" : fmt::format("{:.2g}", most), where));
}

}  // namespace

void add_warnings(const Scene& scene, const Ending& ending, const LitRecords& lit, Result* result) {
  result->warnings = scene.warnings;
  for (const std::string& warning : lit.warnings(result->rays > 0)) result->warnings.push_back(warning);
  for (const EnergyBooks& books : result->energy) {
    if (books.unconnected_specular_m2.value > 0.0)
      result->warnings.push_back(
          fmt::format("mirrors reflect {:.4g} m² that no observer collects ({}): give the observer acceptance_mrad",
                      books.unconnected_specular_m2.value, record_label(books.key, "every detector")));
    if (books.incident_m2.value > 0.0 && books.truncated_m2.value > 0.01 * books.incident_m2.value)
      result->warnings.push_back(fmt::format("{:.2g} of the incident energy was cut off at max_bounces = {} ({})",
                                             books.truncated_m2.value / books.incident_m2.value,
                                             scene.trace.max_bounces, record_label(books.key, "every detector")));
  }
  warn_outside_window(result);
  warn_few_replicates(result);
  warn_unseen(result);
  if (result->target_asked && !result->target_reached)
    result->warnings.push_back(missed_target(scene, ending, result->partial));
}

}  // namespace clray
