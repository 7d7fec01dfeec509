// SPDX-License-Identifier: Apache-2.0
// CRD v2 writer; see crd.hpp. A simulated station has no system delay and no atmosphere, and these are
// written as zeros. What is not known is written as "na" where readers take it.
#include "slr/crd.hpp"

#include <fmt/format.h>

#include <cmath>

namespace clray::slr {

namespace {

std::string calendar(const Epoch& epoch) {
  const Date d = date_of(epoch);
  return fmt::format("{:04} {:02} {:02} {:02} {:02} {:02}", d.year, d.month, d.day, d.hour, d.minute, d.second);
}

std::string value(double number, int decimals) {
  return std::isfinite(number) ? fmt::format("{:.{}f}", number, decimals) : "na";
}

}  // namespace

CrdWriter::CrdWriter(const std::string& path, const CrdHeader& h, const CrdSupplement& s) : file_(path) {
  const Date made = date_of(h.produced);
  file_.text(fmt::format("H1 CRD  2 {:04} {:02} {:02} {:02}\n", made.year, made.month, made.day, made.hour));
  // Time scale 7: UTC (BIH). Simulated clocks have no error.
  file_.text(fmt::format("H2 {} {} {} {} 7 {}\n", h.station, h.pad, h.system, h.occupancy, h.network));
  file_.text(
      fmt::format("H3 {} {} {} {} 0 {} {}\n", h.target, h.cospar, h.sic, h.norad, h.target_class, h.target_location));
  // First release. Corrected for refraction, since light was traced in a vacuum: who corrected the ranges
  // again would shorten them. Not corrected for centre of mass and amplitude. The system delay, which is zero, is
  // applied. Two-way ranges; data quality undefined.
  file_.text(fmt::format("H4 {} {} {} 0 1 0 0 1 0 2 0\n", h.data_type, calendar(h.start), calendar(h.stop)));
  file_.text(fmt::format("H5 {} {} {} {} {}\n", h.prediction_type, h.prediction_year, h.prediction_date,
                         h.prediction_source, h.prediction_sequence));
  configuration(h);
  supplement(s);
  file_.text("20 ").decimal(s.epoch_ps, 12);
  file_.text(
      fmt::format(" {} {} {} 0\n", value(h.pressure_hPa, 2), value(h.temperature_K, 2), value(h.humidity_percent, 0)));
  // Numbers throughout: programs that read such files know no "na" here.
  file_.text("40 ").decimal(s.epoch_ps, 12).text(" 0 sys 0 0 0.0 0.0 0.0 0.0 0.0 0.0 0.0 0 0 0 0 0.0\n");
}

void CrdWriter::configuration(const CrdHeader& h) {
  file_.text("00 simulated by clray " CLRAY_VERSION "\n");
  file_.text(fmt::format("C0 0 {} sys laser detector timing\n", value(h.wavelength_nm, 3)));
  file_.text(fmt::format("C1 0 laser simulated {} {} {} {} {} 1\n", value(h.wavelength_nm, 3), value(h.rate_Hz, 3),
                         value(h.pulse_energy_mJ, 3), value(h.pulse_fwhm_ps, 3), value(h.divergence_arcsec, 3)));
  file_.text(fmt::format("C2 0 detector single-photon {} {} na {} na na na na na na na na na\n",
                         value(h.wavelength_nm, 3), value(h.quantum_efficiency_percent, 2), value(h.dark_kHz, 3)));
  file_.text("C3 0 timing simulated simulated simulated na 0.0\n");
}

void CrdWriter::supplement(const CrdSupplement& s) {
  file_.text("12 ").decimal(s.epoch_ps, 12).text(fmt::format(" sys 0.0 na na 0.0 {}\n", value(s.range_rate_m_s, 6)));
}

void CrdWriter::range(const CrdRange& r) {
  static const char* const kTail[] = {" sys 2 0 0 0 na na", " sys 2 1 0 0 na na", " sys 2 2 0 0 na na"};
  file_.text("10 ").decimal(r.epoch_ps, 12).text(" ").decimal(r.flight_ps, 12).text(kTail[r.filter_flag]).end_line();
}

// Transmitting and receiving, computed, without refraction.
void CrdWriter::angles(const CrdAngles& a) {
  file_.text("30 ").decimal(a.epoch_ps, 12);
  file_.text(fmt::format(" {:.4f} {:.4f} 0 1 1 {:.7f} {:.7f}\n", a.azimuth_deg, a.elevation_deg, a.azimuth_rate_deg_s,
                         a.elevation_rate_deg_s));
}

void CrdWriter::normal_point(const CrdNormalPoint& p) {
  file_.text("11 ").decimal(p.epoch_ps, 12).text(" ").decimal(p.flight_ps, 12);
  file_.text(fmt::format(" sys 2 {} {} {} {} {} na {} 0 na\n", value(p.window_s, 1), p.ranges, value(p.bin.rms_ps, 1),
                         value(p.bin.skewness, 3), value(p.bin.kurtosis, 3), value(p.return_rate_percent, 2)));
}

void CrdWriter::statistics(const CrdStatistics& s) {
  file_.text(fmt::format("50 sys {} {} {} na 0\n", value(s.rms_ps, 1), value(s.skewness, 3), value(s.kurtosis, 3)));
}

void CrdWriter::close() {
  file_.text("H8\nH9\n");
  file_.close();
}

}  // namespace clray::slr
