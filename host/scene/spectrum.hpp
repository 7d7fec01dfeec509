// SPDX-License-Identifier: Apache-2.0
// Quantities against wavelength: values and means of tables, the light of a source within a band, the bands of a
// scene, and the zero point of magnitudes. Wavelengths in nm, irradiance in W/m².
// Beyond the ends of its table a surface's key is constant (spectrum_at); a source sends nothing and a filter passes
// nothing (spectrum_inside). Every weight by light is made of source_spectral_W_m2_nm() and response_at().
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "clray/scene.hpp"
#include "scene/tables.hpp"

namespace clray {

/// Vega above the atmosphere, 100 nm to 10 µm, W/m²/nm.
const Spectrum& vega_spectrum();

/// Whether a band is a photometric_band(), under whatever name.
bool is_photometric(const Band& band);

/// Value at a wavelength: linear between points, constant beyond them.
double spectrum_at(const Spectrum& spectrum, double wavelength_nm);

/// The same, but zero beyond them.
double spectrum_inside(const Spectrum& spectrum, double wavelength_nm);

/// Mean over [low, high], the exact integral of the piecewise linear function; the value where low == high.
double spectrum_mean(const Spectrum& spectrum, double low_nm, double high_nm);

/// Mean over a band as its detector sees it: weighted by the source's light and the band's response, so that mean times
/// source_band_W_m2() is what comes through. For a laser, or a band of no width or light, spectrum_mean().
double spectrum_mean(const Spectrum& spectrum, const Band& band, const Source& source);

/// Mean of `weight` (smooth over `step_nm`) over a band, weighted by the source's light and the band's response; for a
/// laser its value at the line. 0 where there is no light.
double band_mean(const std::function<double(double)>& weight, double step_nm, const Band& band, const Source& source);

/// Transmission of a band at a wavelength: its response (1 without one), 0 outside the band and the response's table.
double response_at(const Band& band, double wavelength_nm);

/// Irradiance within a band of what has the AB magnitude 0: 3631 Jy at every frequency (Oke & Gunn 1983), weighted by
/// the band's response in energy, W/m². 0 for a band of no width.
double ab_zero_W_m2(const Band& band);

/// The same of what has the Vega magnitude 0 in the band: Vega's light, and the magnitude that Vega itself has there.
/// 0 where Vega's table (100 nm to 10 µm) has no light.
double vega_zero_W_m2(const Band& band);

/// Irradiance of the source that passes a band, W/m². A laser has unit irradiance, all of it in its line: 1 if the band
/// holds wavelength_nm (ends included), else 0; times the band's response. A sun is its spectrum table (nothing beyond
/// its ends), else a black body of blackbody_K (5772 K unless given) scaled to irradiance_W_m2 over all wavelengths.
double source_band_W_m2(const Source& source, const Band& band);

/// Spectral irradiance of a sun at a wavelength, W/m²/nm; zero for a laser, which has a line.
double source_spectral_W_m2_nm(const Source& source, double wavelength_nm);

/// The bands of the source: a laser's line as one band of no width, a sun's own bands, or 400-700 nm.
std::vector<Band> bands_of(const Scene& scene);

/// The same for a detector, a row of detector.def: without bands one that measures the whole light has all_light().
std::vector<Band> bands_of(const Scene& scene, const TableRow& detector);

/// Whether that is so: there are no bands, and this detector measures all of a sun's light.
bool takes_all_light(const Scene& scene, const TableRow& detector);

/// Where a sun shines: from end to end of its table; of a black body 200-10000 nm at 5772 K (0.9978 of its light),
/// and the like share at any other temperature.
Band all_light(const Source& source);

/// A band named by its range, "400-500", or "532" if it has no width.
Band make_band(double low_nm, double high_nm);

/// A band that passes what a filter's curve does, from its first wavelength to its last.
Band make_band(const std::string& name, Spectrum response);

}  // namespace clray
