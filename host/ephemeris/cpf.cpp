// SPDX-License-Identifier: Apache-2.0
// CPF v2 predictions; see cpf.hpp.
#include "ephemeris/cpf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "ephemeris/record_text.hpp"

namespace clray::ephemeris {

namespace {

constexpr std::size_t kPoints = 10;  // of a polynomial of the 9th order
constexpr std::size_t kNoLimit = std::string::npos;
constexpr double kStepTolerance_s = 1e-6;

void read_h1(RecordReader& in, Prediction* p) {
  in.expect_fields(3, kNoLimit);
  if (in.field(1) != "CPF" && in.field(1) != "cpf") in.fail(fmt::format("\"{}\"; expected CPF", in.field(1)));
  p->version = static_cast<int>(in.integer(2, 1, 99, "format version"));
  if (p->version != 2) in.fail(fmt::format("format version {}; expected 2", p->version));
  in.expect_fields(11, kNoLimit);  // notes may be several words
  p->source = in.field(3);
  p->year = static_cast<int>(in.integer(4, 1950, 2100, "year"));
  p->month = static_cast<int>(in.integer(5, 1, 12, "month"));
  p->day = static_cast<int>(in.integer(6, 1, 31, "day"));
  p->hour = static_cast<int>(in.integer(7, 0, 23, "hour"));
  p->sequence = in.integer(8, 0, 999, "sequence number");
  p->sub_daily = in.integer(9, 0, 99, "sub-daily sequence number");
  p->target = in.field(10);
}

std::string identifier(RecordReader& in, std::size_t i, const char* what) {
  in.integer_or_na(i, 0, 999999999, 0, what);
  return std::string(in.field(i));
}

void read_h2(RecordReader& in, Prediction* p) {
  in.expect_fields(23, 23);
  p->cospar = identifier(in, 1, "COSPAR id");
  p->sic = identifier(in, 2, "SIC");
  p->norad = identifier(in, 3, "NORAD id");
  for (const std::size_t at : {std::size_t{4}, std::size_t{10}}) {
    std::int64_t mjd = 0;
    const auto year = static_cast<int>(in.integer(at, 1950, 2100, "year"));
    const auto month = static_cast<int>(in.integer(at + 1, 1, 12, "month"));
    if (!mjd_of(year, month, static_cast<int>(in.integer(at + 2, 1, 31, "day")), &mjd)) in.fail("no such date");
    in.integer(at + 3, 0, 23, "hour");
    in.integer(at + 4, 0, 59, "minute");
    in.integer(at + 5, 0, 59, "second");
  }
  p->step_s = static_cast<double>(in.integer(16, 0, 99999, "time between table entries"));
  in.integer(17, 0, 1, "compatibility with TIVs");
  p->target_class = in.integer(18, 0, 9, "target class");
  if (in.integer(19, 0, 9, "reference frame") != 0) in.fail("reference frame is not 0; expected Earth-fixed positions");
  in.integer(20, 0, 9, "rotational angle type");
  in.integer(21, 0, 1, "centre of mass correction");
  p->target_location = in.integer(22, 0, 99, "target location");
}

void read_position(RecordReader& in, Prediction* p) {
  in.expect_fields(8, 8);
  if (in.integer(1, 0, 2, "direction flag") != 0) {
    in.fail("direction flag is not 0; expected positions at a common epoch");
  }
  const auto mjd = static_cast<std::int64_t>(in.integer(2, 0, 200000, "MJD"));
  const double seconds = in.number(3, "seconds of day");
  if (!(seconds >= 0.0 && seconds < 86400.0)) in.fail("seconds of day; expected a number in [0,86400)");
  if (in.integer(4, -99, 99, "leap second flag") != 0)
    in.fail("a leap second; predictions across one are not supported");
  const Epoch epoch = epoch_of(mjd, seconds);
  if (p->time_s.empty()) p->first = epoch;
  const double time = seconds_between(p->first, epoch);
  if (!p->time_s.empty()) {
    const double step = time - p->time_s.back();
    if (!(step > 0.0)) in.fail(fmt::format("epoch {} s after the one before; expected increasing epochs", step));
    if (p->step_s > 0.0 && std::fabs(step - p->step_s) > kStepTolerance_s) {
      in.fail(fmt::format("epoch {} s after the one before; the header says {} s: a gap", step, p->step_s));
    }
  }
  p->time_s.push_back(time);
  p->position_m.push_back({in.number(5, "X"), in.number(6, "Y"), in.number(7, "Z")});
}

/// Header records in their order; returns at H9.
void read_header(RecordReader& in, Prediction* p) {
  const auto demand = [&](const char* type) {
    if (!in.next()) in.fail(fmt::format("the file ends; expected record {}", type));
    if (in.type() != type) in.fail(fmt::format("record {}; expected {}", in.type(), type));
  };
  demand("H1");
  read_h1(in, p);
  demand("H2");
  read_h2(in, p);
  while (in.next()) {
    if (in.type() == "H9") return;
    if (in.type() != "H3" && in.type() != "H4" && in.type() != "H5" && in.type() != "00") {
      in.fail(fmt::format("record {}; expected H9", in.type()));
    }
  }
  in.fail("the file ends; expected record H9");
}

void prepare(Prediction* p) {
  for (std::size_t first = 0; first + kPoints <= p->time_s.size(); ++first) {
    std::array<double, kPoints> inverse{};
    for (std::size_t i = 0; i < kPoints; ++i) {
      double product = 1.0;
      for (std::size_t j = 0; j < kPoints; ++j) {
        if (j != i) product *= p->time_s[first + i] - p->time_s[first + j];
      }
      inverse[i] = 1.0 / product;
    }
    p->inverse_products.push_back(inverse);
  }
}

bool is_other_record(const std::string& type) {
  static const char* const kOthers[] = {"00", "20", "30", "40", "50", "60", "70"};
  return std::any_of(std::begin(kOthers), std::end(kOthers), [&](const char* known) { return type == known; });
}

}  // namespace

Prediction read_cpf(const std::string& path) {
  RecordReader in(path);
  Prediction p;
  p.path = path;
  read_header(in, &p);
  bool ended = false;
  while (in.next()) {
    if (ended) in.fail("something after record 99");
    if (in.type() == "10") {
      read_position(in, &p);
    } else if (in.type() == "99") {
      ended = true;
    } else if (!is_other_record(in.type())) {
      in.fail(fmt::format("unknown record {}", in.type()));
    }
  }
  if (!ended) in.fail("the file ends without record 99");
  if (p.time_s.size() < kPoints) {
    in.fail(fmt::format("{} positions (records 10); expected at least {}", p.time_s.size(), kPoints));
  }
  prepare(&p);
  return p;
}

Vec3 position_at(const Prediction& p, double time_s) {
  if (!(time_s >= p.time_s.front() && time_s <= p.time_s.back())) {
    throw Error(ErrorCode::input,
                fmt::format("the epoch {:.6f} s after the first position is outside the prediction (0 to {:.6f} s)",
                            time_s, p.time_s.back()),
                p.path);
  }
  const auto after =
      static_cast<std::size_t>(std::upper_bound(p.time_s.begin(), p.time_s.end(), time_s) - p.time_s.begin());
  const std::size_t half = kPoints / 2;
  const std::size_t first = std::min(after > half ? after - half : 0, p.time_s.size() - kPoints);
  // Products of the differences on the left and right of each point.
  double left[kPoints], right[kPoints];
  left[0] = right[kPoints - 1] = 1.0;
  for (std::size_t i = 1; i < kPoints; ++i) {
    left[i] = left[i - 1] * (time_s - p.time_s[first + i - 1]);
    right[kPoints - 1 - i] = right[kPoints - i] * (time_s - p.time_s[first + kPoints - i]);
  }
  Vec3 position(0.0);
  for (std::size_t i = 0; i < kPoints; ++i) {
    position += (left[i] * right[i] * p.inverse_products[first][i]) * p.position_m[first + i];
  }
  return position;
}

double distance_at(const Prediction& p, const Vec3& station_m, double time_s) {
  double distance = glm::length(position_at(p, time_s) - station_m);
  // Each round reduces the error of the light time by v/c < 3e-5, so four rounds leave none.
  for (int round = 0; round < 4; ++round) {
    const double next = glm::length(position_at(p, time_s + distance / constants::kLightSpeed_m_s) - station_m);
    if (next == distance) break;
    distance = next;
  }
  return distance;
}

}  // namespace clray::ephemeris
