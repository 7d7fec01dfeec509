// SPDX-License-Identifier: Apache-2.0
// CCSDS AEM; see aem.hpp. A file's quaternion or Euler sequence takes the axes of one frame to those of another (a
// transformation of frames); as a Hamilton quaternion it takes vectors of the second frame to the first.
#include "ephemeris/aem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <tuple>

#include "clray/constants.hpp"
#include "ephemeris/kvn.hpp"

namespace clray::ephemeris {

namespace {

constexpr double kRadian = constants::kPi / 180.0;
constexpr long kLargestDegree = 15;

/// What the metadata of a block say of its rows.
struct Rows {
  enum class Kind { quaternion, euler, spin };
  Kind kind = Kind::quaternion;
  std::size_t columns = 4;    ///< numbers behind the epoch
  bool scalar_first = false;  ///< of a quaternion
  int axes[3] = {0, 0, 0};    ///< of an Euler sequence: 0 x, 1 y, 2 z
  bool from_body = false;     ///< the transformation leads from the body to the other frame
  TimeScale scale = TimeScale::utc;
};

bool is_body(const std::string& name) {
  return name.compare(0, 7, "SC_BODY") == 0 || name.compare(0, 7, "SC BODY") == 0;
}

/// Fills in which of the two frames is the body's, and the other one.
void read_frames(const KvnMeta& meta, int version, AttitudeTable* table, Rows* rows) {
  const std::string a = meta.upper("REF_FRAME_A"), b = meta.upper("REF_FRAME_B");
  if (is_body(a) == is_body(b)) {
    meta.fail("REF_FRAME_B",
              fmt::format("is {} and REF_FRAME_A {}; expected the body (SC_BODY_1 …) as one of them", b, a));
  }
  const std::string other_key = is_body(a) ? "REF_FRAME_B" : "REF_FRAME_A";
  const std::string other = is_body(a) ? b : a;
  Frame frame = Frame::gcrf;
  const bool orbital = other == "LVLH" || other == "LVLH_ROTATING";
  if (!orbital && !frame_of(other, &frame)) {
    meta.fail(other_key, fmt::format("is {}; expected one of {}, LVLH", other, kFrames));
  }
  if (!table->segments.empty() && (orbital != table->orbital || frame != table->frame)) {
    meta.fail(other_key, "differs from that of the blocks before");
  }
  table->orbital = orbital;
  table->frame = frame;
  std::string direction = "A2B";
  if (version == 1 || meta.has("ATTITUDE_DIR")) direction = meta.upper("ATTITUDE_DIR");
  if (direction != "A2B" && direction != "B2A") {
    meta.fail("ATTITUDE_DIR", fmt::format("is {}; expected A2B or B2A", direction));
  }
  rows->from_body = is_body(a) == (direction == "A2B");
}

void read_sequence(const KvnMeta& meta, Rows* rows) {
  const std::string sequence = meta.upper("EULER_ROT_SEQ");
  bool good = sequence.size() == 3;
  for (std::size_t i = 0; good && i < 3; ++i) {
    const std::size_t digit = std::string("123").find(sequence[i]), letter = std::string("XYZ").find(sequence[i]);
    good = digit < 3 || letter < 3;
    rows->axes[i] = static_cast<int>(digit < 3 ? digit : letter);
  }
  if (!good || rows->axes[0] == rows->axes[1] || rows->axes[1] == rows->axes[2]) {
    meta.fail("EULER_ROT_SEQ", fmt::format("is {}; expected three axes such as 321 or ZXZ", sequence));
  }
}

Rows rows_of(const KvnMeta& meta, int version, AttitudeTable* table) {
  static constexpr struct {
    const char* name;
    Rows::Kind kind;
    std::size_t columns;
  } kTypes[] = {{"QUATERNION", Rows::Kind::quaternion, 4},
                {"QUATERNION/DERIVATIVE", Rows::Kind::quaternion, 8},
                {"QUATERNION/RATE", Rows::Kind::quaternion, 7},
                {"QUATERNION/ANGVEL", Rows::Kind::quaternion, 7},
                {"EULER_ANGLE", Rows::Kind::euler, 3},
                {"EULER_ANGLE/RATE", Rows::Kind::euler, 6},
                {"EULER_ANGLE/DERIVATIVE", Rows::Kind::euler, 6},
                {"EULER_ANGLE/ANGVEL", Rows::Kind::euler, 6},
                {"SPIN", Rows::Kind::spin, 4}};
  Rows rows;
  rows.columns = 0;
  for (const auto& type : kTypes) {
    if (meta.upper("ATTITUDE_TYPE") != type.name) continue;
    rows.kind = type.kind;
    rows.columns = type.columns;
  }
  if (rows.columns == 0) {
    meta.fail("ATTITUDE_TYPE",
              fmt::format("is {}; expected QUATERNION, EULER_ANGLE (each with or without rates) or SPIN",
                          meta.text("ATTITUDE_TYPE")));
  }
  rows.scale = meta.scale();
  read_frames(meta, version, table, &rows);
  if (rows.kind == Rows::Kind::euler) read_sequence(meta, &rows);
  if (rows.kind == Rows::Kind::quaternion && (version == 1 || meta.has("QUATERNION_TYPE"))) {
    const std::string type = meta.upper("QUATERNION_TYPE");
    if (type != "FIRST" && type != "LAST")
      meta.fail("QUATERNION_TYPE", fmt::format("is {}; expected FIRST or LAST", type));
    rows.scalar_first = type == "FIRST";
  }
  if (rows.kind == Rows::Kind::spin && rows.from_body) {
    meta.fail("ATTITUDE_TYPE", "is SPIN from the body's frame; expected a spin axis in the other frame");
  }
  return rows;
}

/// Body to the other frame.
Quaternion attitude_of(KvnReader& in, const Rows& rows) {
  double v[4] = {0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < std::min<std::size_t>(rows.columns, 4); ++i) v[i] = in.number(i + 1, "a component");
  Quaternion q;
  if (rows.kind == Rows::Kind::quaternion) {
    q = rows.scalar_first ? Quaternion(v[0], v[1], v[2], v[3]) : Quaternion(v[3], v[0], v[1], v[2]);
    const double length = glm::length(q);
    if (!(std::fabs(length - 1.0) <= 1e-3)) in.fail(fmt::format("a quaternion of length {}; expected 1", length));
    q = glm::normalize(q);
  } else {
    q = Quaternion(1.0, 0.0, 0.0, 0.0);
    for (int i = 0; i < 3; ++i) {
      Vec3 axis(0.0);
      axis[rows.axes[i]] = 1.0;
      q = q * turn_about(axis, v[i] * kRadian);
    }
  }
  return rows.from_body ? glm::conjugate(q) : q;
}

/// A spin's row: the angle goes on from the row before by its rate.
void add_spin(KvnReader& in, double time_s, AttitudeSegment* segment, double* rate) {
  Vec3 spin(in.number(1, "SPIN_ALPHA") * kRadian, in.number(2, "SPIN_DELTA") * kRadian,
            in.number(3, "SPIN_ANGLE") * kRadian);
  const double next_rate = in.number(4, "SPIN_ANGLE_VEL") * kRadian;
  if (!segment->spin.empty()) {
    constexpr double kTurn = 2.0 * constants::kPi;
    const Vec3& before = segment->spin.back();
    const double expected = before.z + 0.5 * (*rate + next_rate) * (time_s - segment->time_s.back());
    spin.z += kTurn * std::round((expected - spin.z) / kTurn);
    spin.x += kTurn * std::round((before.x - spin.x) / kTurn);
  }
  *rate = next_rate;
  segment->spin.push_back(spin);
}

AttitudeSegment read_rows(KvnReader& in, const Rows& rows, AttitudeTable* table) {
  AttitudeSegment segment;
  double rate = 0.0;
  if (!in.next() || in.key() != "DATA_START") in.fail("expected DATA_START behind META_STOP");
  while (in.next()) {
    if (in.key() == "DATA_STOP") return segment;
    if (in.has_value() || !in.key().empty())
      in.fail(fmt::format("\"{}\"; expected an attitude or DATA_STOP", in.key()));
    if (in.words().size() != rows.columns + 1) {
      in.fail(fmt::format("a row of {} words; expected epoch and {} numbers", in.words().size(), rows.columns));
    }
    for (std::size_t i = 1; i <= rows.columns; ++i) in.number(i, "a component");
    const Epoch epoch = in.date(in.words()[0], rows.scale, "the epoch");
    if (table->segments.empty() && segment.time_s.empty()) table->zero = epoch;
    const double time = table->since(epoch);
    if (!segment.time_s.empty() && !(time > segment.time_s.back())) {
      in.fail(fmt::format("epoch {} s after the one before; expected increasing epochs", time - segment.time_s.back()));
    }
    if (rows.kind == Rows::Kind::spin) {
      add_spin(in, time, &segment, &rate);
    } else {
      segment.attitude.push_back(attitude_of(in, rows));
    }
    segment.time_s.push_back(time);
  }
  in.fail("the file ends; expected DATA_STOP");
}

}  // namespace

AttitudeTable read_aem(const std::string& path) {
  KvnReader in(path);
  const int version = in.header("CCSDS_AEM_VERS", 2, {"CREATION_DATE", "ORIGINATOR", "CLASSIFICATION", "MESSAGE_ID"});
  AttitudeTable table;
  table.path = path;
  for (bool more = true; more;) {
    const KvnMeta meta(
        in, {"OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME_A", "REF_FRAME_B", "ATTITUDE_DIR", "TIME_SYSTEM",
             "START_TIME", "STOP_TIME", "USEABLE_START_TIME", "USEABLE_STOP_TIME", "ATTITUDE_TYPE", "QUATERNION_TYPE",
             "EULER_ROT_SEQ", "RATE_FRAME", "ANGVEL_FRAME", "INTERPOLATION_METHOD", "INTERPOLATION_DEGREE"});
    const Rows rows = rows_of(meta, version, &table);
    AttitudeSegment segment = read_rows(in, rows, &table);
    if (segment.time_s.empty()) in.fail("a block without attitudes");
    if (meta.has("INTERPOLATION_METHOD") && meta.upper("INTERPOLATION_METHOD") != "LINEAR")
      segment.points = static_cast<std::size_t>(meta.whole("INTERPOLATION_DEGREE", 1, kLargestDegree)) + 1;
    std::tie(segment.start_s, segment.stop_s) =
        usable_span(meta, table.zero, segment.time_s.front(), segment.time_s.back());
    table.object = meta.text("OBJECT_NAME");
    table.segments.push_back(std::move(segment));
    more = in.next();
    if (more && in.key() != "META_START") in.fail(fmt::format("\"{}\"; expected META_START", in.words().front()));
  }
  return table;
}

}  // namespace clray::ephemeris
