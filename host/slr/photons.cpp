// SPDX-License-Identifier: Apache-2.0
// Expected photon rates of a run's pulses, each at the range of its own time and of its own observer; and the link
// budget of a run without a session.
#include <fmt/format.h>

#include <cmath>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "clray/write.hpp"
#include "ephemeris/range.hpp"
#include "pass/instants.hpp"
#include "slr/link.hpp"
#include "slr/pulse.hpp"
#include "slr/session.hpp"

namespace clray::slr {

namespace {

/// The ranges of a record, at the time of its orientation: from the station to the body, and from there to the
/// observer, who has a range of his own unless he is at the station. Those of a pass are its views' own.
Ranges ranges_of(const Result& result, const Scene& scene, const RangeModel& model, const ResultKey& key) {
  const Orientation* view =
      key.orientation < result.orientations.size() ? &result.orientations[key.orientation] : nullptr;
  const Instant time = instant_of(view ? view->time_s : 0.0);
  const bool own = scene.pass && view && view->source_range_m > 0.0;
  Ranges ranges{own ? view->source_range_m : model.range_m(time), 0.0};
  ranges.back_m = ranges.out_m;
  for (std::size_t i = 0; i < scene.observers.size(); ++i) {
    const Observer& o = scene.observers[i];
    if ((key.observer.empty() || o.name == key.observer) && !at_source(o, scene.source)) {
      ranges.back_m = own && i < view->ranges_m.size() && view->ranges_m[i] > 0.0 ? view->ranges_m[i]
                                                                                  : observer_range_m(o, &model, time);
    }
  }
  return ranges;
}

std::vector<double> rates_of(const DelayResult& delay, const Station& station, double photons_per_m2) {
  const double photons = 4.0 * constants::kPi * photons_per_m2;
  const Histogram bins{delay.first_bin_start_s, delay.bin_width_s, delay.bin_m2_per_sr};
  const Histogram smeared = smear(bins, station);
  // Its bins are finer by `cuts`, or each holds `merged` of ours.
  const long cuts = std::max(1l, std::lround(delay.bin_width_s / smeared.width_s));
  const long merged = std::max(1l, std::lround(smeared.width_s / delay.bin_width_s));
  const long shift = std::lround((delay.first_bin_start_s - smeared.first_s) / delay.bin_width_s);
  const double per_ns = photons / (delay.bin_width_s * 1e9 * static_cast<double>(merged));
  std::vector<double> rates(bins.mass.size(), 0.0);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    for (long cut = 0; cut < cuts; ++cut) {
      const long place = static_cast<long>(i) + shift;
      const long from = place >= 0 ? (place / merged) * cuts + cut : -1;
      if (from >= 0 && from < static_cast<long>(smeared.mass.size()))
        rates[i] += smeared.mass[static_cast<std::size_t>(from)];
    }
    rates[i] *= per_ns;
  }
  return rates;
}

}  // namespace

}  // namespace clray::slr

namespace clray {

std::vector<double> photons_per_ns(const DelayResult& delay, const Station& station, double range_m,
                                   double wavelength_nm) {
  if (!(delay.bin_width_s > 0.0) || !std::isfinite(delay.bin_width_s) || !std::isfinite(delay.first_bin_start_s)) {
    throw Error(ErrorCode::usage, "expected bins of finite place and positive width", "delay");
  }
  return slr::rates_of(delay, station, slr::link_budget(station, wavelength_nm, range_m).photons_per_m2);
}

void expect_photons(const Scene& scene, Result* result) {
  if (result == nullptr) throw Error(ErrorCode::usage, "expected a result, found none", "result");
  check_scene(scene);
  check_result(*result, scene);
  if (!scene.station || scene.source.kind != Source::Kind::laser) return;
  const slr::RangeModel model = pass::range_model(scene);
  for (DelayResult& delay : result->delay) {
    const slr::Ranges ranges = slr::ranges_of(*result, scene, model, delay.key);
    const slr::LinkBudget link = slr::link_budget(*scene.station, scene.source.wavelength_nm, ranges);
    delay.photons_per_ns = slr::rates_of(delay, *scene.station, link.photons_per_m2);
  }
}

std::string link_budget_text(const Scene& scene, const Result& result) {
  check_scene(scene);
  check_result(result, scene);
  if (!scene.station || scene.source.kind != Source::Kind::laser || result.delay.empty()) return {};
  const DelayResult& delay = result.delay.front();
  const slr::RangeModel model = pass::range_model(scene);
  std::string text;
  if (result.delay.size() > 1) {
    text = "Link budget of " + delay.key.detector;
    for (const std::string& name : {delay.key.observer, delay.key.variant}) text += name.empty() ? "" : ", " + name;
    text += fmt::format(", orientation {}:\n", delay.key.orientation);
  }
  return text + slr::link_text(slr::link_rows(*scene.station, scene.source.wavelength_nm,
                                              4.0 * constants::kPi * delay.intensity_m2_per_sr.value,
                                              slr::ranges_of(result, scene, model, delay.key)));
}

}  // namespace clray
