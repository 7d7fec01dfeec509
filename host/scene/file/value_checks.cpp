// SPDX-License-Identifier: Apache-2.0
// Checks of single values; see value_checks.hpp. A complaint says what was expected and what was found.
#include "scene/file/value_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clray/error.hpp"
#include "shared/portable.h"
#include "text/text.hpp"

namespace clray {
namespace {

void throw_fault(const std::string& where, const std::string& fault) {
  if (!fault.empty()) throw Error(ErrorCode::input, fault, where);
}

}  // namespace

bool is_name(const std::string& text) {
  const bool plain = text.find_first_of("/\\") == std::string::npos && text::shown(text) == text;
  return plain && !text.empty() && text != "." && text != "..";
}

std::string vector_fault(const Vec3& v) {
  const bool finite = std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  return finite ? "" : "expected three finite numbers";
}

std::string place_fault(const Vec3& v) {
  std::string fault = vector_fault(v);
  if (!fault.empty()) return fault;
  const double most = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  return most <= kLongest_m ? "" : fmt::format("expected at most {:g} m, found {:g}", kLongest_m, most);
}

Vec3 unit_vector(const Vec3& v) {
  if (std::fabs(v.x * v.x + v.y * v.y + v.z * v.z - 1.0) <= 1e-15) return v;
  // Scaled by the largest component first, so that squares of tiny and huge ones neither vanish nor overflow.
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  const Vec3 u(v.x / largest, v.y / largest, v.z / largest);
  const double length = std::sqrt(u.x * u.x + u.y * u.y + u.z * u.z);
  return {u.x / length, u.y / length, u.z / length};
}

std::string unit_fault(const Vec3& v) {
  std::string fault = vector_fault(v);
  if (!fault.empty()) return fault;
  const double square = v.x * v.x + v.y * v.y + v.z * v.z;
  // Normalised vectors have length 1 to a few ulp; 1e-12 allows for some arithmetic after that.
  if (std::fabs(square - 1.0) <= 1e-12) return "";
  return fmt::format("expected a unit vector, found length {}", std::sqrt(square));
}

std::string number_fault(double value, const Range& r) {
  const bool low = r.low_included ? value >= r.low : value > r.low;
  const bool high = r.high_included ? value <= r.high : value < r.high;
  if (std::isfinite(value) && low && high) return "";
  return fmt::format("expected a number in {}, found {}", range_text(r), value);
}

void check_number(const std::string& where, double value, const Range& range) {
  throw_fault(where, number_fault(value, range));
}

void check_vector(const std::string& where, const Vec3& v) {
  throw_fault(where, vector_fault(v));
}

void check_place(const std::string& where, const Vec3& v) {
  throw_fault(where, place_fault(v));
}

void check_angle(const std::string& where, double angle_rad) {
  const double most = kLargestAngle_deg / 180.0 * CLRAY_PI * (1.0 + 1e-12);
  check_number(where, angle_rad, {-most, most, true, true});
}

void check_unit(const std::string& where, const Vec3& v) {
  throw_fault(where, unit_fault(v));
}

std::string spectrum_fault(const Spectrum& s, const TableKey* key) {
  if (s.wavelength_nm.empty() || s.wavelength_nm.size() != s.value.size()) return "expected one value per wavelength";
  for (std::size_t i = 0; i < s.value.size(); ++i) {
    std::string fault = number_fault(s.wavelength_nm[i], kPositive);
    if (!fault.empty()) return fault;
    if (i > 0 && !(s.wavelength_nm[i] > s.wavelength_nm[i - 1])) return "wavelengths must increase";
    if (key == nullptr) fault = number_fault(s.value[i], kNotNegative);
    if (!fault.empty()) return fault;
    if (key == nullptr || key_accepts(*key, s.value[i])) continue;
    key_accepts(*key, s.value[i], &fault);
    return fmt::format("expected {}, found {}", fault, s.value[i]);
  }
  return "";
}

void check_spectrum(const std::string& where, const Spectrum& s) {
  throw_fault(where, spectrum_fault(s));
}

void check_attitudes(const std::string& where, const std::vector<Attitude>& attitudes, const Range& time) {
  for (std::size_t i = 0; i < attitudes.size(); ++i) {
    const Quaternion& q = attitudes[i].body_to_space;
    const double square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
    check_number(where + ".time_s", attitudes[i].time_s, time);
    if (i > 0 && !(attitudes[i].time_s > attitudes[i - 1].time_s))
      throw Error(ErrorCode::input, "times must increase", where);
    if (!(std::fabs(square - 1.0) <= 1e-9)) throw Error(ErrorCode::input, "expected quaternions of length 1", where);
  }
}

void check_pairs(const std::string& where, const std::vector<std::pair<double, double>>& pairs, const Range& range) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    check_number(where, pairs[i].first, kAny);
    check_number(where, pairs[i].second, range);
    if (i > 0 && !(pairs[i].first > pairs[i - 1].first)) throw_fault(where, "times must increase");
  }
}

}  // namespace clray
