// SPDX-License-Identifier: Apache-2.0
// Aligned columns and near misses of words.
#include <doctest/doctest.h>

#include "text/columns.hpp"
#include "text/near_miss.hpp"

using namespace clray::text;

TEST_CASE("columns are as wide as their widest cell, counted in characters") {
  Columns columns;
  columns.add({"a", "bb", "c"});
  columns.add({"µm²", "x"});
  columns.add({"", "", "end"});
  columns.add({"a", ""});
  CHECK(columns.text("> ") ==
        "> a    bb  c\n"
        "> µm²  x\n"
        ">          end\n"
        "> a\n");
  CHECK(Columns().text("> ") == "");
  CHECK(characters("µm²") == 3);
}

TEST_CASE("near misses: at most a third of the letters wrong, the nearest word wins") {
  const std::vector<std::string> known{"range_m", "rate_Hz", "gate_ns", "name"};
  CHECK(nearest("rnage_m", known) == "range_m");  // neighbours swapped: one step
  CHECK(nearest("range_km", known) == "range_m");
  CHECK(nearest("nme", known) == "name");
  CHECK(nearest("gate", known) == "");   // three of seven letters are missing
  CHECK(nearest("nnmme", known) == "");  // two steps of five letters
  CHECK(nearest("ab", {"ac"}) == "");    // two letters are too few to guess from
  CHECK(nearest("name", known) == "name");
  CHECK(nearest(std::string(101, 'a'), {std::string(101, 'a')}) == "");
  CHECK(did_you_mean("nme", known) == "; did you mean 'name'?");
  CHECK(did_you_mean("colour", known) == "");
}
