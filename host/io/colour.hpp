// SPDX-License-Identifier: Apache-2.0
// From band radiances to colour: CIE 1931 XYZ, linear sRGB, and the sRGB transfer curve. Source: C. Wyman, P.-P.
// Sloan, P. Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013, the
// multi-lobe fit; primaries and white point of ITU-R BT.709; transfer curve of IEC 61966-2-1.
#pragma once

#include <vector>

#include "clray/result.hpp"

namespace clray::io {

/// Colour-matching functions at a wavelength in nm.
Vec3 colour_matching(double wavelength_nm);

/// Mean of the colour-matching functions over a band, weighted by the source's light and the band's response. Zero
/// where the source has no light in it.
Vec3 band_colour(const Band& band, const Source& source);

/// XYZ to linear sRGB (white of D65 at Y = 1 becomes 1, 1, 1).
Vec3 xyz_to_linear_srgb(const Vec3& xyz);

/// Linear [0,1] to the sRGB code value in [0,1]; clips.
double srgb_encode(double linear);

/// Weights that turn an image's radiance per irradiance (1/sr, per band) into linear sRGB where a white Lambert plate
/// square to the light has luminance 1. All zero where no band is visible.
std::vector<Vec3> rgb_weights(const ImageResult& image, const Source& source);

}  // namespace clray::io
