// SPDX-License-Identifier: Apache-2.0
// The flattener: includes, #line, tables, options; and a real build whose error names the true file and line.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <algorithm>

#include "checks/planted.hpp"
#include "clray/error.hpp"
#include "device/embedded.hpp"
#include "device/platforms.hpp"
#include "device/program.hpp"

using namespace clray;

namespace {

const KernelFiles kFiles = {
    {"brdf/brdf.def",
     "// BRDF(no, \"a comment\", \"\", \"\")\nBRDF(red, \"red\", \"\", \"x\")\nBRDF(green, \"g\", \"\", \"x\")\n"
     "BRDF(blue, \"b\", \"\", \"x\")\n"},
    {"shape/shape.def",
     "SHAPE(grid, \"mesh\", \"flat faces\", \"\", \"x\")\nSHAPE(sphere, \"sphere\", \"flat\", \"\", \"x\")\n"},
    {"detector/detector.def", "DETECTOR(delay, \"delay\", beam, \"\", \"x\")\n"},
    {"brdf/red.cl", "int red;\n"},
    {"brdf/blue.cl", "#include \"a.h\"\nint blue;\n"},
    {"shape/grid.cl", "int grid;\n"},
    {"shape/sphere.cl", "int sphere;\n"},
    {"a.h", "#ifndef A_H\n#define A_H\n#include \"b.h\"\nint a;\n#endif\n"},
    {"b.h", "// says nothing\n#ifndef B_H\n#define B_H\nint b;\n#endif\n"},
    {"main.cl",
     "#include \"a.h\"\n#include \"b.h\"\n#include \"generated/brdf_all.inc\"\n"
     "#include \"generated/shape_all.inc\"\n#include \"generated/detector_all.inc\"\nint last;\n"},
    {"missing.cl", "int x;\n\n#include \"nowhere.h\"\n"},
    {"cycle.cl", "#include \"cycle2.h\"\n"},
    {"cycle2.h", "int y;\n#include \"cycle.cl\"\n"},
    {"conditional.cl", "#ifdef NEVER\n#include \"a.h\"\n#endif\n#include \"a.h\"\n"},
};

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

std::string error_of(const std::string& entry, const ProgramOptions& options = {}) {
  try {
    flatten(entry, options, kFiles);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::bug);
    return error.what();
  }
  return "no error";
}

/// The first CPU device, opened without the self-test.
OpenedDevice opened_cpu() {
  return open_device(choose_devices(find_devices(), "cpu").front());
}

/// Builds `entry` of `files` and returns the message of the error, empty if it builds.
std::string build_message(const std::string& entry, const KernelFiles& files, bool warnings_are_errors = false) {
  OpenedDevice opened = opened_cpu();
  try {
    build_source(opened, entry, flatten(entry, {}, files), warnings_are_errors);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::device);
    CHECK(error.context() == opened.info.name);
    return error.message();
  }
  return {};
}

}  // namespace

TEST_CASE("every included file enters the source once") {
  const std::string source = flatten("main.cl", {}, kFiles);
  CHECK(count(source, "int a;") == 1);
  CHECK(count(source, "int b;") == 1);
  CHECK(count(source, "int last;") == 1);
  CHECK(source.find("int b;") < source.find("int a;"));
  CHECK(source.find("#pragma OPENCL FP_CONTRACT OFF") < source.find("int b;"));
}

TEST_CASE("a file included first under a condition is still there for an unconditional include") {
  const std::string source = flatten("conditional.cl", {}, kFiles);
  CHECK(count(source, "int a;") == 2);
  CHECK(count(source, "#ifndef CLRAY_ONCE_a_h\n#define CLRAY_ONCE_a_h\n") == 2);
  CHECK(build_message("conditional.cl", {{"conditional.cl", kFiles.at("conditional.cl")},
                                         {"a.h", "#ifndef A_H\n#define A_H\n#include \"b.h\"\nint a(void);\n#endif\n"},
                                         {"b.h", "int b(void) { return 1; }\n"}})
            .empty());
}

TEST_CASE("a missing and a cyclic include name their file and line") {
  CHECK(error_of("missing.cl").find("missing.cl:3: ") == 0);
  CHECK(error_of("missing.cl").find("nowhere.h") != std::string::npos);
  CHECK(error_of("cycle.cl").find("cycle2.h:2: ") == 0);
  CHECK(error_of("cycle.cl").find("includes itself") != std::string::npos);
  CHECK(error_of("absent.cl").find("absent.cl: ") == 0);
}

TEST_CASE("only the used rows of a table are compiled, all rows have their numbers") {
  ProgramOptions options;
  options.brdfs = {2, 0, 2};
  options.shapes = {1, 0};
  const std::string source = flatten("main.cl", options, kFiles);
  CHECK(count(source, "int red;") == 1);
  CHECK(count(source, "int blue;") == 1);
  CHECK(source.find("#define CLRAY_BRDF_red 0\n#define CLRAY_BRDF_green 1\n#define CLRAY_BRDF_blue 2\n") !=
        std::string::npos);
  CHECK(source.find("#define CLRAY_BRDFS(X) X(red) X(blue)\n") != std::string::npos);
  CHECK(source.find("CLRAY_BRDF_ONLY") == std::string::npos);
  CHECK(count(source, "int grid;") == 1);
  CHECK(source.find("#define CLRAY_SHAPE_grid 0\n") != std::string::npos);
  CHECK(source.find("#define CLRAY_SHAPES(X) X(sphere)\n") != std::string::npos);
  CHECK(source.find("#define CLRAY_SHAPE_ONLY sphere\n") != std::string::npos);
  CHECK(source.find("#define CLRAY_DETECTORS(X)\n") != std::string::npos);
  CHECK(source.find("#define CLRAY_DETECTOR_delay 0\n") != std::string::npos);
}

TEST_CASE("a used row without its file, and a row that is not there, are errors") {
  ProgramOptions options;
  options.brdfs = {1};
  CHECK(error_of("main.cl", options).find("main.cl:3: there is no kernel file 'brdf/green.cl'") == 0);
  options.brdfs = {3};
  CHECK(error_of("main.cl", options).find("no row 3 in brdf.def") != std::string::npos);
}

TEST_CASE("options make the same source in whatever order they were given") {
  ProgramOptions one, two;
  one.defines["B"] = "2";
  one.defines["A"] = "1";
  one.brdfs = {0, 2};
  two.brdfs = {2, 0, 0};
  two.defines["A"] = "1";
  two.defines["B"] = "2";
  CHECK(flatten("main.cl", one, kFiles) == flatten("main.cl", two, kFiles));
  two.defines["A"] = "3";
  CHECK(flatten("main.cl", one, kFiles) != flatten("main.cl", two, kFiles));
}

TEST_CASE("an error in a kernel names the true file and line") {
  KernelFiles files = {
      {"entry.cl", "#include \"first.h\"\nint after_first;\n#include \"second.h\"\n__kernel void k(void) {}\n"},
      {"first.h", "#ifndef F_H\n#define F_H\n#define ONE 1\n#endif\n"},
      {"second.h",
       "#include \"first.h\"\nstatic inline int good(void) { return ONE; }\n\n"
       "static inline int bad(void) { return undeclared_name; }\n"},
  };
  files["entry.cl"] = "#include \"first.h\"\n#include \"second.h\"\n__kernel void k(void) {}\n";
  const std::string inner = build_message("entry.cl", files);
  CHECK(inner.find("second.h:4:") != std::string::npos);
  CHECK(inner.find("undeclared_name") != std::string::npos);
  CHECK(inner.find("-cl-std=CL1.2") != std::string::npos);

  files["second.h"] = "#include \"first.h\"\nstatic inline int good(void) { return ONE; }\n";
  files["entry.cl"] = "#include \"first.h\"\n#include \"second.h\"\n\n__kernel void k(void) { another_name = 1; }\n";
  CHECK(build_message("entry.cl", files).find("entry.cl:4:") != std::string::npos);

  files["entry.cl"] = "#include \"first.h\"\n#include \"second.h\"\n\n__kernel void k(void) { good(); }\n";
  CHECK(build_message("entry.cl", files).empty());
}

TEST_CASE("warnings are errors where that is asked for") {
  const KernelFiles files = {{"w.cl", "__kernel void k(__global int *p) { *p = \"text\"; }\n"}};
  setenv("CLRAY_KERNEL_WERROR", "1", 1);
  CHECK(build_message("w.cl", files).find("-Werror") != std::string::npos);
  unsetenv("CLRAY_KERNEL_WERROR");
  CHECK(build_message("w.cl", files, true).find("w.cl:1:") != std::string::npos);
}

TEST_CASE("a program is built once for equal source") {
  OpenedDevice opened = opened_cpu();
  const std::string source = "__kernel void k(void) {}\n";
  build_source(opened, "k", source, false);
  build_source(opened, "k", source, false);
  CHECK(opened.programs.size() == 1);
  build_source(opened, "k", source + "\n", false);
  CHECK(opened.programs.size() == 2);
}

TEST_CASE("the embedded files are the files of kernels/, the tables can be read") {
  const auto& files = embedded_kernels();
  REQUIRE(files.count("shared/portable.h") == 1);
  CHECK(files.at("shared/portable.h").find("// SPDX-License-Identifier: Apache-2.0\n") == 0);
  const auto ids = table_row_ids("brdf", files);
  CHECK(std::find(ids.begin(), ids.end(), "lambert") == ids.begin());
  CHECK(table_row_ids("shape", files).front() == "triangle");
  CHECK(table_row_ids("detector", files).front() == "intensity");
}

TEST_CASE("the faults that checks of devices plant have their lines in the kernels") {
  for (const bool race : {false, true}) CHECK_NOTHROW(clray::test::with_planted_fault(race));
}
