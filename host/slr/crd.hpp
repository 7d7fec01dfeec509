// SPDX-License-Identifier: Apache-2.0
// ILRS Consolidated Laser Ranging Data format v2 (Ricklefs & Moore 2019, v2.01), full rate and normal points: a
// streaming writer and a strict reader. Fields are separated by blanks; "na" where a value is unknown.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "ephemeris/epoch.hpp"
#include "slr/text_file.hpp"

namespace clray::slr {

using namespace ephemeris;

/// The records before the ranges. Texts hold no blanks; unknown numbers are NaN.
struct CrdHeader {
  Epoch produced, start, stop;
  int data_type = 0;  ///< H4: 0 full rate, 1 normal points
  std::string station = "clray", pad = "0", system = "0", occupancy = "0", network = "na";
  std::string target = "na", cospar = "na", sic = "na", norad = "na";
  int target_class = 0;     ///< 0: no retro-reflector
  int target_location = 1;  ///< Earth orbit
  int prediction_type = 0;  ///< H5: 0 other, 1 CPF
  std::string prediction_year = "na", prediction_date = "na", prediction_source = "na", prediction_sequence = "na";
  double wavelength_nm = 532.0, rate_Hz = 0.0, pulse_energy_mJ = 0.0, pulse_fwhm_ps = 0.0, divergence_arcsec = 0.0;
  double quantum_efficiency_percent = 0.0, dark_kHz = 0.0;
  double pressure_hPa = 1013.25, temperature_K = 288.15, humidity_percent = 0.0;
};

/// Record 10: one range.
struct CrdRange {
  std::int64_t epoch_ps = 0;   ///< fire time, ps of the day
  std::int64_t flight_ps = 0;  ///< two-way time of flight
  int filter_flag = 0;         ///< 0 unknown, 1 noise, 2 data
};

/// Record 12: what holds for the ranges that follow.
struct CrdSupplement {
  std::int64_t epoch_ps = 0;
  double range_rate_m_s = 0.0;  ///< NaN: unknown
};

/// Record 30: where the telescope points, without refraction.
struct CrdAngles {
  std::int64_t epoch_ps = 0;
  double azimuth_deg = 0.0, elevation_deg = 0.0;
  double azimuth_rate_deg_s = 0.0, elevation_rate_deg_s = 0.0;
};

/// Record 50, and the part of record 11 that is alike: of residuals to the trend. NaN: unknown.
struct CrdStatistics {
  double rms_ps = 0.0, skewness = 0.0, kurtosis = 0.0;
};

/// Record 11: a normal point.
struct CrdNormalPoint {
  std::int64_t epoch_ps = 0, flight_ps = 0;
  double window_s = 0.0;
  std::uint64_t ranges = 0;
  CrdStatistics bin;
  double return_rate_percent = 0.0;
};

/// Writes a file; the ranges come one by one, so memory does not grow.
class CrdWriter {
 public:
  /// Writes all up to the first range: H1-H5, C0-C3, 12, 20, 40. Throws Error(output).
  CrdWriter(const std::string& path, const CrdHeader& header, const CrdSupplement& supplement);

  void range(const CrdRange& range);
  void supplement(const CrdSupplement& supplement);
  void angles(const CrdAngles& angles);
  void normal_point(const CrdNormalPoint& point);
  void statistics(const CrdStatistics& session);

  /// H8 and H9. Throws Error(output) where anything could not be written.
  void close();

 private:
  void configuration(const CrdHeader& header);

  TextFile file_;
};

/// A file as read.
struct CrdFile {
  CrdHeader header;
  std::vector<CrdSupplement> supplements;
  std::uint64_t ranges = 0;
  std::vector<CrdAngles> angles;
  std::vector<CrdNormalPoint> points;
  std::vector<CrdStatistics> statistics;
  std::map<std::string, std::uint64_t> records;  ///< how many of each type
};

/// Reads a file strictly, with each range handed to `on_range`. Throws Error(input) with file:line.
CrdFile read_crd(const std::string& path, const std::function<void(const CrdRange&)>& on_range);

}  // namespace clray::slr
