// SPDX-License-Identifier: Apache-2.0
// CPF predictions; see cpf.hpp.
#include "ephemeris/cpf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ephemeris/record_text.hpp"

namespace clray::ephemeris {

namespace {

constexpr std::size_t kPoints = 10;  // of a polynomial of the 9th order
constexpr std::size_t kNoLimit = std::string::npos;
constexpr double kStepTolerance_s = 1e-6;

bool same_word(std::string_view text, const char* word) {
  std::string upper;
  for (const char c : text) upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return upper == word;
}

void read_h1(RecordReader& in, Prediction* p) {
  in.expect_fields(3, kNoLimit);
  if (!same_word(in.field(1), "CPF")) in.fail(fmt::format("\"{}\"; expected CPF", in.field(1)));
  p->version = static_cast<int>(in.integer(2, 1, 99, "format version"));
  if (p->version > 2) in.fail(fmt::format("format version {}; expected 1 or 2", p->version));
  in.expect_fields(p->version == 1 ? 10 : 11, kNoLimit);  // notes may be several words
  p->source = in.field(3);
  p->year = static_cast<int>(in.integer(4, 1950, 2100, "year"));
  p->month = static_cast<int>(in.integer(5, 1, 12, "month"));
  p->day = static_cast<int>(in.integer(6, 1, 31, "day"));
  p->hour = static_cast<int>(in.integer(7, 0, 24, "hour"));
  if (p->version == 1) {
    p->sequence = in.integer(8, 0, 9999, "sequence number of version 1");
    p->target = in.field(9);
  } else {
    p->sequence = in.integer(8, 0, 999, "sequence number of version 2");
    p->sub_daily = in.integer(9, 0, 99, "sub-daily sequence number of version 2");
    p->target = in.field(10);
  }
}

std::string identifier(RecordReader& in, std::size_t i, const char* what) {
  in.integer_or_na(i, -1, 999999999, 0, what);
  return std::string(in.field(i));
}

void read_h2(RecordReader& in, Prediction* p, Frame* frame) {
  const std::size_t least = p->version == 1 ? 22 : 23;  // version 2 adds the target's location
  if (in.count() < least || in.count() > 23) {
    in.fail(fmt::format("record H2 has {} fields; version {} has {}", in.count(), p->version, least));
  }
  p->cospar = identifier(in, 1, "COSPAR id");
  p->sic = identifier(in, 2, "SIC");
  p->norad = identifier(in, 3, "NORAD id");
  for (const std::size_t at : {std::size_t{4}, std::size_t{10}}) {
    std::int64_t mjd = 0;
    const auto year = static_cast<int>(in.integer(at, 1950, 2100, "year"));
    const auto month = static_cast<int>(in.integer(at + 1, 1, 12, "month"));
    if (!mjd_of(year, month, static_cast<int>(in.integer(at + 2, 1, 31, "day")), &mjd)) in.fail("no such date");
    in.integer(at + 3, 0, 24, "hour");
    in.integer(at + 4, 0, 59, "minute");
    in.integer(at + 5, 0, 60, "second");
  }
  p->step_s = static_cast<double>(in.integer(16, 0, 99999, "time between table entries"));
  p->target_class = in.integer_or_na(18, 0, 9, 0, "target class");
  constexpr Frame kFrames[] = {Frame::itrf, Frame::tod, Frame::eme2000};
  *frame = kFrames[in.integer(19, 0, 2, "reference frame")];
  if (in.count() > 22) p->target_location = in.integer_or_na(22, 0, 99, 1, "target location");
}

/// Rows of records 10.
struct Rows {
  Epoch first;
  std::vector<double> time_s;  // from `first`
  std::vector<Vec3> position_m;
};

void read_position(RecordReader& in, const Prediction& p, Rows* rows) {
  in.expect_fields(8, 8);
  if (in.integer(1, 0, 2, "direction flag") != 0) {
    in.fail("direction flag is not 0; expected positions at a common epoch");
  }
  const auto mjd = static_cast<std::int64_t>(in.integer(2, 0, 200000, "MJD"));
  const double seconds = in.number(3, "seconds of day");
  if (!(seconds >= 0.0 && seconds < 86401.0)) in.fail("seconds of day; expected a number in [0,86400)");
  const Epoch epoch{mjd, std::llround(seconds * 1e12)};
  if (rows->time_s.empty()) rows->first = epoch;
  double time = seconds_between(rows->first, epoch);
  // Behind a leap second a flagged record keeps the time of before it.
  if (in.integer(4, -99, 99, "leap second flag") != 0)
    time -= static_cast<double>(leap_seconds(mjd) - leap_seconds(rows->first.mjd));
  if (!rows->time_s.empty()) {
    const double step = time - rows->time_s.back();
    if (!(step > 0.0)) in.fail(fmt::format("epoch {} s after the one before; expected increasing epochs", step));
    if (p.step_s > 0.0 && std::fabs(step - p.step_s) > kStepTolerance_s) {
      in.fail(fmt::format("epoch {} s after the one before; the header says {} s: a gap", step, p.step_s));
    }
  }
  rows->time_s.push_back(time);
  rows->position_m.push_back({in.number(5, "X"), in.number(6, "Y"), in.number(7, "Z")});
}

/// Header records in their order; returns at H9.
void read_header(RecordReader& in, Prediction* p, Frame* frame) {
  const auto demand = [&](const char* type) {
    if (!in.next()) in.fail(fmt::format("the file ends; expected record {}", type));
    if (in.type() != type) in.fail(fmt::format("record {}; expected {}", in.type(), type));
  };
  demand("H1");
  read_h1(in, p);
  demand("H2");
  read_h2(in, p, frame);
  while (in.next()) {
    if (in.type() == "H9") return;
    if (in.type() != "H3" && in.type() != "H4" && in.type() != "H5" && in.type() != "00") {
      in.fail(fmt::format("record {}; expected H9", in.type()));
    }
  }
  in.fail("the file ends; expected record H9");
}

bool is_other_record(const std::string& type) {
  static const char* const kOthers[] = {"00", "20", "30", "40", "50", "60", "70"};
  return std::any_of(std::begin(kOthers), std::end(kOthers), [&](const char* known) { return type == known; });
}

}  // namespace

Trajectory read_cpf(const std::string& path) {
  RecordReader in(path);
  in.allow_blank_lines();
  auto header = std::make_shared<Prediction>();
  Trajectory trajectory;
  read_header(in, header.get(), &trajectory.frame);
  Rows rows;
  bool ended = false;
  while (in.next()) {
    if (ended) in.fail("something after record 99");
    if (in.type() == "10") {
      read_position(in, *header, &rows);
    } else if (in.type() == "99") {
      ended = true;
    } else if (!is_other_record(in.type())) {
      in.fail(fmt::format("unknown record {}", in.type()));
    }
  }
  if (!ended) in.fail("the file ends without record 99");
  if (rows.time_s.size() < kPoints) {
    in.fail(fmt::format("{} positions (records 10); expected at least {}", rows.time_s.size(), kPoints));
  }
  trajectory.path = path;
  trajectory.object = header->target;
  trajectory.zero = rows.first;
  trajectory.method = "Lagrange, degree 9";
  trajectory.prediction = std::move(header);
  const double last = rows.time_s.back();
  trajectory.segments.push_back(
      {0.0, last, Interpolation(std::move(rows.time_s), std::move(rows.position_m), {}, kPoints)});
  return trajectory;
}

}  // namespace clray::ephemeris
