// SPDX-License-Identifier: Apache-2.0
// See normal_point_file.hpp. Angles are geometric, Earth-fixed, to where the pulse meets the body; their rates are
// central differences.
#include "slr/normal_point_file.hpp"

#include <cmath>

#include "clray/constants.hpp"

namespace clray::slr {

namespace {

constexpr double kDegree = constants::kPi / 180.0;
constexpr double kHalfStep_s = 0.05;  // of the difference

/// The way from one azimuth to another, the short way round.
double turn_rad(double from, double to) {
  return std::remainder(to - from, 2.0 * constants::kPi);
}

}  // namespace

std::optional<CrdAngles> angles_at(const Session& session, std::uint64_t shot) {
  if (session.ranges().target() == nullptr) return std::nullopt;
  const double since = session.since_s(shot);
  const double from = std::max(0.0, since - kHalfStep_s), to = std::min(session.last_since_s(), since + kHalfStep_s);
  const Sight here = session.ranges().sight(session.time(shot));
  CrdAngles angles;
  angles.epoch_ps = session.ranges().epoch(session.time(shot)).ps;
  angles.azimuth_deg = here.azimuth_rad / kDegree;
  angles.elevation_deg = here.elevation_rad / kDegree;
  if (to > from) {
    const Sight before = session.ranges().sight(session.at(from)), after = session.ranges().sight(session.at(to));
    angles.azimuth_rate_deg_s = turn_rad(before.azimuth_rad, after.azimuth_rad) / kDegree / (to - from);
    angles.elevation_rate_deg_s = (after.elevation_rad - before.elevation_rad) / kDegree / (to - from);
  }
  return angles;
}

CrdStatistics crd_statistics(const ResidualStatistics& s) {
  return {s.rms_ps, s.skewness, s.kurtosis};
}

void write_normal_points(const std::string& path, CrdHeader header, const CrdSupplement& supplement,
                         const Session& session, const Station& station, const NormalPoints& points) {
  header.data_type = 1;
  CrdWriter crd(path, header, supplement);
  for (const NormalPoint& point : points.points) {
    if (const auto angles = angles_at(session, point.shot)) crd.angles(*angles);
    const double fired = station.rate_Hz * station.normal_point_s;
    crd.normal_point({point.epoch.ps, point.flight_ps, station.normal_point_s, point.bin.count,
                      crd_statistics(point.bin), 100.0 * static_cast<double>(point.bin.count) / fired});
  }
  crd.statistics(crd_statistics(points.session));
  crd.close();
}

}  // namespace clray::slr
