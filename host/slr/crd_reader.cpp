// SPDX-License-Identifier: Apache-2.0
// Strict reader of CRD v2 files with one session, full rate or normal points; see crd.hpp. Records that a file of
// another station may hold and that we do not use are accepted by their type and number of fields.
#include <fmt/format.h>

#include "ephemeris/record_text.hpp"
#include "slr/crd.hpp"

namespace clray::slr {

namespace {

struct Form {
  const char* type;
  std::size_t low, high;  ///< fields, the type included
};

/// Data and configuration records of format version 2.
constexpr Form kForms[] = {{"C0", 4, 12},  {"C1", 10, 10}, {"C2", 17, 17}, {"C3", 8, 8},   {"C4", 11, 11},
                           {"C5", 7, 7},   {"C6", 12, 12}, {"C7", 10, 10}, {"10", 10, 10}, {"11", 14, 14},
                           {"12", 8, 8},   {"20", 6, 6},   {"21", 10, 10}, {"30", 9, 9},   {"40", 18, 18},
                           {"41", 18, 18}, {"42", 15, 15}, {"50", 7, 7},   {"00", 1, 999}};

/// Number of fields of a record; false for a record that the body of a file cannot have.
bool check_form(const RecordReader& in) {
  if (in.type().size() == 2 && in.type()[0] == '9') return true;  // defined by users
  for (const Form& form : kForms) {
    if (in.type() != form.type) continue;
    in.expect_fields(form.low, form.high);
    return true;
  }
  return false;
}

Epoch read_date(const RecordReader& in, std::size_t at, bool to_seconds) {
  std::int64_t mjd = 0;
  const auto year = static_cast<int>(in.integer(at, 1950, 2100, "year"));
  const auto month = static_cast<int>(in.integer(at + 1, 1, 12, "month"));
  if (!mjd_of(year, month, static_cast<int>(in.integer(at + 2, 1, 31, "day")), &mjd)) in.fail("no such date");
  std::int64_t seconds = in.integer(at + 3, 0, 23, "hour") * 3600;
  if (to_seconds) seconds += in.integer(at + 4, 0, 59, "minute") * 60 + in.integer(at + 5, 0, 60, "second");
  return {mjd, seconds * kPicosecondsPerSecond};
}

std::string identifier(const RecordReader& in, std::size_t i, const char* what) {
  in.integer_or_na(i, 0, 999999999, 0, what);
  return std::string(in.field(i));
}

void read_h1(const RecordReader& in, CrdHeader* h) {
  in.expect_fields(7, 7);
  if (in.field(1) != "CRD" && in.field(1) != "crd") in.fail(fmt::format("\"{}\"; expected CRD", in.field(1)));
  const long version = in.integer(2, 0, 99, "format version");
  if (version != 2) in.fail(fmt::format("format version {}; expected 2", version));
  h->produced = read_date(in, 3, false);
}

void read_h2(const RecordReader& in, CrdHeader* h) {
  in.expect_fields(7, 7);
  h->station = in.field(1);
  h->pad = identifier(in, 2, "station id");
  h->system = identifier(in, 3, "system number");
  h->occupancy = identifier(in, 4, "occupancy number");
  in.integer(5, 0, 99, "time scale");
  h->network = in.field(6);
}

void read_h3(const RecordReader& in, CrdHeader* h) {
  in.expect_fields(8, 8);
  h->target = in.field(1);
  h->cospar = identifier(in, 2, "COSPAR id");
  h->sic = identifier(in, 3, "SIC");
  h->norad = identifier(in, 4, "NORAD id");
  in.integer(5, 0, 2, "spacecraft time scale");
  h->target_class = static_cast<int>(in.integer(6, 0, 9, "target class"));
  h->target_location = static_cast<int>(in.integer_or_na(7, 0, 99, 0, "target location"));
}

void read_h4(const RecordReader& in, CrdHeader* h) {
  in.expect_fields(22, 22);
  h->data_type = static_cast<int>(in.integer(1, 0, 9, "data type"));
  if (h->data_type > 1) in.fail(fmt::format("data type {}; expected 0 (full rate) or 1 (normal points)", h->data_type));
  h->start = read_date(in, 2, true);
  h->stop = read_date(in, 8, true);
  if (seconds_between(h->start, h->stop) < 0.0) in.fail("the session ends before it starts");
  in.integer(14, 0, 99, "data release");
  for (std::size_t i = 15; i < 20; ++i) in.integer(i, 0, 1, "correction flag");
  in.integer(20, 0, 4, "range type");
  in.integer(21, 0, 9, "data quality");
}

void read_h5(const RecordReader& in, CrdHeader* h) {
  in.expect_fields(6, 6);
  h->prediction_type = static_cast<int>(in.integer(1, 0, 9, "prediction type"));
  h->prediction_year = identifier(in, 2, "year of century");
  h->prediction_date = in.field(3);
  h->prediction_source = in.field(4);
  h->prediction_sequence = in.field(5);
}

void read_header(RecordReader& in, CrdHeader* h) {
  using Read = void (*)(const RecordReader&, CrdHeader*);
  static const std::pair<const char*, Read> kHeaders[] = {
      {"H1", read_h1}, {"H2", read_h2}, {"H3", read_h3}, {"H4", read_h4}, {"H5", read_h5}};
  for (const auto& [type, read] : kHeaders) {
    do {
      if (!in.next()) in.fail(fmt::format("the file ends; expected record {}", type));
    } while (in.type() == "00");
    if (in.type() != type) in.fail(fmt::format("record {}; expected {}", in.type(), type));
    read(in, h);
  }
}

std::int64_t second_of_day(const RecordReader& in) {
  const std::int64_t ps = in.picoseconds(1, "seconds of day");
  if (ps >= kPicosecondsPerDay) in.fail("seconds of day; expected less than 86400");
  return ps;
}

void expect_system(const RecordReader& in, std::size_t i, const std::string& system) {
  if (in.field(i) != system) in.fail(fmt::format("system configuration \"{}\"; C0 says \"{}\"", in.field(i), system));
}

CrdRange read_range(const RecordReader& in, const std::string& system) {
  CrdRange r;
  r.epoch_ps = second_of_day(in);
  r.flight_ps = in.picoseconds(2, "time of flight");
  expect_system(in, 3, system);
  in.integer(4, 0, 6, "epoch event");
  r.filter_flag = static_cast<int>(in.integer(5, 0, 2, "filter flag"));
  in.integer(6, 0, 99, "detector channel");
  in.integer(7, 0, 99, "stop number");
  in.integer_or_na(8, -1, 999999999, 0, "receive amplitude");
  in.integer_or_na(9, -1, 999999999, 0, "transmit amplitude");
  return r;
}

CrdNormalPoint read_normal_point(const RecordReader& in, const std::string& system) {
  CrdNormalPoint p;
  p.epoch_ps = second_of_day(in);
  p.flight_ps = in.picoseconds(2, "time of flight");
  expect_system(in, 3, system);
  in.integer(4, 0, 6, "epoch event");
  p.window_s = in.number(5, "length of the bin");
  if (!(p.window_s > 0.0)) in.fail("the length of the bin is not above 0");
  p.ranges = static_cast<std::uint64_t>(in.integer(6, 1, 999999999, "number of ranges"));
  p.bin = {in.number_or_na(7, "rms"), in.number_or_na(8, "skewness"), in.number_or_na(9, "kurtosis")};
  in.number_or_na(10, "peak minus mean");
  p.return_rate_percent = in.number_or_na(11, "return rate");
  in.integer(12, 0, 99, "detector channel");
  in.number_or_na(13, "signal to noise");
  return p;
}

CrdAngles read_angles(const RecordReader& in) {
  CrdAngles a;
  a.epoch_ps = second_of_day(in);
  a.azimuth_deg = in.number(2, "azimuth");
  a.elevation_deg = in.number(3, "elevation");
  if (!(a.azimuth_deg >= 0.0 && a.azimuth_deg <= 360.0)) in.fail("azimuth; expected 0 to 360 degrees");
  if (!(a.elevation_deg >= -90.0 && a.elevation_deg <= 90.0)) in.fail("elevation; expected -90 to 90 degrees");
  in.integer(4, 0, 2, "direction");
  in.integer(5, 0, 3, "origin of the angles");
  in.integer(6, 0, 1, "refraction corrected");
  a.azimuth_rate_deg_s = in.number_or_na(7, "azimuth rate");
  a.elevation_rate_deg_s = in.number_or_na(8, "elevation rate");
  return a;
}

CrdStatistics read_statistics(const RecordReader& in, const std::string& system) {
  expect_system(in, 1, system);
  const CrdStatistics s{in.number_or_na(2, "rms"), in.number_or_na(3, "skewness"), in.number_or_na(4, "kurtosis")};
  in.number_or_na(5, "peak minus mean");
  in.integer(6, 0, 5, "data quality");
  return s;
}

void read_calibration(const RecordReader& in) {
  second_of_day(in);
  in.integer(2, 0, 5, "type of data");
  in.integer_or_na(4, 0, 999999999, 0, "points recorded");
  in.integer_or_na(5, 0, 999999999, 0, "points used");
  for (std::size_t i = 6; i < 13; ++i) in.number_or_na(i, "calibration value");
  in.integer(13, 0, 5, "calibration type");
  in.integer(14, 0, 4, "calibration shift type");
  in.integer(15, 0, 99, "detector channel");
  in.integer(16, 0, 5, "calibration span");
  in.number_or_na(17, "return rate");
}

void read_laser(const RecordReader& in, CrdHeader* h) {
  in.integer(1, 0, 0, "detail type");
  h->wavelength_nm = in.number(4, "wavelength");
  h->rate_Hz = in.number_or_na(5, "fire rate");
  h->pulse_energy_mJ = in.number_or_na(6, "pulse energy");
  h->pulse_fwhm_ps = in.number_or_na(7, "pulse width");
  h->divergence_arcsec = in.number_or_na(8, "beam divergence");
  in.integer_or_na(9, 1, 999, 1, "pulses in semi-train");
}

void read_detector(const RecordReader& in, CrdHeader* h) {
  in.integer(1, 0, 0, "detail type");
  in.number_or_na(4, "wavelength");
  h->quantum_efficiency_percent = in.number_or_na(5, "quantum efficiency");
  in.number_or_na(6, "voltage");
  h->dark_kHz = in.number_or_na(7, "dark count");
}

}  // namespace

CrdFile read_crd(const std::string& path, const std::function<void(const CrdRange&)>& on_range) {
  RecordReader in(path);
  CrdFile file;
  read_header(in, &file.header);
  std::string system;
  while (in.next() && in.type() != "H8") {
    if (!check_form(in)) in.fail(fmt::format("record {} does not belong here", in.type()));
    ++file.records[in.type()];
    if ((in.type() == "10" && file.header.data_type != 0) || (in.type() == "11" && file.header.data_type != 1))
      in.fail(fmt::format("record {} in data of type {} (H4)", in.type(), file.header.data_type));
    if (in.type() == "10") {
      const CrdRange range = read_range(in, system);
      ++file.ranges;
      if (on_range) on_range(range);
    } else if (in.type() == "C0") {
      in.integer(1, 0, 0, "detail type");
      in.number(2, "transmit wavelength");
      system = in.field(3);
    } else if (in.type() == "C1") {
      read_laser(in, &file.header);
    } else if (in.type() == "C2") {
      read_detector(in, &file.header);
    } else if (in.type() == "12") {
      file.supplements.push_back({second_of_day(in), in.number_or_na(7, "range rate")});
      for (std::size_t i = 3; i < 7; ++i) in.number_or_na(i, "correction");
    } else if (in.type() == "20") {
      second_of_day(in);
      for (std::size_t i = 2; i < 5; ++i) in.number_or_na(i, "weather");
      in.integer(5, 0, 1, "origin of values");
    } else if (in.type() == "40") {
      read_calibration(in);
    } else if (in.type() == "11") {
      file.points.push_back(read_normal_point(in, system));
    } else if (in.type() == "30") {
      file.angles.push_back(read_angles(in));
    } else if (in.type() == "50") {
      file.statistics.push_back(read_statistics(in, system));
    }
  }
  if (in.type() != "H8") in.fail("the file ends without H8 and H9");
  if (!in.next() || in.type() != "H9") in.fail("expected H9 after H8");
  if (in.next()) in.fail("something after H9");
  return file;
}

}  // namespace clray::slr
