// SPDX-License-Identifier: Apache-2.0
// The link budget of a laser-ranging station: from optical cross-section to expected photoelectrons per pulse, at the
// station or at another observer with the station's receiver. SI.
// Source: Degnan (1993), "Millimeter accuracy satellite laser ranging: a review", eq. for N;
// docs/physics.md, section 5.
#pragma once

#include <string>
#include <vector>

#include "clray/scene.hpp"

namespace clray::slr {

/// From the source to the body and from there to the observer, m.
struct Ranges {
  double out_m, back_m;
};

/// Every factor of N = eta_q n_T eta_t G_t sigma (4 pi R1^2 4 pi R2^2)^-1 A_r eta_r T_a^2 T_c^2.
struct LinkBudget {
  double eta_q, eta_t, eta_r, T_a, T_c;
  double photons_sent;      ///< n_T = E_T lambda / (h c), per pulse
  double gain;              ///< G_t = 8/theta^2 exp(-2 (pointing/theta)^2)
  double spread_per_m4;     ///< (4 pi R1^2 4 pi R2^2)^-1
  double receiver_area_m2;  ///< A_r
  double photons_per_m2;    ///< product: photoelectrons per pulse and m^2 of cross-section
};

/// Throws Error(input) naming the key where the station makes no sense (zero divergence, negative rates, ...).
void check_station(const Station& station, double wavelength_nm);

/// The budget at these ranges, or at a station that sees its own light; checks station and ranges.
LinkBudget link_budget(const Station& station, double wavelength_nm, const Ranges& ranges);
LinkBudget link_budget(const Station& station, double wavelength_nm, double range_m);

/// One line of the table: a key of the station, or (its name indented) a factor made of them.
struct LinkRow {
  std::string key;
  double value;  ///< NaN: a table stands instead
  std::string unit, default_value, range, meaning;
};

/// The rows in the order of the formula, then the detector's.
std::vector<LinkRow> link_rows(const Station& station, double wavelength_nm, double cross_section_m2,
                               const Ranges& ranges);

/// The rows in columns, for a person.
std::string link_text(const std::vector<LinkRow>& rows);

}  // namespace clray::slr
