// SPDX-License-Identifier: Apache-2.0
// Runs kernels of every kind on one device, small and against the host's answers: the traced self-test with each
// surface, shape, detector and walk alone, then with what is drawn at random; the exact and sampled self-tests in all
// variants; the start-up self-test and the shots of a session. tests/checks/races does so on Oclgrind with its checks
// on. Usage: tests_races DEVICE DRAWN [race | uninitialised]     the last: a program with that fault, and nothing else
#include <cstdio>
#include <cstdlib>
#include <random>
#include <set>
#include <string>

#include "checks/planted.hpp"
#include "clray/device.hpp"
#include "clray/error.hpp"
#include "device/buffers.hpp"
#include "device/platforms.hpp"
#include "device/self_test.hpp"
#include "device/shots.hpp"
#include "pipeline/built_in_scene.hpp"
#include "pipeline/device_pass.hpp"
#include "pipeline/exact_self_test.hpp"
#include "pipeline/traced_self_test.hpp"
#include "scene/tables.hpp"

using namespace clray;

namespace {

ProgramContent simple(const std::string& shape, const std::string& model, const std::string& detector) {
  ProgramContent content;
  content.shapes = {shape};
  content.models = {model};
  content.detectors = {detector};
  return content;
}

/// As a picture's, from pixels or, with mirrors, from the light.
void make_picture(ProgramContent* content, const std::string& detector, bool mirrors) {
  content->detectors = {detector};
  content->connections = 1;
  content->pixels = !mirrors;
  content->mirrors = mirrors;
}

std::vector<std::string> names_of(const char* of, bool (*wanted)(const TableRow&)) {
  std::vector<std::string> names;
  for (const TableRow& row : table(of)) {
    if (wanted(row)) names.push_back(row.name);
  }
  return names;
}

const std::vector<std::string> kModels = names_of("brdf", [](const TableRow&) { return true; });
const std::vector<std::string> kShapes = names_of("shape", [](const TableRow&) { return true; });
const std::vector<std::string> kBeams = names_of("detector", [](const TableRow& r) { return r.beam && !r.inner; });
const std::vector<std::string> kPictures = names_of("detector", [](const TableRow& r) { return r.pixel && !r.inner; });

/// Each row of the tables by itself.
std::vector<ProgramContent> rows() {
  std::vector<ProgramContent> all;
  for (const std::string& shape : kShapes) all.push_back(simple(shape, "lambert", "delay"));
  for (const std::string& model : kModels) {
    all.push_back(simple("mesh", model, "pressure"));
    all.back().scatter = true;
  }
  for (const std::string& detector : kBeams) all.push_back(simple("sphere", "ggx", detector));
  for (const std::string& detector : kPictures) {
    for (const bool mirrors : {false, true}) {
      all.push_back(simple("box", "mirror", "delay"));
      make_picture(&all.back(), detector, mirrors);
      all.back().scatter = true;
    }
  }
  all.push_back(simple("mesh", "lambert", "delay"));
  all.back().walk = "packet";
  all.push_back(simple("mesh", "lambert", "delay"));
  all.back().walk = "placed";
  return all;
}

/// A program, and what of its first hits is solved elsewhere.
struct Program {
  ProgramContent content;
  bool first_solved = false, push_solved = false;
};

class Draw {
 public:
  explicit Draw(std::uint32_t seed) : random_(seed) {}
  Program program() {
    Program p;
    ProgramContent& c = p.content;
    c.models = some(kModels);
    c.shapes = some(kShapes);
    c.detectors = some(kBeams);
    c.lanes = one_in(2) ? 2 : 1;
    c.connections = one_in(2) ? 2 : 1;
    c.components = 1 + random_() % 4;
    for (bool* flag : {&c.scatter, &c.one_sided, &c.shared_planes, &c.specialised}) *flag = one_in(2);
    const bool packets = one_in(4);
    if (packets || one_in(3)) c.walk = packets ? "packet" : "placed";
    c.hinged = !packets && one_in(2);
    c.curved = one_in(4);
    if (!packets) {
      c.sobol = !one_in(4);
      c.strata = c.sobol && !one_in(4);
    }
    if (!packets && one_in(4)) make_picture(&c, kPictures[random_() % kPictures.size()], one_in(2));
    p.first_solved = c.curved || one_in(3);
    p.push_solved = one_in(3);
    return p;
  }

 private:
  bool one_in(std::uint32_t n) { return random_() % n == 0; }
  std::vector<std::string> some(const std::vector<std::string>& of) {
    std::vector<std::string> chosen;
    while (chosen.empty()) {
      for (const std::string& name : of) {
        if (one_in(3)) chosen.push_back(name);
      }
    }
    return chosen;
  }
  std::mt19937 random_;
};

void trace(OpenedDevice& opened, const Program& program, const KernelFiles& files) {
  PassPlan plan = built_in_scene(program.content).plan;
  auto& defines = plan.program.options.defines;
  if (program.content.curved) defines["CLRAY_CURVED"] = "1";
  if (program.first_solved) defines["CLRAY_SKIP_FIRST"] = "1";
  if (program.push_solved) defines["CLRAY_SKIP_PUSH"] = "1";
  run_traced_self_test(opened, plan, program.content.specialised, files);
}

/// Every program of exact.cl: with and without windows, observers at the source and elsewhere, and sampling.
void solve(OpenedDevice& opened, int variant) {
  ExactNumbers numbers;
  numbers.lanes = variant & 1 ? 2 : 1;
  numbers.binnings = variant & 2 ? 2 : 0;
  numbers.from_source = (variant & 4) == 0;
  numbers.carry = (variant & 12) != 0;
  numbers.tiles = true;
  ProgramOptions options;
  options.defines = {{"CLRAY_LANES", std::to_string(numbers.lanes)},
                     {"CLRAY_BINNINGS", std::to_string(numbers.binnings)},
                     {"CLRAY_FROM_SOURCE", numbers.from_source ? "1" : "0"},
                     {"CLRAY_CARRY", numbers.carry ? "1" : "0"},
                     {"CLRAY_EXACT_STACK", "24"},
                     {"CLRAY_TILES", numbers.tiles ? "1" : "0"}};
  const std::string source = program_source(opened, "exact.cl", options);
  const cl::Program program = build_source(opened, "exact.cl", source, true);
  run_exact_self_test(opened, source, make_kernel(opened, program, "clray_exact"), numbers);
  run_sample_self_test(opened, source, make_kernel(opened, program, "clray_sample"), numbers);
}

void shoot(Device& device) {
  const std::vector<double> gate{0.0, 0.0, 1.0, 0.4, 2.0, 0.5}, brightness{1.0};
  std::vector<double> times;
  std::vector<std::uint32_t> kinds;
  sample_shots_on(device, {gate, brightness, 0.01, 0.1, 1, 0, 100}, &times, &kinds);
}

/// Kernel files that no program held, but for tables, which become code elsewhere, and the host's own walk.
std::set<std::string> missing(const OpenedDevice& opened) {
  std::set<std::string> files;
  for (const auto& [path, text] : embedded_kernels()) {
    const bool is_table = path.size() > 4 && path.compare(path.size() - 4, 4, ".def") == 0;
    if (is_table || path == "walk/exhaustive.cl") continue;
    bool held = false;
    for (const auto& [key, program] : opened.programs) held = held || key.find("\"" + path + "\"") != std::string::npos;
    if (!held) files.insert(path);
  }
  return files;
}

/// A program with one fault, which the checks of the device must report.
void run_fault(OpenedDevice& opened, const std::string& fault) {
  trace(opened, {simple("sphere", "lambert", "delay")}, clray::test::with_planted_fault(fault == "race"));
}

void run_all(Device& device, int drawn) {
  OpenedDevice& opened = device.impl().devices.front();
  const KernelFiles files = embedded_kernels();  // of a copy nothing is remembered
  std::vector<Program> programs;
  for (const ProgramContent& row : rows()) programs.push_back({row});
  Draw draw(18);
  for (int k = 0; k < drawn; ++k) programs.push_back(draw.program());
  for (std::size_t k = 0; k < programs.size(); ++k) {
    std::printf("program %zu\n", k);
    std::fflush(stdout);
    trace(opened, programs[k], files);
  }
  for (int variant = 0; variant < 16; ++variant) solve(opened, variant);
  shoot(device);
  run_self_test(opened, files);
  std::string left;
  for (const std::string& file : missing(opened)) left += " " + file;
  if (!left.empty()) throw Error(ErrorCode::bug, "no program held" + left, "tests_races");
  std::printf("%zu programs\n", opened.programs.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: tests_races DEVICE DRAWN [race | uninitialised]\n");
    return 2;
  }
  try {
    Device device(argv[1]);
    if (argc > 3) {
      run_fault(device.impl().devices.front(), argv[3]);
    } else {
      run_all(device, std::atoi(argv[2]));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tests_races: %s\n", error.what());
    return 1;
  }
  return 0;
}
