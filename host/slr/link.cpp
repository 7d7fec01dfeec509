// SPDX-License-Identifier: Apache-2.0
// The link budget; see link.hpp.
#include "slr/link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "clray/session.hpp"
#include "shared/elementary.h"

namespace clray::slr {

namespace {

[[noreturn]] void refuse(const char* key, double value, const char* expected) {
  throw Error(ErrorCode::input, fmt::format("is {}; expected {}", value, expected), fmt::format("station.{}", key));
}

void positive(const char* key, double value, const char* unit) {
  if (!(value > 0.0) || !std::isfinite(value)) refuse(key, value, fmt::format("more than 0 {}", unit).c_str());
}

void not_negative(const char* key, double value, const char* unit) {
  if (!(value >= 0.0) || !std::isfinite(value)) refuse(key, value, fmt::format("0 {} or more", unit).c_str());
}

void share(const char* key, double value) {
  if (!(value >= 0.0 && value <= 1.0)) refuse(key, value, "a number in [0,1]");
}

std::string shown(double value) {
  return fmt::format("{:.6g}", value);
}

void efficiency_rows(const Station& s, std::vector<LinkRow>* rows) {
  rows->push_back({"eta_q", shown(s.eta_q), "", "1", "[0,1]", "quantum efficiency of the detector"});
  rows->push_back({"eta_t", shown(s.eta_t), "", "1", "[0,1]", "efficiency of the transmit optics"});
  rows->push_back({"eta_r", shown(s.eta_r), "", "1", "[0,1]", "efficiency of the receive optics"});
  rows->push_back({"T_a", shown(s.T_a), "", "1", "[0,1]", "one-way transmission of the atmosphere, enters squared"});
  rows->push_back({"T_c", shown(s.T_c), "", "1", "[0,1]", "one-way transmission of cirrus, enters squared"});
}

void detector_rows(const Station& s, std::vector<LinkRow>* rows) {
  rows->push_back({"rate_Hz", shown(s.rate_Hz), "1/s", "2000", "(0,inf)", "pulses a second"});
  rows->push_back({"pulse_fwhm_ps", s.pulse.empty() ? shown(s.pulse_fwhm_s * 1e12) : "table", "ps", "0", "[0,inf)",
                   "width of the transmit pulse; 0 is a delta"});
  rows->push_back({"noise_per_ns", shown(s.noise_per_ns), "1/ns", "0.001", "[0,inf)", "background photons"});
  rows->push_back({"dark_per_ns", shown(s.dark_per_ns), "1/ns", "0", "[0,inf)", "dark counts"});
  rows->push_back({"gate_ns", shown(s.gate_s * 1e9), "ns", "100", "[bin,inf)", "gate, centred on 2 range/c"});
  rows->push_back({"jitter_fwhm_ps", shown(s.jitter_fwhm_s * 1e12), "ps", "0", "[0,inf)", "timing jitter, Gaussian"});
  rows->push_back({"dead_time_ns", shown(s.dead_time_s * 1e9), "ns", "0", "[0,inf)", "blind after a detection"});
}

}  // namespace

void check_station(const Station& s, double wavelength_nm) {
  if (!(wavelength_nm > 0.0) || !std::isfinite(wavelength_nm)) {
    throw Error(ErrorCode::input, fmt::format("is {}; expected more than 0 nm", wavelength_nm), "source.wavelength_nm");
  }
  positive("pulse_energy_J", s.pulse_energy_J, "J");
  positive("divergence_urad", s.divergence_rad * 1e6, "urad");
  positive("aperture_m", s.aperture_m, "m");
  positive("rate_Hz", s.rate_Hz, "Hz");
  positive("gate_ns", s.gate_s * 1e9, "ns");
  not_negative("pointing_urad", s.pointing_rad * 1e6, "urad");
  not_negative("noise_per_ns", s.noise_per_ns, "per ns");
  not_negative("dark_per_ns", s.dark_per_ns, "per ns");
  not_negative("jitter_fwhm_ps", s.jitter_fwhm_s * 1e12, "ps");
  not_negative("dead_time_ns", s.dead_time_s * 1e9, "ns");
  not_negative("pulse_fwhm_ps", s.pulse_fwhm_s * 1e12, "ps");
  not_negative("start_mjd", s.start_mjd, "days");
  share("eta_q", s.eta_q);
  share("eta_t", s.eta_t);
  share("eta_r", s.eta_r);
  share("T_a", s.T_a);
  share("T_c", s.T_c);
}

LinkBudget link_budget(const Station& s, double wavelength_nm, double range_m) {
  check_station(s, wavelength_nm);
  positive("range_m", range_m, "m");
  LinkBudget b{};
  b.eta_q = s.eta_q;
  b.eta_t = s.eta_t;
  b.eta_r = s.eta_r;
  b.T_a = s.T_a;
  b.T_c = s.T_c;
  b.photons_sent = s.pulse_energy_J * (wavelength_nm * 1e-9) / (kPlanck * kLightSpeed);
  const double miss = s.pointing_rad / s.divergence_rad;
  b.gain = 8.0 / (s.divergence_rad * s.divergence_rad) * el_exp(-2.0 * miss * miss);
  const double sphere = 4.0 * kPi * range_m * range_m;
  b.spread_per_m4 = 1.0 / (sphere * sphere);
  b.receiver_area_m2 = 0.25 * kPi * s.aperture_m * s.aperture_m;
  b.photons_per_m2 = b.eta_q * b.photons_sent * b.eta_t * b.gain * b.spread_per_m4 * b.receiver_area_m2 * b.eta_r *
                     (b.T_a * b.T_a) * (b.T_c * b.T_c);
  return b;
}

std::vector<LinkRow> link_rows(const Station& s, double wavelength_nm, double cross_section_m2, double range_m) {
  const LinkBudget b = link_budget(s, wavelength_nm, range_m);
  std::vector<LinkRow> rows;
  rows.push_back({"wavelength_nm", shown(wavelength_nm), "nm", "532", "(0,1e7]", "of the laser (source)"});
  rows.push_back({"pulse_energy_J", shown(s.pulse_energy_J), "J", "0.08", "(0,inf)", "of one pulse"});
  rows.push_back({"  sent", shown(b.photons_sent), "", "", "", "photons per pulse, E lambda/(h c)"});
  rows.push_back({"divergence_urad", shown(s.divergence_rad * 1e6), "urad", "25", "(0,inf)", "1/e^2 half-angle"});
  rows.push_back(
      {"pointing_urad", shown(s.pointing_rad * 1e6), "urad", "0", "[0,inf)", "error of the beam's pointing"});
  rows.push_back({"  gain", shown(b.gain), "", "", "", "of the transmitter, 8/theta^2 exp(-2 (pointing/theta)^2)"});
  rows.push_back({"range_m", shown(range_m), "m", "1e6", "(0,1e13]", "one way"});
  rows.push_back({"  spread", shown(b.spread_per_m4), "1/m^4", "", "", "(4 pi R^2)^-2"});
  rows.push_back({"aperture_m", shown(s.aperture_m), "m", "0.5", "(0,inf)", "diameter of the receiver"});
  rows.push_back({"  area", shown(b.receiver_area_m2), "m^2", "", "", "of the receiver"});
  efficiency_rows(s, &rows);
  rows.push_back({"  cross-section", shown(cross_section_m2), "m^2", "", "", "of the body, 4 pi A"});
  rows.push_back({"  received", shown(b.photons_per_m2 * cross_section_m2), "", "", "", "photoelectrons per pulse"});
  detector_rows(s, &rows);
  return rows;
}

}  // namespace clray::slr

namespace clray {

std::string link_budget_table(const Station& station, double wavelength_nm, double cross_section_m2, double range_m) {
  const auto rows =
      slr::link_rows(station, wavelength_nm, cross_section_m2, range_m != 0.0 ? range_m : station.range_m);
  std::string text =
      fmt::format("{:<16} {:>13} {:<6} {:>7} {:<10} {}\n", "factor", "value", "unit", "default", "range", "meaning");
  for (const auto& r : rows) {
    text += fmt::format("{:<16} {:>13} {:<6} {:>7} {:<10} {}\n", r.key, r.value, r.unit, r.default_value, r.range,
                        r.meaning);
  }
  return text;
}

}  // namespace clray
