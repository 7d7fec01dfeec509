// SPDX-License-Identifier: Apache-2.0
// The link budget; see link.hpp.
#include "slr/link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "clray/keys.hpp"
#include "scene/file/keys.hpp"
#include "shared/elementary.h"
#include "text/columns.hpp"

namespace clray::slr {

namespace {

/// A key's row: its value, and what keys.def says of it.
template <class Section>
LinkRow key_row(const Section& section, const std::string& name) {
  for (const Key<Section>& k : keys<Section>()) {
    if (k.key.name == name) return {name, k.number(section), k.unit, k.fallback, k.values, k.key.meaning};
  }
  throw Error(ErrorCode::bug, "there is no such key", name);
}

/// Adds the station's other numbers to `rows`, except its epoch and what only CRD files say, on which no photon
/// depends.
void add_other_keys(const Station& station, std::vector<LinkRow>* rows) {
  for (const Key<Station>& k : keys<Station>()) {
    const bool there =
        std::any_of(rows->begin(), rows->end(), [&](const LinkRow& row) { return row.key == k.key.name; });
    const bool beside = k.key.name == "start_mjd" || k.key.meaning.rfind("CRD: ", 0) == 0;
    if (k.kind == KeyKind::number && !there && !beside) rows->push_back(key_row(station, k.key.name));
  }
}

}  // namespace

void check_station(const Station& station, double wavelength_nm) {
  Source laser;
  laser.wavelength_nm = wavelength_nm;
  check_keys("source", laser);
  check_keys("station", station);
}

LinkBudget link_budget(const Station& s, double wavelength_nm, double range_m) {
  return link_budget(s, wavelength_nm, Ranges{range_m, range_m});
}

LinkBudget link_budget(const Station& s, double wavelength_nm, const Ranges& ranges) {
  check_station(s, wavelength_nm);
  for (const double range_m : {ranges.out_m, ranges.back_m}) {
    const std::string fault = key_fault("station", "range_m", range_m);
    if (!fault.empty()) throw Error(ErrorCode::input, fmt::format("{}, found {}", fault, range_m), "station.range_m");
  }
  LinkBudget b{};
  b.eta_q = s.eta_q;
  b.eta_t = s.eta_t;
  b.eta_r = s.eta_r;
  b.T_a = s.T_a;
  b.T_c = s.T_c;
  b.photons_sent = s.pulse_energy_J * (wavelength_nm * 1e-9) / (constants::kPlanck_J_s * constants::kLightSpeed_m_s);
  const double miss = s.pointing_rad / s.divergence_rad;
  b.gain = 8.0 / (s.divergence_rad * s.divergence_rad) * el_exp(-2.0 * miss * miss);
  const auto sphere_m2 = [](double range_m) { return 4.0 * constants::kPi * range_m * range_m; };
  b.spread_per_m4 = 1.0 / (sphere_m2(ranges.out_m) * sphere_m2(ranges.back_m));
  b.receiver_area_m2 = 0.25 * constants::kPi * s.aperture_m * s.aperture_m;
  b.photons_per_m2 = b.eta_q * b.photons_sent * b.eta_t * b.gain * b.spread_per_m4 * b.receiver_area_m2 * b.eta_r *
                     (b.T_a * b.T_a) * (b.T_c * b.T_c);
  return b;
}

std::vector<LinkRow> link_rows(const Station& s, double wavelength_nm, double cross_section_m2, const Ranges& ranges) {
  const LinkBudget b = link_budget(s, wavelength_nm, ranges);
  const bool apart = ranges.back_m != ranges.out_m;
  Source laser;
  laser.wavelength_nm = wavelength_nm;
  Station there = s;
  there.range_m = ranges.out_m;
  Observer observer;
  observer.range_m = ranges.back_m;
  const auto key = [&](const char* name) { return key_row(there, name); };
  const auto factor = [](const char* name, double value, const char* unit, const char* meaning) {
    return LinkRow{std::string("  ") + name, value, unit, "", "", meaning};
  };
  std::vector<LinkRow> rows{key_row(laser, "wavelength_nm"),
                            key("pulse_energy_J"),
                            factor("sent", b.photons_sent, "", "photons per pulse, E lambda/(h c)"),
                            key("divergence_urad"),
                            key("pointing_urad"),
                            factor("gain", b.gain, "", "of the transmitter, 8/theta^2 exp(-2 (pointing/theta)^2)"),
                            key("range_m")};
  if (apart) {
    rows.push_back(key_row(observer, "range_m"));
    rows.back().key = "observer_range_m";
  }
  const std::vector<LinkRow> rest{
      factor("spread", b.spread_per_m4, "1/m^4", apart ? "1/(4 pi R1^2 4 pi R2^2)" : "(4 pi R^2)^-2"),
      key("aperture_m"),
      factor("area", b.receiver_area_m2, "m^2", "of the receiver"),
      key("eta_q"),
      key("eta_t"),
      key("eta_r"),
      key("T_a"),
      key("T_c"),
      factor("cross-section", cross_section_m2, "m^2", "of the body, 4 pi A"),
      factor("received", b.photons_per_m2 * cross_section_m2, "", "photoelectrons per pulse")};
  rows.insert(rows.end(), rest.begin(), rest.end());
  add_other_keys(there, &rows);
  for (LinkRow& row : rows) {
    if (row.key == "pulse_fwhm_ps" && !s.pulse.empty()) row.value = std::nan("");
  }
  return rows;
}

std::string link_text(const std::vector<LinkRow>& rows) {
  text::Columns columns;
  columns.add({"factor", "value", "unit", "default", "range", "meaning"});
  for (const auto& r : rows) {
    columns.add({r.key, std::isnan(r.value) ? "table" : fmt::format("{:.6g}", r.value), r.unit, r.default_value,
                 r.range, r.meaning});
  }
  return columns.text("");
}

}  // namespace clray::slr
