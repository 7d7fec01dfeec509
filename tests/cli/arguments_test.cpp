// SPDX-License-Identifier: Apache-2.0
// The command line without tracing: help, lists, checks, and what is said about wrong arguments and unusable input.
#include <doctest/doctest.h>

#include "cli/program.hpp"

using namespace cli_test;

namespace {

/// Runs the program on a unit square with more arguments.
Outcome on_square(const Scratch& scratch, std::vector<std::string> arguments) {
  spit(scratch / "square.obj", square());
  arguments.push_back("square.obj");
  return clray(scratch, arguments);
}

}  // namespace

TEST_CASE("help names every option, on standard output, with status 0") {
  const Scratch scratch;
  const auto help = clray(scratch, {"--help"});
  CHECK(help.status == 0);
  CHECK(help.err.empty());
  for (const char* option :
       {"--device",       "--list",     "--detector",      "--rays",        "--target-error",   "--time-limit",
        "--source",       "--observer", "--bins",          "--max-bounces", "--seed",           "--material",
        "--out",          "--explain",  "--sampler",       "--reference",   "--no-plots",       "--quiet",
        "--dump-kernel",  "--check",    "--no-specialise", "--length-unit", "--force-bistatic", "--work-group",
        "--slice-points", "--version",  "--format",        "--walk"}) {
    CAPTURE(option);
    CHECK(contains(help.out, std::string("  ") + option));
  }
  const auto version = clray(scratch, {"--version"});
  CHECK(version.status == 0);
  CHECK(version.out == "clray " CLRAY_VERSION "\n");
}

TEST_CASE("lists of the tables") {
  const Scratch scratch;
  CHECK(contains(clray(scratch, {"--list", "brdf"}).out, "ashikhmin-shirley"));
  CHECK(contains(clray(scratch, {"--list", "shape"}).out, "paraboloid"));
  CHECK(contains(clray(scratch, {"--list", "detector"}).out, "hyperspectral"));
  const auto devices = clray(scratch, {"--list", "devices"});
  CHECK(devices.status == 0);
  CHECK(contains(devices.out, "index"));
  const auto wrong = clray(scratch, {"--list", "colours"});
  CHECK(wrong.status == 2);
  CHECK(contains(wrong.err,
                 "expected one of devices, brdf, shape, detector, walk, keys, source, observer, motion, pass, "
                 "pass.attitude, station, trace"));
}

TEST_CASE("no OpenCL platform: status 4, and the packages to install are named") {
  const Scratch scratch;
  spit(scratch / "square.obj", square());
  // The loader looks for drivers only where this variable says.
  const std::vector<std::string> nowhere{"OCL_ICD_VENDORS=" + scratch.path.string()};
  for (const auto& arguments : {std::vector<std::string>{"--list", "devices"}, {"square.obj"}}) {
    const auto outcome = clray(scratch, arguments, nowhere);
    CHECK(outcome.status == 4);
    CHECK(contains(outcome.err, "pocl-opencl-icd"));
  }
  CHECK_FALSE(scratch.has("clray-out"));
}

TEST_CASE("wrong arguments: status 2, the option, the word and what was expected") {
  struct Case {
    std::vector<std::string> arguments;
    std::vector<std::string> said;
  };
  const Case cases[] = {
      {{"--rays", "many"}, {"--rays", "'many'", "2^22"}},
      {{"--rays", "0"}, {"--rays", "'0'", "[1..2^40]"}},
      {{"--rays", "1.5"}, {"--rays", "whole number"}},
      {{"--rays", "-5"}, {"--rays", "'-5'"}},
      {{"--rays", "1e99"}, {"--rays"}},
      {{"--rays", "2^41"}, {"--rays", "[1..2^40]"}},
      {{"--rays", "nan"}, {"--rays"}},
      {{"--rays", ""}, {"--rays", "''"}},
      {{"--target-error", "0"}, {"--target-error", "(0,100]"}},
      {{"--target-error", "101%"}, {"--target-error", "(0,100]"}},
      {{"--time-limit", "5 weeks"}, {"--time-limit", "500ms"}},
      {{"--source", "0,0,0"}, {"--source", "not all zero"}},
      {{"--source", "1,2"}, {"--source", "X,Y,Z"}},
      {{"--observer", "1,2,3,4"}, {"--observer", "X,Y,Z"}},
      {{"--observer", "1,nan,0"}, {"--observer"}},
      {{"--bins", "0"}, {"--bins"}},
      {{"--bins", "20000000"}, {"--bins", "[1..1e7]"}},
      {{"--max-bounces", "65"}, {"--max-bounces", "[1..64]"}},
      {{"--work-group", "4096"}, {"--work-group", "1 to 1024"}},
      {{"--seed", "-1"}, {"--seed"}},
      {{"--seed", "1e19"}, {"--seed"}},
      {{"--time-limit", "0s"}, {"--time-limit", "(0,inf)"}},
      {{"--length-unit", "furlong"}, {"--length-unit", "ft"}},
      {{"--sampler", "halton"}, {"--sampler", "random, sobol, strata"}},
      {{"--format", "netcfd"}, {"--format", "csv or netcdf", "did you mean 'netcdf'?"}},
      {{"--ray", "5"}, {"no option --ray", "did you mean --rays?"}},
      {{"other.obj"}, {"one scene at a time"}},
      {{"--out"}, {}},
  };
  for (const auto& c : cases) {
    const Scratch scratch;
    const auto outcome = on_square(scratch, c.arguments);
    CAPTURE(c.arguments.front());
    CAPTURE(outcome.err);
    if (c.arguments.front() == "--out") {  // swallows the scene: none is left
      CHECK(contains(outcome.err, "no scene given"));
    }
    CHECK(outcome.status == 2);
    CHECK(outcome.err.rfind("clray: ", 0) == 0);
    CHECK(outcome.out.empty());
    for (const auto& part : c.said) CHECK(contains(outcome.err, part));
    CHECK_FALSE(scratch.has("clray-out"));
  }
  const Scratch scratch;
  const auto nothing = clray(scratch, {});
  CHECK(nothing.status == 2);
  CHECK(contains(nothing.err, "no scene given"));
}

TEST_CASE("options without a value, below zero or in the command's place are refused") {
  const Scratch scratch;
  const auto said = [&](const std::vector<std::string>& arguments, const std::string& words) {
    CAPTURE(words);
    const Outcome outcome = on_square(scratch, arguments);
    CAPTURE(outcome.err);
    CHECK(outcome.status == 2);
    CHECK(contains(outcome.err, words));
  };
  for (const char* option : {"--material", "--out", "--reference", "--device"})
    said({option, ""}, std::string(option) + ": '': expected a value");
  said({"--checkpoint", "-1"}, "--checkpoint: '-1': expected a time of 0 or more");
  said({"--bins", "0"}, "--bins: '0': expected a whole number in [1..1e7]");
  said({"--bins", "10000001"}, "--bins: '10000001': expected a whole number in [1..1e7]");
  for (const char* command : {"verify", "merge"})
    said({"--device", "cpu", command}, std::string("the command comes first: clray ") + command + " DIR");
  const Outcome alone = clray(scratch, {"verify"});
  CHECK(alone.status == 2);
  CHECK(contains(alone.err, "nothing given to verify: name the folder of a result"));
}

TEST_CASE("check: says what was understood, traces nothing, needs no device") {
  const Scratch scratch;
  const auto outcome = on_square(
      scratch, {"--check", "--source", "-1,0,1", "--rays", "4M", "--time-limit", "5m", "--target-error", "0.1%"});
  CAPTURE(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.out, "square"));
  CHECK_FALSE(scratch.has("clray-out"));
  spit(scratch / "odd.obj", square() + "curv 1\n");
  const auto warned = clray(scratch, {"--check", "odd.obj"});
  CHECK(warned.err.empty());
  const std::string words = "warning: odd.obj:6: statement 'curv' is left out";
  CHECK(contains(warned.out, words));
  CHECK(warned.out.find(words) == warned.out.rfind(words));
}

TEST_CASE("unusable input: status 3, file and line, no output folder") {
  struct Case {
    const char *name, *text, *said;
  };
  const Case cases[] = {
      {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "index.obj:4"},
      {"word.obj", "v 0 0 0\nv a b c\n", "word.obj:2"},
      {"empty.obj", "", "empty.obj"},
      {"key.toml", "[[component]]\nname = \"ball\"\nshape = \"sphere\"\nradiuss = 1\n", "key.toml:4"},
      {"scene.txt", "hello", "scene.txt"},
  };
  for (const auto& c : cases) {
    const Scratch scratch;
    spit(scratch / c.name, c.text);
    const auto outcome = clray(scratch, {c.name});
    CAPTURE(c.name);
    CAPTURE(outcome.err);
    CHECK(outcome.status == 3);
    CHECK(contains(outcome.err, c.said));
    CHECK_FALSE(scratch.has("clray-out"));
  }
  const Scratch scratch;
  CHECK(clray(scratch, {"absent.obj"}).status == 3);
  CHECK(clray(scratch, {"."}).status == 3);
  const auto radar = on_square(scratch, {"--detector", "radar"});
  CHECK(radar.status == 2);
  CHECK(contains(radar.err, "radar"));
  const auto reference = on_square(scratch, {"--reference", "absent.json"});
  CHECK(reference.status == 3);
  CHECK(contains(reference.err, "absent.json"));
  CHECK_FALSE(scratch.has("clray-out"));
}

TEST_CASE("an output folder that is none is found before tracing: status 5") {
  const Scratch scratch;
  spit(scratch / "mine", "text");
  const auto outcome = on_square(scratch, {"--out", "mine"});
  CHECK(outcome.status == 5);
  CHECK(contains(outcome.err, "will not replace"));
  CHECK(slurp(scratch / "mine") == "text");
  CHECK(on_square(scratch, {"--out", "/proc/clray"}).status == 5);
}

TEST_CASE("standard output that cannot be written is an error") {
  const Scratch scratch;
  const std::string command = program() + " --list brdf > /dev/full 2> '" + (scratch / "err") + "'";
  const int status = ::system(command.c_str());
  CHECK(WEXITSTATUS(status) == 5);
  CHECK(contains(slurp(scratch / "err"), "standard output"));
}
