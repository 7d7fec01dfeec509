// SPDX-License-Identifier: Apache-2.0
// Frames by ERFA; see frames.hpp. IERS Conventions (2010), chapter 5; TEME by the Greenwich mean sidereal time of 1982
// (Vallado 2013, section 3.7.3).
#include "pass/frames.hpp"

#include <erfa.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

namespace clray::pass {

namespace {

using ephemeris::Epoch;

constexpr double kNode_s = 900.0;
constexpr double kAround_s = 3600.0;
constexpr double kMostNodes = 4000.0;  // of 40 days; they take a quarter of a second

Matrix matrix_of(const double r[3][3]) {
  Matrix m;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m[column][row] = r[row][column];
  }
  return m;
}

/// A day of UT1 in two parts.
ephemeris::TwoPartDate ut1_of(const Epoch& epoch, double ut1_utc_s) {
  return {2400000.5 + static_cast<double>(epoch.mjd), (static_cast<double>(epoch.ps) * 1e-12 + ut1_utc_s) / 86400.0};
}

}  // namespace

EarthFrames::EarthFrames(const Epoch& start, const Epoch& stop, EarthOrientation orientation)
    : zero_(ephemeris::later(start, -kAround_s)), orientation_(std::move(orientation)) {
  const double span = ephemeris::seconds_between(zero_, stop) + kAround_s;
  const double count = std::ceil(span / kNode_s) + 1.0;
  if (count > kMostNodes) return;  // each epoch is then computed by itself
  for (double i = 0.0; i < count; i += 1.0) nodes_.push_back(exact_node(ephemeris::later(zero_, i * kNode_s)));
}

EarthFrames::Node EarthFrames::exact_node(const Epoch& epoch) {
  const ephemeris::TwoPartDate tt = ephemeris::tt_of(epoch);
  Node node;
  double npb[3][3];
  eraPnm06a(tt.day, tt.rest, npb);
  eraBpn2xy(npb, &node.x, &node.y);
  node.s = eraS06(tt.day, tt.rest, node.x, node.y);
  node.tod_of_gcrf = matrix_of(npb);
  return node;
}

EarthFrames::Node EarthFrames::node_at(const Epoch& epoch) const {
  if (nodes_.empty()) return exact_node(epoch);
  const double place = ephemeris::seconds_between(zero_, epoch) / kNode_s;
  const double last = static_cast<double>(nodes_.size() - 2);
  const double low = std::clamp(std::floor(place), 0.0, last), share = place - low;
  const Node &a = nodes_[static_cast<std::size_t>(low)], &b = nodes_[static_cast<std::size_t>(low) + 1];
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.s + share * (b.s - a.s),
          a.tod_of_gcrf + share * (b.tod_of_gcrf - a.tod_of_gcrf)};
}

Matrix EarthFrames::itrf_of_gcrf(const Epoch& epoch) const {
  const Node node = node_at(epoch);
  const EarthAngles earth = orientation_.at(epoch);
  const ephemeris::TwoPartDate ut1 = ut1_of(epoch, earth.ut1_utc_s), tt = ephemeris::tt_of(epoch);
  double c2i[3][3], pole[3][3], c2t[3][3];
  eraC2ixys(node.x, node.y, node.s, c2i);
  eraPom00(earth.pole_x_rad, earth.pole_y_rad, eraSp00(tt.day, tt.rest), pole);
  eraC2tcio(c2i, eraEra00(ut1.day, ut1.rest), pole, c2t);
  return matrix_of(c2t);
}

Matrix EarthFrames::gcrf_of(Frame frame, const Epoch& epoch) const {
  if (frame == Frame::gcrf) return Matrix(1.0);
  if (frame == Frame::itrf) return glm::transpose(itrf_of_gcrf(epoch));
  if (frame == Frame::tod) return glm::transpose(node_at(epoch).tod_of_gcrf);
  const ephemeris::TwoPartDate tt = ephemeris::tt_of(epoch);
  if (frame == Frame::eme2000) {
    double bias[3][3], precession[3][3], both[3][3];
    eraBp06(tt.day, tt.rest, bias, precession, both);
    return glm::transpose(matrix_of(bias));
  }
  const EarthAngles earth = orientation_.at(epoch);
  const ephemeris::TwoPartDate ut1 = ut1_of(epoch, earth.ut1_utc_s);
  double pole[3][3], turn[3][3], itrf_of_teme[3][3];
  eraPom00(earth.pole_x_rad, earth.pole_y_rad, eraSp00(tt.day, tt.rest), pole);
  eraIr(turn);
  eraRz(eraGmst82(ut1.day, ut1.rest), turn);
  eraRxr(pole, turn, itrf_of_teme);
  return glm::transpose(itrf_of_gcrf(epoch)) * matrix_of(itrf_of_teme);
}

}  // namespace clray::pass
