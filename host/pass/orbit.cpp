// SPDX-License-Identifier: Apache-2.0
// The orbit's file and frames; see orbit.hpp.
#include "pass/orbit.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "clray/error.hpp"
#include "ephemeris/cpf.hpp"
#include "ephemeris/oem.hpp"
#include "scene/file/scene_csv.hpp"
#include "text/input_file.hpp"

namespace clray::pass {

namespace {

using ephemeris::Motion3;
using ephemeris::Trajectory;

constexpr std::size_t kLagrangePoints = 10, kHermitePoints = 4;  // of a table of states

/// The first word of a file, in capitals.
std::string first_word(const std::string& path) {
  const text::InputFile file = text::open_input(path);
  std::string word;
  for (int c; word.size() < 16 && (c = std::fgetc(file.get())) != EOF;) {
    const bool end = std::isspace(c) != 0 || c == '=' || c == ',';
    if (end && !word.empty()) break;
    if (!end) word += static_cast<char>(std::toupper(c));
  }
  if (word.compare(0, 3, "\xEF\xBB\xBF") == 0) word.erase(0, 3);
  return word;
}

Trajectory read_states(const Pass& pass) {
  CsvColumn time{{"time", "t"}, "s"};
  time.dated = true;
  std::vector<CsvColumn> columns{time};
  for (const char* name : {"x", "y", "z"}) columns.push_back({{name}, "m"});
  for (const char* name : {"vx", "vy", "vz"}) {
    columns.push_back({{name}, "m_s"});
    columns.back().optional = true;
  }
  const CsvTable table = read_csv(pass.ephemeris, columns, CsvHeader::required);
  std::vector<double> times = read_times(table, pass.start);
  std::vector<Vec3> positions, velocities;
  bool rates = true, some = false;
  for (const std::vector<double>& row : table.rows) {
    positions.push_back({row[1], row[2], row[3]});
    velocities.push_back({row[4], row[5], row[6]});
    for (int i = 4; i < 7; ++i) {
      rates = rates && !std::isnan(row[static_cast<std::size_t>(i)]);
      some = some || !std::isnan(row[static_cast<std::size_t>(i)]);
    }
  }
  if (some && !rates) throw Error(ErrorCode::input, "expected vx, vy and vz, or none of them", pass.ephemeris);
  if (times.size() < 2) throw Error(ErrorCode::input, "one state; expected at least 2", pass.ephemeris);
  Trajectory t;
  t.path = pass.ephemeris;
  t.frame = pass.frame;
  t.zero = pass.start;
  t.method = rates ? "Hermite, degree 7" : "Lagrange, degree 9";
  const double first = times.front(), last = times.back();
  t.segments.push_back({first, last,
                        ephemeris::Interpolation(std::move(times), std::move(positions),
                                                 rates ? std::move(velocities) : std::vector<Vec3>(),
                                                 rates ? kHermitePoints : kLagrangePoints)});
  return t;
}

EarthOrientation orientation_of(const Pass& pass) {
  return pass.eop.empty() ? EarthOrientation() : EarthOrientation(pass.eop);
}

}  // namespace

Trajectory read_orbit(const Pass& pass) {
  const std::string word = first_word(pass.ephemeris);
  if (word == "H1") return ephemeris::read_cpf(pass.ephemeris);
  if (word == "CCSDS_OEM_VERS") return ephemeris::read_oem(pass.ephemeris);
  if (word.compare(0, 6, "CCSDS_") == 0 || word.compare(0, 5, "<?XML") == 0) {
    throw Error(ErrorCode::input,
                "is no orbit that clray reads; expected a CPF, an OEM in keyword = value notation, or a "
                "CSV table of states",
                pass.ephemeris);
  }
  return read_states(pass);
}

Orbit::Orbit(const Pass& pass)
    : start_(pass.start),
      trajectory_(read_orbit(pass)),
      offset_s_(trajectory_.since(pass.start)),
      frames_(ephemeris::later(pass.start, pass.times_s.empty() ? 0.0 : std::min(0.0, pass.times_s.front())),
              ephemeris::later(pass.start, pass.stop_s), orientation_of(pass)) {}

Motion3 Orbit::at(double time_s) const {
  const Motion3 own = trajectory_.at(in_file_s(time_s));
  if (trajectory_.frame == Frame::gcrf) return own;
  const Matrix turn = frames_.gcrf_of(trajectory_.frame, epoch(time_s));
  Motion3 motion{turn * own.value, turn * own.rate};
  if (trajectory_.frame == Frame::itrf) {
    // The Earth's own turning, about its axis of date (the third row of the matrix to the Earth's frame).
    motion.rate += glm::cross(EarthFrames::kEarthRate_rad_s * turn[2], motion.value);
  }
  return motion;
}

Vec3 Orbit::earth_fixed(double time_s) const {
  constexpr double kLight_s = 3.0;
  const Vec3 own = trajectory_.at(in_file_s(time_s), kLight_s).value;
  if (trajectory_.frame == Frame::itrf) return own;
  const Epoch e = epoch(time_s);
  return frames_.itrf_of_gcrf(e) * (frames_.gcrf_of(trajectory_.frame, e) * own);
}

}  // namespace clray::pass
