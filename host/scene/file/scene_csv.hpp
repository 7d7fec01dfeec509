// SPDX-License-Identifier: Apache-2.0
// CSV tables of numbers that a scene file names: spectra, ranges, attitudes, pulses, BRDF tables. Values are in the
// unit of the column's name here, whatever that of the file. Every complaint is an Error(input) with file:line.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clray/scene.hpp"
#include "scene/file/csv_table.hpp"

namespace clray {

/// (wavelength_nm, value); wavelengths positive and increasing, values within [low, high].
Spectrum read_spectrum(const std::string& file, const CsvColumn& value, double low, double high);

/// (time, value) with increasing times, values within [low, high].
std::vector<std::pair<double, double>> read_pairs(const std::string& file, const CsvColumn& time,
                                                  const CsvColumn& value, double low, double high);

/// (time_s, qw, qx, qy, qz), which must be named: others put the scalar last. Increasing times; quaternions of length 1
/// to 1e-3, normalised.
std::vector<Attitude> read_attitudes(const std::string& file);

/// Times of a table's first column as s from `start`: a column of times that is `dated`, increasing.
std::vector<double> read_times(const CsvTable& table, const Epoch& start);

/// The first date of a table with dates, else nothing.
std::optional<Epoch> first_date(const CsvTable& table);

/// (time, qw, qx, qy, qz) by dates or by s from `start`, as above.
std::vector<Attitude> read_dated_attitudes(const std::string& file, const Epoch& start);

/// (time, x, y, z[, range]) by dates or by s from `start`.
std::vector<Directions::Row> read_directions(const std::string& file, const Epoch& start);

/// (theta_i_deg, theta_o_deg, phi_deg, value in 1/sr), every combination of the angles present exactly once.
BrdfTable read_brdf_table(const std::string& file);

}  // namespace clray
