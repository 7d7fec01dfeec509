// SPDX-License-Identifier: Apache-2.0
// The keys of scene files, over all rows of keys.def: ends of ranges, misspelt keys, scenes filled by hand, --check,
// listings and docs/scene-file.md. A new row is tested with no new test code.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "clray/keys.hpp"
#include "scene/file/key_member.hpp"
#include "scene/file/keys.hpp"
#include "unit/scene_files.hpp"

using namespace clray;
using clray::test::SceneFolder;

namespace {

const std::string kBall = "component = [{ shape = \"sphere\" }]\n";

/// A section with `key = value`, and before it what makes the section have the key.
std::string section_with(const KeyRow& row, const std::string& value) {
  std::string text = kBall;
  if (row.section == "motion" && row.way == "spin") {
    text += "[motion]\n";
    for (const KeyRow& other : key_rows("motion")) {
      if (!other.required || other.key.name == row.key.name) continue;
      text += other.key.name + (other.kind == KeyKind::direction ? " = [0, 0, 1]\n" : " = 90\n");
    }
  } else {
    text += "[" + row.section + "]\n";
    if (row.way == "sun") text += "kind = \"sun\"\n";
    if (row.way == "table") text += "attitudes = \"att.csv\"\n";
  }
  return text + row.key.name + " = " + value + "\n";
}

/// Every row with a range of numbers.
std::vector<KeyRow> number_rows() {
  std::vector<KeyRow> rows;
  for (const std::string& section : key_sections()) {
    for (const KeyRow& row : key_rows(section)) {
      if (row.kind == KeyKind::number || row.kind == KeyKind::whole) rows.push_back(row);
    }
  }
  return rows;
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string check_of(const Scene& scene) {
  try {
    check_scene(scene);
  } catch (const Error& e) {
    return e.what();
  }
  return "fine";
}

}  // namespace

TEST_CASE("keys: the ends of a range are taken or refused as the row says, in a file and by key_fault") {
  const SceneFolder f;
  REQUIRE(number_rows().size() > 30);
  for (const KeyRow& row : number_rows()) {
    const bool whole = row.kind == KeyKind::whole;
    const TableKey& key = row.key;
    struct End {
      double value;
      bool taken;
    };
    std::vector<End> ends;
    if (std::isfinite(key.low)) ends.push_back({key.low, key.low_included});
    if (std::isfinite(key.low)) ends.push_back({whole ? key.low - 1 : std::nextafter(key.low, -1e300), false});
    // The largest whole number of TOML has no neighbour above.
    if (std::isfinite(key.high) && key.high < 0x1p63) {
      ends.push_back({key.high, key.high_included});
      ends.push_back({whole ? key.high + 1 : std::nextafter(key.high, 1e300), false});
    }
    for (const End& end : ends) {
      const std::string said = f.complaint(section_with(row, fmt::format("{:.17g}", end.value)));
      CAPTURE(row.section + "." + key.name);
      CAPTURE(end.value);
      CAPTURE(said);
      // Taken, or refused for another reason (motions of 10^300 turns).
      CHECK(holds(said, row.section + "." + key.name + ": expected ") == !end.taken);
      if (!end.taken) CHECK(holds(said, key.range + ", found "));
      CHECK(key_fault(row.section, key.name, end.value).empty() == end.taken);
    }
    CHECK(holds(f.complaint(section_with(row, "nan")), row.section + "." + key.name + ": expected a"));
    CHECK(holds(f.complaint(section_with(row, "\"many\"")), "found \"many\""));
  }
}

TEST_CASE("keys: a misspelt key is told with the right one, a key of another way with its way") {
  const SceneFolder f;
  f.write("att.csv", "time_s,qw,qx,qy,qz\n0,1,0,0,0\n10,1,0,0,0\n");
  for (const std::string& section : key_sections()) {
    for (const KeyRow& row : key_rows(section)) {
      if (row.key.name.size() < 4) continue;
      KeyRow misspelt = row;
      misspelt.key.name.insert(2, "q");
      CAPTURE(row.section + "." + row.key.name);
      CHECK(holds(f.complaint(section_with(misspelt, "1")),
                  "unknown key '" + misspelt.key.name + "' in [" + section + "]; did you mean '"));
    }
  }
  CHECK(f.complaint(kBall + "[source]\nblackbody_K = 5000\n") ==
        "s.toml:3:15: source.blackbody_K: belongs to a sun; this is a laser");
  CHECK(f.complaint(kBall + "[motion]\nattitudes = \"att.csv\"\nstep_deg = 1\n") ==
        "s.toml:4:12: motion.step_deg: belongs to a spin; this is a table");
}

TEST_CASE("keys: a scene filled by hand is checked by the same rows") {
  const SceneFolder f;
  const Scene good = f.load(kBall);
  Scene s = good;
  s.trace.rays = 0;  // not given
  CHECK(check_of(s) == "fine");
  s.trace.rays = (std::uint64_t{1} << 40) + 1;
  CHECK(check_of(s) == "trace.rays: expected a whole number in [1..2^40], found 1099511627777");
  s = good;
  s.trace.max_bounces = -1;
  CHECK(check_of(s) == "trace.max_bounces: expected a whole number in [1..64], found -1");
  s = good;
  s.observers[0].acceptance_rad = 3.14159265358979323846;  // the end of the range, in the member's unit
  CHECK(check_of(s) == "fine");
  s.observers[0].acceptance_rad = 3.5;
  CHECK(check_of(s) == "observers[0].acceptance_rad: expected a number in [0,3141.592653589793] mrad, found 3500 mrad");
  s = good;
  s.observers[0].name = "a/b";
  CHECK(holds(check_of(s), "observers[0].name: expected a name"));
  s = good;
  s.station = Station{};
  s.station->gate_s = NAN;
  CHECK(check_of(s) == "station.gate_s: expected a number in (0,1e9] ns, found nan ns");
  s = good;
  s.motion = Motion{};
  s.motion->period_s = 1.0;
  s.motion->step_rad = 2.0 * 3.14159265358979323846;  // 360 degrees
  CHECK(check_of(s) == "fine");
  s.motion->axis = {0, 0, 2};
  CHECK(check_of(s) == "motion.axis: expected a unit vector, found length 2");
  s = good;
  s.source.wavelength_nm = 2e7;
  CHECK(check_of(s) == "source.wavelength_nm: expected a number in (0,1e7], found 20000000");
}

TEST_CASE("keys: --check words every key that is given, and hides what another key excludes") {
  const SceneFolder f;
  f.write("pulse.csv", "0,1\n10,1\n");
  f.write("range.csv", "0,1e6\n100,2e6\n");
  const std::string plain = describe_scene(f.load(kBall + "[station]\n"));
  for (const KeyRow& row : key_rows("station")) {
    CAPTURE(row.key.name);
    if (row.kind != KeyKind::form) CHECK(holds(plain, row.key.name + " "));
  }
  CHECK(holds(plain, "range_m 1000000"));
  CHECK_FALSE(holds(plain, "ranges"));
  const std::string full = describe_scene(
      f.load(kBall + "[station]\nranges = \"range.csv\"\npulse = \"pulse.csv\"\ngate_ns = 250\npointing_urad = 3\n"));
  CHECK(holds(full, "ranges 2 rows"));
  CHECK(holds(full, "pulse 2 points"));
  CHECK(holds(full, "gate_ns 250, "));
  CHECK(holds(full, "pointing_urad 3, "));
  CHECK_FALSE(holds(full, "range_m"));
  CHECK_FALSE(holds(full, "pulse_fwhm_ps"));
  const std::string sun = describe_scene(f.load(kBall + "[source]\nkind = \"sun\"\n"));
  CHECK(holds(sun, "kind sun, direction [0, 0, 1], bands 400-700 nm ("));
  CHECK(holds(sun, "blackbody_K 5772, irradiance_W_m2 1361"));
}

TEST_CASE("keys: defaults are what the members start with") {
  const auto fallback = [](const std::string& section, const std::string& name) {
    for (const KeyInfo& key : scene_keys(section)) {
      if (key.name == name) return key.fallback;
    }
    return std::string("no such key");
  };
  CHECK(fallback("station", "range_m") == fmt::format("{:.12g}", Station{}.range_m));
  CHECK(fallback("station", "divergence_urad") == "25");
  CHECK(fallback("station", "name") == "\"clray\"");
  CHECK(fallback("station", "flag_signal") == "false");
  CHECK(fallback("trace", "rays") == "none");
  CHECK(fallback("trace", "max_rays") == fmt::format("{}", TraceOptions{}.max_rays));
  CHECK(fallback("trace", "sampler") == "\"strata\"");
  CHECK(fallback("motion", "period_s") == "required");
  CHECK(fallback("source", "blackbody_K") == "5772");
  CHECK(fallback("source", "direction") == "[0, 0, 1]");
  CHECK(fallback("delay", "bins") == "512");
}

TEST_CASE("keys: malformed rows are bugs of clray") {
  const auto bug_of = [](const RowTexts& texts, auto type) {
    try {
      KeyRow row = parse_texts(texts);
      set_kind<decltype(type)>(texts, &row);
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::bug);
      return std::string(e.what());
    }
    return std::string();
  };
  const std::string bug = "toy.lag_ns: malformed row of keys.def: ";
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "[0,1]", "ns", "", "lag"}, 0.0) == "");
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "[0,1]", "ns", "", ""}, 0.0) == bug + "needs a meaning");
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "", "ns", "", "lag"}, 0.0) == bug + "needs values");
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "[0,1]", "km", "", "lag"}, 0.0) ==
        bug + "no rule leads from 'lag_ns' to 'lag_s'");
  CHECK(bug_of({"toy", "lag_rad", "lag_ns", "[0,1]", "ns", "", "lag"}, 0.0) ==
        bug + "no rule leads from 'lag_ns' to 'lag_rad'");
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "[1,0]", "ns", "", "lag"}, 0.0) != "");
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "[0..4]", "ns", "", "lag"}, 0.0) ==
        bug + "range '[0..4]' does not fit the member's type");
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "[0,4]", "ns", "", "lag"}, 0) ==
        bug + "range '[0,4]' does not fit the member's type");
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "a|b", "ns", "", "lag"}, 0.0) == bug + "words need an enum or a bool");
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "vector", "", "", "lag"}, std::string()) ==
        bug + "a text is a name, or the row of a table");
  CHECK(bug_of({"toy", "lag_s", "lag_ns", "[0,1]", "", "", "lag"}, Vec3()) == bug + "expected direction or vector");
}

TEST_CASE("keys: a key in its member's own unit is left alone, others become s and rad and back") {
  const auto row = [](const char* member, const char* name, const char* unit) {
    return parse_texts({"toy", member, name, "[0,1]", unit, "", "m"});
  };
  CHECK(to_member(row("turn_deg", "turn_deg", "deg"), 90.0) == 90.0);
  CHECK(to_key(row("turn_deg", "turn_deg", "deg"), 90.0) == 90.0);
  CHECK(to_member(row("turn_rad", "turn_deg", "deg"), 180.0) == 3.14159265358979323846);
  CHECK(to_key(row("turn_rad", "turn_deg", "deg"), 3.14159265358979323846) == 180.0);
  CHECK(to_member(row("a_rad", "a_mrad", "mrad"), 1.0) == 1e-3);
  CHECK(to_member(row("a_rad", "a_urad", "urad"), 1.0) == 1e-6);
  CHECK(to_member(row("a_s", "a_ns", "ns"), 1.0) == 1e-9);
  CHECK(to_member(row("a_s", "a_ps", "ps"), 1.0) == 1e-12);
  CHECK(to_key(row("a_s", "a_ps", "ps"), 1e-12) == 1.0);
}

TEST_CASE("keys: listings and faults by name") {
  const std::string all = list_table("keys");
  for (const std::string& section : key_sections()) {
    CHECK(holds(all, list_table(section)));
    for (const KeyRow& row : key_rows(section)) CHECK(holds(list_table(section), "    " + row.key.name + " "));
  }
  CHECK(key_fault("trace", "seed", 3) == "");
  CHECK(key_fault("trace", "max_bounces", 65) == "expected a whole number in [1..64]");
  CHECK(key_fault("delay", "bins", 0) == "expected a whole number in [1..1e7]");
  CHECK(key_fault("trace", "sampler", "sobol") == "");
  CHECK(key_fault("trace", "sampler", "sobl") == "expected one of random, sobol, strata; did you mean 'sobol'?");
  CHECK_THROWS_AS(key_fault("trace", "raise", 1.0), Error);
  CHECK_THROWS_AS(scene_keys("trance"), Error);
}

TEST_CASE("keys: docs/scene-file.md has each row as the table words it, in its section") {
  std::stringstream text;
  text << std::ifstream(std::string(CLRAY_SOURCE_DIR) + "/docs/scene-file.md").rdbuf();
  const std::string document = text.str();
  for (const std::string& section : key_sections()) {
    const std::size_t begin = document.find("\n## [" + section + "]");
    REQUIRE(begin != std::string::npos);
    const std::string part = document.substr(begin, document.find("\n## ", begin + 1) - begin);
    for (const KeyInfo& key : scene_keys(section)) {
      const std::string line =
          fmt::format("\n| `{}` | {} | {} | {} |\n", key.name, key.fallback, key.values, key.meaning);
      INFO("docs/scene-file.md, [" << section << "] lacks the line:" << line);
      CHECK(holds(part, line));
    }
  }
}
