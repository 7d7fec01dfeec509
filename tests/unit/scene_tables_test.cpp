// SPDX-License-Identifier: Apache-2.0
// The rows of the tables as data: what the .def files say, and that malformed rows are refused as bugs.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "clray/error.hpp"
#include "clray/keys.hpp"
#include "scene/tables.hpp"

using namespace clray;

namespace {

/// The complaint about a row with these keys, or "" if it is taken.
std::string bug_of(const std::string& keys) {
  try {
    parse_row("x", "x", "", keys, "a row");
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::bug);
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("tables: rows keep the order and the words of their file") {
  const TableRow& as = table("brdf")[1];
  CHECK(as.id == "ashikhmin_shirley");
  CHECK(as.name == "ashikhmin-shirley");
  REQUIRE(as.keys.size() == 4);
  CHECK(as.keys[2].name == "n");
  CHECK(as.keys[2].default_value == 50.0);
  CHECK(as.keys[2].low == 0.0);
  CHECK(as.keys[2].high == 1e6);
  CHECK(as.keys[2].meaning == "exponent of the specular peak");
  CHECK(as.keys[3].default_key == "rho");
  CHECK(table_index("shape", "mesh") == 0);
  CHECK(table_index("shape", "triangle") == -1);
  CHECK(table("detector")[static_cast<std::size_t>(table_index("detector", "delay"))].beam);
  CHECK(table("detector")[static_cast<std::size_t>(table_index("detector", "rgb"))].pixel);
  CHECK_THROWS_AS(table("colour"), Error);
}

TEST_CASE("tables: ranges, switches and whole numbers") {
  const TableRow row =
      parse_row("x", "x", "", "a 1 (0,inf) m; b 0 {0,1} on; c 3 [1..1e7] of; d nan (-1,1) e; e a [0,2] f", "m");
  CHECK_FALSE(key_accepts(row.keys[0], 0.0));
  CHECK(key_accepts(row.keys[0], 1e-300));
  CHECK_FALSE(key_accepts(row.keys[0], INFINITY));
  CHECK(row.keys[1].is_switch);
  CHECK_FALSE(key_accepts(row.keys[1], 0.5));
  CHECK(row.keys[2].is_whole);
  CHECK_FALSE(key_accepts(row.keys[2], 2.5));
  CHECK_FALSE(key_accepts(row.keys[2], 1e8));
  CHECK(key_accepts(row.keys[2], 1e7));
  CHECK(std::isnan(row.keys[3].default_value));
  CHECK_FALSE(key_accepts(row.keys[3], -1.0));
  CHECK(row.keys[4].default_key == "a");
  std::string expected;
  key_accepts(row.keys[2], 0.0, &expected);
  CHECK(expected == "a whole number in [1..1e7]");
}

TEST_CASE("tables: defaults fill in, also from an earlier key") {
  const TableRow& row = table("brdf")[1];
  CHECK(row_values(row, {}) == std::vector<double>{0.5, 0.5, 50.0, 0.5});
  CHECK(row_values(row, {{"rho", 0.9}, {"n", 7.0}}) == std::vector<double>{0.9, 0.5, 7.0, 0.9});
  CHECK(row_values(row, {{"rho", 0.9}, {"f0", 0.1}}) == std::vector<double>{0.9, 0.5, 50.0, 0.1});
}

TEST_CASE("tables: traits are words of a row") {
  CHECK(table_row("brdf", "mirror").delta);
  CHECK_FALSE(table_row("brdf", "ggx").delta);
  CHECK(table_row("brdf", "lambert").bounded);
  CHECK_FALSE(table_row("brdf", "ashikhmin-shirley").bounded);
  CHECK(table_row("brdf", "tabulated").file);
  CHECK(table_row("shape", "mesh").file);
  CHECK(table_row("shape", "mesh").flat);
  CHECK_FALSE(table_row("shape", "sphere").flat);
  const TableRow row = parse_row("x", "x", " flat  delta", "", "m");
  CHECK(row.flat);
  CHECK(row.delta);
  CHECK_FALSE(row.file);
  CHECK(parse_row("x", "x", "pixel", "", "m").pixel);
  try {
    parse_row("x", "x", "flatt", "", "m");
    FAIL("expected an error");
  } catch (const Error& e) {
    CHECK(std::string(e.what()) == "x: malformed table row: unknown trait 'flatt'");
  }
  CHECK_THROWS_AS(table_row("brdf", "velvet"), Error);
}

TEST_CASE("tables: malformed rows are bugs of clray") {
  CHECK(bug_of("rho 0.5 [0,1] diffuse") == "");
  CHECK(bug_of("") == "");
  CHECK(bug_of("rho 0.5 [0,1]") != "");
  CHECK(bug_of("rho half [0,1] diffuse") ==
        "x: malformed table row: default 'half' of key 'rho' is no number and no earlier key");
  CHECK(bug_of("rho 0.5 0,1 diffuse") == "x: malformed table row: range '0,1' of key 'rho'");
  CHECK(bug_of("rho 0.5 [0,1 diffuse") != "");
  CHECK(bug_of("rho 0.5 [1,0] diffuse") != "");
  CHECK(bug_of("rho 2 [0,1] diffuse") == "x: malformed table row: default of key 'rho' is outside [0,1]");
  CHECK(bug_of("rho 0.5 [0,1] diffuse; rho 0.5 [0,1] again") != "");
  CHECK(bug_of("rho 0.5 [0,1] diffuse;") != "");
  CHECK(bug_of("f0 rho [0,1] later; rho 0.5 [0,1] diffuse") != "");
  CHECK_THROWS_AS(parse_row("x", "x", "side", "", "m"), Error);
  CHECK_THROWS_AS(parse_row("x", "x", "", "", ""), Error);
}

TEST_CASE("tables: the listing names every row and key") {
  for (const std::string kind : {"brdf", "shape", "detector"}) {
    const std::string text = list_table(kind);
    for (const TableRow& row : table(kind)) {
      if (row.inner) continue;  // no scene names it
      CHECK(text.find(row.name + ": " + row.meaning + "\n") != std::string::npos);
      for (const TableKey& key : row.keys) CHECK(text.find("    " + key.name) != std::string::npos);
    }
  }
  try {
    list_table("colour");
    FAIL("expected an error");
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::usage);
  }
}

TEST_CASE("tables: docs/scene-file.md names every row and key") {
  std::stringstream text;
  text << std::ifstream(std::string(CLRAY_SOURCE_DIR) + "/docs/scene-file.md").rdbuf();
  const std::string document = text.str();
  REQUIRE(document.size() > 1000);
  for (const std::string kind : {"brdf", "shape", "detector"}) {
    for (const TableRow& row : table(kind)) {
      INFO(row.name);
      CHECK(document.find("`" + row.name + "`") != std::string::npos);
      for (const TableKey& key : row.keys) {
        INFO(key.name);
        CHECK(document.find("`" + key.name + "`") != std::string::npos);
      }
    }
  }
}
