// SPDX-License-Identifier: Apache-2.0
// References that say nothing of a scene, or are none.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "clray/error.hpp"
#include "clray/write.hpp"
#include "unit/io_support.hpp"

using namespace clray;
using io_test::Scratch;
using io_test::slurp;
using io_test::spit;

TEST_CASE("a reference that can have none of a scene's totals is refused; one that has none in the end is a warning") {
  const auto scene_of = [](const char* kind, const char* name, const char* observer, const char* variant) {
    Scene scene;
    scene.detectors = {{kind, name, {}}};
    scene.observers = {Observer{}};
    scene.observers[0].name = observer;
    if (*variant != 0) scene.variants = {{variant, {}}};
    return scene;
  };
  const Reference table{"delay.csv", {{"", 1.0}}};
  CHECK_NOTHROW(check_reference(table, scene_of("delay", "late", "", "")));
  for (const char* kind : {"pressure", "spectrometer"})
    CHECK_THROWS_WITH_AS(check_reference(table, scene_of(kind, "", "", "")), doctest::Contains("holds totals of delay"),
                         Error);
  const Reference summary{"summary.json", {{"late/o1/dark//0", 1.0}}};
  CHECK_NOTHROW(check_reference(summary, scene_of("delay", "late", "o1", "dark")));
  CHECK_THROWS_WITH_AS(check_reference(summary, scene_of("delay", "", "o1", "dark")),
                       doctest::Contains("holds totals of late / o1 / dark, and none of this scene's"), Error);
  CHECK_THROWS_AS(check_reference(summary, scene_of("delay", "late", "o2", "dark")), Error);
  CHECK_THROWS_AS(check_reference(summary, scene_of("delay", "late", "o1", "bright")), Error);
  CHECK_THROWS_AS(check_reference(summary, scene_of("delay", "late", "o1", "")), Error);

  Scratch scratch;
  spit(scratch / "delay.csv", "0.5,2\n1.0,3\n1.5,1\n");
  Result result = io_test::result();
  result.spectrometer.push_back({});
  result.spectrometer.back().key.detector = "spectrometer";
  std::vector<std::string> warnings;
  WriteOptions options;
  options.plots = false;
  options.reference_file = scratch / "delay.csv";
  options.warnings = &warnings;
  write_result(result, io_test::scene(), scratch / "out", options);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("there is no true error") != std::string::npos);
  CHECK(nlohmann::json::parse(slurp(scratch / "out/summary.json"))["relative_true_error"].is_null());
}

TEST_CASE("references that are none are refused with their place") {
  Scratch scratch;
  spit(scratch / "empty.csv", "");
  spit(scratch / "bad.csv", "# x\n1,2\n1,two\n");
  spit(scratch / "bad.json", "{\"a\": 1}");
  spit(scratch / "broken.json", "{\"a\"");
  for (const char* file : {"empty.csv", "bad.csv", "bad.json", "broken.json", "absent.json"}) {
    CAPTURE(file);
    try {
      load_reference(scratch / file);
      FAIL("accepted");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::input);
      CHECK(error.context().find(file) != std::string::npos);
    }
  }
  CHECK_THROWS_WITH(load_reference(scratch / "bad.csv"), doctest::Contains("bad.csv:3"));
  CHECK_THROWS_WITH(load_reference("/dev/zero"), "/dev/zero: is a device or pipe; a regular file was expected");
  CHECK_THROWS_WITH(load_reference("/tmp"), "/tmp: is a folder; a file was expected");
}
