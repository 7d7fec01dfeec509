// SPDX-License-Identifier: Apache-2.0
// Checks of single values that scene files and scenes filled by hand share. The *_fault functions return what is wrong,
// or ""; the check_* functions throw Error(input) with `where`, the path of the member.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "clray/scene.hpp"
#include "scene/file/toml_reader.hpp"
#include "scene/tables.hpp"

namespace clray {

/// Whether a text can be a key of results and part of a file's name.
bool is_name(const std::string& text);
constexpr const char* kNameExpected = "expected a name without slashes and control characters";

/// Three finite numbers.
std::string vector_fault(const Vec3& v);

/// Lengths of a scene: squares and products of a few of them stay finite and above zero in double precision.
constexpr double kLongest_m = 1e15, kShortest_m = 1e-15;
/// Angles of transforms and hinges: whole turns beyond it would cost digits.
constexpr double kLargestAngle_deg = 1e6;

/// Three coordinates of at most kLongest_m.
std::string place_fault(const Vec3& v);

/// The unit vector along `v`, which is not zero. One that is a unit vector to rounding keeps its bits, so that
/// directions which a run states can be given to another.
Vec3 unit_vector(const Vec3& v);

/// A vector of length 1.
std::string unit_fault(const Vec3& v);

/// A finite number in the range.
std::string number_fault(double value, const Range& range);

void check_number(const std::string& where, double value, const Range& range);
void check_vector(const std::string& where, const Vec3& v);
void check_unit(const std::string& where, const Vec3& v);
void check_place(const std::string& where, const Vec3& v);
void check_angle(const std::string& where, double angle_rad);

/// One value per wavelength, wavelengths positive and increasing; values that `key` accepts or, without one, that are
/// not negative.
std::string spectrum_fault(const Spectrum& spectrum, const TableKey* key = nullptr);
void check_spectrum(const std::string& where, const Spectrum& spectrum);

/// Times in `time`, increasing, and quaternions of length 1.
void check_attitudes(const std::string& where, const std::vector<Attitude>& attitudes, const Range& time);

/// (time, value): finite and increasing times, values in `range`.
void check_pairs(const std::string& where, const std::vector<std::pair<double, double>>& pairs, const Range& range);

}  // namespace clray
