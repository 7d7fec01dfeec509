// SPDX-License-Identifier: Apache-2.0
// Light curves: what one observer sees of the body over the orientations, a row per orientation and band, with the
// magnitudes that observers compare (docs/physics.md, section 9). Magnitudes, degrees, metres.
#pragma once

#include <string>
#include <vector>

#include "io/summary_entries.hpp"
#include "io/writer.hpp"

namespace clray::io {

/// One instant in one band. NaN: not known.
struct LightCurveRow {
  const SpectrometerResult* record = nullptr;
  const PassInstant* instant = nullptr;  ///< of a pass
  const SiteSight* sight = nullptr;      ///< of the observer's site
  double range_m = 0.0;
  double standard_AB = 0.0;     ///< above the atmosphere, at 1000 km
  double standard_90_AB = 0.0;  ///< the same, moved along the band's phase curve to 90 degrees
};

/// A band's magnitudes at 1000 km against phase: means over cells of 5 degrees, joined by straight lines.
struct PhaseCurve {
  std::vector<double> phase_deg, magnitude_AB, standard_error;  ///< of the cells, phases increasing
  double least_deg = 0.0, most_deg = 0.0;                       ///< of the instants
  double at(double phase_deg, double* error = nullptr) const;   ///< the end segments go on beyond the ends
  bool covers(double phase_deg) const;
};

/// What one observer sees in one band. Instants in which its site does not see the body are left out.
struct BandCurve {
  std::string name;
  std::vector<LightCurveRow> rows;
  PhaseCurve phases;
  double AB_minus_Vega = 0.0;  ///< the same for all magnitudes of a band; NaN: there is no Vega magnitude
  double at_90_AB = 0.0, at_90_error = 0.0;
  std::string why_not;  ///< why there is no magnitude at 90 degrees; empty where there is one
};

/// The light curve of one detector, observer and variant.
struct LightCurve {
  ResultKey key;
  std::vector<BandCurve> bands;  ///< as long as each other
};

/// All of them: those of records that have several orientations.
std::vector<LightCurve> light_curves(const Writer& writer);

/// lightcurve.csv and .png.
void write_light_curve(Writer& writer, const LightCurve& curve);

/// Index of a record's observer in the scene; 0 where there is only one.
std::size_t observer_of(const Scene& scene, const ResultKey& key);

/// A band's name as files show it, and with nm behind it if it is a range of wavelengths.
std::string band_name(const SpectrometerResult& record);
std::string band_label(const SpectrometerResult& record);

}  // namespace clray::io
