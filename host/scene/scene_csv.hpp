// SPDX-License-Identifier: Apache-2.0
// Strict CSV tables of numbers that a scene file names: spectra, ranges, attitudes, pulses, BRDF tables.
// `#` begins a comment, one header line of words is allowed, every other line has exactly the columns asked for.
// Every complaint is an Error(input) with file:line.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "clray/scene.hpp"

namespace clray {

/// Rows of finite numbers, each with the line that it stood on.
struct CsvTable {
  std::string file;
  std::vector<std::vector<double>> rows;
  std::vector<int> lines;
};

/// Reads `file`; every row has one number for each of `columns` (their names, for messages).
CsvTable read_csv(const std::string& file, const std::vector<std::string>& columns);

/// (wavelength_nm, value); wavelengths positive and increasing, values within [low, high].
Spectrum read_spectrum(const std::string& file, double low, double high);

/// (time, value) with increasing times, returned in seconds; values within [low, high].
std::vector<std::pair<double, double>> read_pairs(const std::string& file, const std::vector<std::string>& columns,
                                                  double units_per_second, double low, double high);

/// (time_s, qw, qx, qy, qz) with increasing times; quaternions of length 1 to 1e-3, normalised.
std::vector<Attitude> read_attitudes(const std::string& file);

/// (theta_i_deg, theta_o_deg, phi_deg, value in 1/sr), every combination of the angles present exactly once.
BrdfTable read_brdf_table(const std::string& file);

}  // namespace clray
