// SPDX-License-Identifier: Apache-2.0
// The filters that clray knows by name, the Sun and Vega: the tables of host/scene/photometry, which
// scripts/make-photometry writes. Responses weigh energy. Vega has 0.03 mag in the Johnson-Cousins bands (Bessell &
// Murphy 2012) and 0 in all others.
#include <fmt/format.h>

#include <algorithm>

#include "clray/error.hpp"
#include "scene/spectrum.hpp"

namespace clray {
namespace {

// Rows of two numbers each.
// clang-format off
const double kB[] = {
#include "scene/photometry/bessell_B.inc"
};
const double kV[] = {
#include "scene/photometry/bessell_V.inc"
};
const double kR[] = {
#include "scene/photometry/bessell_R.inc"
};
const double kI[] = {
#include "scene/photometry/bessell_I.inc"
};
const double kGaiaG[] = {
#include "scene/photometry/gaia_G.inc"
};
const double kSloanG[] = {
#include "scene/photometry/sdss_g.inc"
};
const double kSloanR[] = {
#include "scene/photometry/sdss_r.inc"
};
const double kSloanI[] = {
#include "scene/photometry/sdss_i.inc"
};
const double kSloanZ[] = {
#include "scene/photometry/sdss_z.inc"
};
const double kSun[] = {
#include "scene/photometry/sun.inc"
};
const double kVega[] = {
#include "scene/photometry/vega.inc"
};
// clang-format on

template <std::size_t N>
Spectrum spectrum_of(const double (&numbers)[N]) {
  static_assert(N % 2 == 0, "a row has two numbers");
  Spectrum s;
  for (std::size_t i = 0; i < N; i += 2) {
    s.wavelength_nm.push_back(numbers[i]);
    s.value.push_back(numbers[i + 1]);
  }
  return s;
}

template <std::size_t N>
Band filter(const char* name, const double (&numbers)[N], double vega_magnitude, bool in_vega) {
  Band band = make_band(name, spectrum_of(numbers));
  band.vega_magnitude = vega_magnitude;
  band.in_vega = in_vega;
  return band;
}

const std::vector<Band>& all() {
  static const std::vector<Band> bands{
      filter("B", kB, 0.03, true),      filter("V", kV, 0.03, true),      filter("R", kR, 0.03, true),
      filter("I", kI, 0.03, true),      filter("G", kGaiaG, 0.0, true),   filter("g", kSloanG, 0.0, false),
      filter("r", kSloanR, 0.0, false), filter("i", kSloanI, 0.0, false), filter("z", kSloanZ, 0.0, false)};
  return bands;
}

}  // namespace

const std::vector<std::string>& photometric_bands() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Band& band : all()) list.push_back(band.name);
    return list;
  }();
  return names;
}

Band photometric_band(const std::string& name) {
  for (const Band& band : all()) {
    if (band.name == name) return band;
  }
  throw Error(ErrorCode::input,
              fmt::format("there is no filter \"{}\"; expected one of {}", name, fmt::join(photometric_bands(), ", ")));
}

bool is_photometric(const Band& band) {
  return std::any_of(all().begin(), all().end(), [&](const Band& known) { return band.response == known.response; });
}

const Spectrum& solar_spectrum() {
  static const Spectrum sun = spectrum_of(kSun);
  return sun;
}

const Spectrum& vega_spectrum() {
  static const Spectrum vega = spectrum_of(kVega);
  return vega;
}

}  // namespace clray
