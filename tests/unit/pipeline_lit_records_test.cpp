// SPDX-License-Identifier: Apache-2.0
// Which records found light: a record is warned of where it is zero in every orientation, by its names, in the words of
// what its detector looks at.
#include <doctest/doctest.h>

#include "pipeline/lit_records.hpp"

using namespace clray;

namespace {

ResultKey key(const std::string& detector, const std::string& observer, std::size_t orientation) {
  return {detector, observer, "", "", orientation};
}

}  // namespace

TEST_CASE("lit records: one orientation with light is enough, and dark records are named once") {
  LitRecords records;
  const TableRow& delay = table_row("detector", "delay");
  for (const std::size_t orientation : {0, 1, 2}) {
    records.note(delay, key("delay", "a", orientation), orientation == 1);
    records.note(delay, key("delay", "b", orientation), false);
  }
  REQUIRE(records.warnings(false).size() == 1);
  CHECK(records.warnings(false)[0] ==
        "no hits: nothing that was lit is seen: all results are zero (delay, observer b)");
  CHECK(records.warnings(true)[0] ==
        "no hits: rays found nothing that is lit and seen: all results are zero (delay, observer b)");
  records.note(delay, key("delay", "b", 3), true);
  CHECK(records.warnings(false).empty());
}

TEST_CASE("lit records: each kind of detector has its own words, and many names are counted") {
  LitRecords records;
  records.note(table_row("detector", "pressure"), key("pressure", "", 0), false);
  records.note(table_row("detector", "rgb"), key("rgb", "", 0), false);
  for (const char* observer : {"a", "b", "c", "d", "e", "f"})
    records.note(table_row("detector", "spectrometer"), key("s", observer, 0), *observer == 'f');
  REQUIRE(records.warnings(false).size() == 3);
  CHECK(records.warnings(false)[0] ==
        "no hits: nothing that was lit is seen: all results are zero (s, observer a; s, observer b; s, observer c; s, "
        "observer d; and 1 more)");
  CHECK(records.warnings(false)[1] == "no hits: no light meets the body: all results are zero (pressure)");
  CHECK(records.warnings(true)[1] == "no hits: rays found no light on the body: all results are zero (pressure)");
  CHECK(records.warnings(false)[2] == "black pictures: nothing that is seen was lit: all results are zero (rgb)");
}
