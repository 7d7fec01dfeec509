// SPDX-License-Identifier: Apache-2.0
// Energy books on the host: the mean over the views, per variant and band (docs/physics.md, section 4).
#include "pipeline/detector/books.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "body/portable_tables.hpp"
#include "pipeline/detector/room.hpp"
#include "pipeline/detector/rooms.hpp"
#include "pipeline/estimate.hpp"

namespace clray {
namespace {

EnergyBooks books_of(const RoomResults& x, const LaneRecord& record) {
  EnergyBooks e;
  e.key.variant = x.plan.request.lanes[record.first].variant;
  e.key.band = x.plan.request.lanes[record.first].band_name;
  if (x.plan.request.apart) {
    e.key.detector = shown_name(x.scene.detectors[static_cast<std::size_t>(x.plan.request.detectors.front())]);
  }
  Estimate* entries[CLRAY_BOOKS] = {&e.incident_m2, &e.reflected_m2, &e.absorbed_m2,
                                    &e.roulette_m2, &e.truncated_m2, &e.unconnected_specular_m2};
  const std::size_t views = x.plan.layout.shape.views;
  double rays = rays_of(x.read, 0), beam_m2 = 0.0;
  for (std::size_t v = 0; v < views; ++v) {
    rays = std::min(rays, rays_of(x.read, v));
    beam_m2 += x.plan.beams.area_m2[v] / static_cast<double>(views);
  }
  bool met_body = false;
  for (int which = 0; which < CLRAY_BOOKS; ++which) {
    std::vector<double> mean(x.plan.request.replicates, 0.0);
    for (std::size_t v = 0; v < views; ++v) {
      const std::vector<double> one = book(x.plan, x.read, v, record, which);
      for (std::size_t r = 0; r < mean.size(); ++r) mean[r] += one[r];
    }
    for (double& m : mean) m /= static_cast<double>(views);
    // Where no ray met the body, one may have missed what takes or sends on all of it.
    if (which == CLRAY_BOOK_INCIDENT)
      met_body = std::any_of(mean.begin(), mean.end(), [](double m) { return m != 0.0; });
    *entries[which] = estimate_total(mean, rays, 0.0, met_body || which > CLRAY_BOOK_ABSORBED ? 0.0 : beam_m2);
  }
  // Reflected light is not followed, so that it is not known what hits the body again. Several bounces are solved
  // where nothing can.
  if (x.plan.request.exact() && x.plan.traits.max_bounces == 1)
    e.truncated_m2.value = std::numeric_limits<double>::quiet_NaN();
  return e;
}

/// What a view's faces receive, absorb and send on. Where the last goes is not followed: it is all in `reflected`.
void books_solved(const SolvedContext& x, Sums* sums) {
  if (!x.solved.from_source) return;
  const SumShape& shape = x.plan.layout.shape;
  const SumBlock& block = x.plan.layout.blocks[x.detector.first_block];
  const double scale = x.plan.constants.unit_scale / x.plan.beams.area_m2[x.solved.view];
  for (std::size_t l = 0; l < shape.lanes; ++l) {
    const std::uint64_t row = block.offset + (x.solved.view * shape.lanes + l) * block.width;
    for (std::size_t f = 0; f < x.solved.beam.faces.size(); ++f) {
      const FaceOrigin& origin = x.solved.beam.origins[f];
      const ClrayMaterial& m = x.plan.materials.of(l, origin.material);
      const Sum received = std::llrint(x.solved.visible[f].area_m2 * scale);
      const double reflectance = origin.lit ? surface_reflectance(m, x.plan.materials.tables, origin.mu) : 0.0;
      const Sum sent = std::llrint(x.solved.visible[f].area_m2 * reflectance * scale);
      sums->values.add(row + CLRAY_BOOK_INCIDENT, received);
      sums->values.add(row + CLRAY_BOOK_REFLECTED, sent);
      sums->values.add(row + CLRAY_BOOK_ABSORBED, received - sent);
    }
  }
}

/// Detectors whose numbers come about in different ways have passes of their own, and each keeps books of the same
/// light. One set is enough: that which knows all, or else the first.
bool has_known_twin(const RoomResults& x, const LaneRecord& record, const EnergyBooks& e) {
  if (x.plan.request.lanes[record.first].share < 1.0) return false;
  for (EnergyBooks& twin : x.out.energy) {
    if (!same_record(twin.key, e.key)) continue;
    if (std::isnan(twin.truncated_m2.value)) twin = e;
    return true;
  }
  return false;
}

void books_results(const RoomResults& x) {
  if (x.plan.request.pixels) return;  // rays from pixels carry no light
  for (const LaneRecord& record : lane_records(x.plan.request.lanes)) {
    EnergyBooks e = books_of(x, record);
    if (e.incident_m2.value > 0.0) {
      double& fraction = x.out.diagnostics.truncated_energy_fraction;
      fraction = std::max(fraction, e.truncated_m2.value / e.incident_m2.value);
    }
    EnergyBooks* known = x.known(x.out.energy, e.key, record);
    if (known == nullptr && has_known_twin(x, record, e)) continue;
    if (known == nullptr) {
      x.out.energy.push_back(std::move(e));
      continue;
    }
    const std::array<Estimate EnergyBooks::*, CLRAY_BOOKS> entries{
        {&EnergyBooks::incident_m2, &EnergyBooks::reflected_m2, &EnergyBooks::absorbed_m2, &EnergyBooks::roulette_m2,
         &EnergyBooks::truncated_m2, &EnergyBooks::unconnected_specular_m2}};
    for (const auto entry : entries) known->*entry = sum_of_parts(known->*entry, e.*entry);
  }
}

// The books have no total that a target could be about.
void no_targets(const TargetContext&, std::vector<Target>*) {}

}  // namespace

const DetectorRoom kBooksRoom{"books", nullptr, nullptr, no_targets, books_results, nullptr, books_solved, nullptr};

}  // namespace clray
