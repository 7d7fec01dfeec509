// SPDX-License-Identifier: Apache-2.0
// CCSDS OEM; see oem.hpp. Kilometres and seconds in the file.
#include "ephemeris/oem.hpp"

#include <fmt/format.h>

#include "ephemeris/kvn.hpp"

namespace clray::ephemeris {

namespace {

constexpr long kLargestDegree = 25;
constexpr std::size_t kDefaultPoints = 4;  // Hermite, degree 7

/// How a block is interpolated.
struct Method {
  bool rates = true;
  std::size_t points = kDefaultPoints;
  std::string text = "Hermite, degree 7";
};

Method method_of(const KvnMeta& meta) {
  if (!meta.has("INTERPOLATION")) return {};
  const std::string name = meta.upper("INTERPOLATION");
  if (name == "LINEAR") return {false, 2, "linear"};
  if (name != "LAGRANGE" && name != "HERMITE") {
    meta.fail("INTERPOLATION", fmt::format("is {}; expected LAGRANGE, HERMITE or LINEAR", meta.text("INTERPOLATION")));
  }
  const long degree = meta.whole("INTERPOLATION_DEGREE", 1, kLargestDegree);
  const bool rates = name == "HERMITE";
  // A Hermite polynomial through n points with their rates is of degree 2 n - 1: that of the file, or the next above.
  const auto points = static_cast<std::size_t>(rates ? (degree + 2) / 2 : degree + 1);
  return {rates, points,
          fmt::format("{}, degree {}", rates ? "Hermite" : "Lagrange", rates ? 2 * points - 1 : points - 1)};
}

/// Rows of a block.
struct Rows {
  std::vector<double> time_s;  // from the trajectory's zero
  std::vector<Vec3> position_m, velocity_m_s;
};

void read_row(KvnReader& in, TimeScale scale, Trajectory* trajectory, Rows* rows) {
  const std::size_t count = in.words().size();
  if (count != 7 && count != 10) {
    in.fail(fmt::format("a row of {} words; expected epoch, x, y, z, vx, vy, vz (and accelerations)", count));
  }
  const Epoch epoch = in.date(in.words()[0], scale, "the epoch");
  if (trajectory->segments.empty() && rows->time_s.empty()) trajectory->zero = epoch;
  const double time = trajectory->since(epoch);
  if (!rows->time_s.empty() && !(time > rows->time_s.back())) {
    in.fail(fmt::format("epoch {} s after the one before; expected increasing epochs", time - rows->time_s.back()));
  }
  rows->time_s.push_back(time);
  const auto vector = [&](std::size_t first, const char* what) {
    return 1000.0 * Vec3(in.number(first, what), in.number(first + 1, what), in.number(first + 2, what));
  };
  rows->position_m.push_back(vector(1, "a coordinate"));
  rows->velocity_m_s.push_back(vector(4, "a velocity"));
  if (count == 10) vector(7, "an acceleration");
}

/// Rows up to the next block; covariances are passed over. Returns whether another block follows.
bool read_rows(KvnReader& in, TimeScale scale, Trajectory* trajectory, Rows* rows) {
  while (in.next()) {
    if (in.key() == "META_START") return true;
    if (in.key() == "COVARIANCE_START") {
      while (in.key() != "COVARIANCE_STOP") {
        if (!in.next()) in.fail("the file ends; expected COVARIANCE_STOP");
      }
    } else if (in.has_value() || !in.key().empty()) {
      in.fail(fmt::format("\"{}\"; expected a state, COVARIANCE_START or META_START", in.key()));
    } else {
      read_row(in, scale, trajectory, rows);
    }
  }
  return false;
}

/// Checks what all blocks must share.
void check_meta(const KvnMeta& meta, Trajectory* trajectory, std::string* id) {
  Frame frame{};
  if (meta.upper("CENTER_NAME") != "EARTH") {
    meta.fail("CENTER_NAME", fmt::format("is {}; expected EARTH", meta.text("CENTER_NAME")));
  }
  if (!frame_of(meta.text("REF_FRAME"), &frame)) {
    meta.fail("REF_FRAME", fmt::format("is {}; expected one of {}", meta.text("REF_FRAME"), kFrames));
  }
  if (meta.has("REF_FRAME_EPOCH") && (frame == Frame::tod || frame == Frame::teme)) {
    meta.fail("REF_FRAME_EPOCH", "fixes a frame of date; expected that of each state's own epoch");
  }
  if (trajectory->segments.empty()) {
    *id = meta.text("OBJECT_ID");
    trajectory->frame = frame;
    return;
  }
  if (frame != trajectory->frame) meta.fail("REF_FRAME", "differs from that of the blocks before");
  if (meta.text("OBJECT_ID") != *id)
    meta.fail("OBJECT_ID", fmt::format("differs from {} before; expected one object", *id));
}

}  // namespace

Trajectory read_oem(const std::string& path) {
  KvnReader in(path);
  in.header("CCSDS_OEM_VERS", 3, {"CREATION_DATE", "ORIGINATOR", "CLASSIFICATION", "MESSAGE_ID"});
  Trajectory trajectory;
  trajectory.path = path;
  std::string id;
  for (bool more = true; more;) {
    const KvnMeta meta(
        in, {"OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "REF_FRAME_EPOCH", "TIME_SYSTEM", "START_TIME",
             "STOP_TIME", "USEABLE_START_TIME", "USEABLE_STOP_TIME", "INTERPOLATION", "INTERPOLATION_DEGREE"});
    check_meta(meta, &trajectory, &id);
    trajectory.object = meta.text("OBJECT_NAME");
    const Method method = method_of(meta);
    Rows rows;
    more = read_rows(in, meta.scale(), &trajectory, &rows);
    if (rows.time_s.size() < 2) in.fail(fmt::format("a block of {} states; expected at least 2", rows.time_s.size()));
    const auto [start, stop] = usable_span(meta, trajectory.zero, rows.time_s.front(), rows.time_s.back());
    if (!trajectory.segments.empty() && !(start >= trajectory.segments.back().start_s)) {
      meta.fail("START_TIME", "lies before that of the block before");
    }
    if (trajectory.segments.empty()) trajectory.method = method.text;
    trajectory.segments.push_back(
        {start, stop,
         Interpolation(std::move(rows.time_s), std::move(rows.position_m),
                       method.rates ? std::move(rows.velocity_m_s) : std::vector<Vec3>(), method.points)});
  }
  return trajectory;
}

}  // namespace clray::ephemeris
