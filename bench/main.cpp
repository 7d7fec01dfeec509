// SPDX-License-Identifier: Apache-2.0
// clray-bench error|end|rays|method|scaling|stability|specialise|sweep|shots: measures clray through its public
// interface. The device is the one that CLRAY_TEST_DEVICE names, else the CPU.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "bench.hpp"

int main(int argc, char** argv) {
  clray_bench::Options options;
  options.out = CLRAY_SOURCE_DIR "/docs";
  CLI::App app{"Measures clray: error against run time, stability, specialisation, orientation sweeps"};
  app.require_subcommand(1);
  int (*chosen)(const clray_bench::Options&) = nullptr;
  const auto add = [&](const char* name, const char* what, int (*run)(const clray_bench::Options&)) {
    CLI::App* sub = app.add_subcommand(name, what);
    sub->add_option("--out", options.out, "folder for tables and pictures")->capture_default_str();
    sub->add_option("--only", options.only, "cases whose name contains one of these");
    sub->add_flag("--short", options.quick, "the quick cases, few seeds and few rays only");
    sub->callback([&chosen, run] { chosen = run; });
    return sub;
  };
  CLI::App* error = add("error", "error against run time for cases with a closed form", clray_bench::error);
  error->add_option("--seeds", options.seeds, "seeds per point")->capture_default_str()->check(CLI::Range(2, 1000));
  error->add_option("--min-log2-rays", options.min_log2_rays)->capture_default_str()->check(CLI::Range(8, 32));
  error->add_option("--max-log2-rays", options.max_log2_rays)->capture_default_str()->check(CLI::Range(8, 32));
  error->add_option("--max-seconds-per-case", options.max_seconds_per_case,
                    "stop a case at fewer rays where all its seeds and samplers would trace longer (default: none)");
  error->add_option("--device", options.devices,
                    "as for clray; repeatable (default: that of CLRAY_TEST_DEVICE, else cpu)");
  error->add_option("--runs", options.runs, "also write a row per seed and ray count to this file");
  add("stability", "the stiff and extreme cases", clray_bench::stability);
  add("specialise", "generic against specialised programs", clray_bench::specialise);
  add("sweep", "cost of orientations", clray_bench::sweep);
  CLI::App* method = add("method", "whether auto takes the quickest way to a target", clray_bench::method);
  method->add_option("--mesh", options.meshes, "a mesh as a further body; repeatable")->check(CLI::ExistingFile);
  CLI::App* end =
      add("end", "time to given errors of the total and of bins, against a tracer on Embree", clray_bench::end);
  end->add_option("--mesh", options.meshes, "a mesh as a further body; repeatable")->check(CLI::ExistingFile);
  end->add_option("--seeds", options.seeds, "runs per method and effort")
      ->capture_default_str()
      ->check(CLI::Range(5, 1000));
  end->add_option("--max-seconds", options.max_seconds,
                  "no effort of which a run takes longer; what lies beyond is extrapolated")
      ->capture_default_str();
  end->add_option("--device", options.devices, "as for clray (default: that of CLRAY_TEST_DEVICE, else cpu)")
      ->expected(1);
  add("shots", "first-photon shots per second", clray_bench::shots);
  add("scaling", "how costs grow with triangles, rays, threads, orientations, bins, lanes and observers",
      clray_bench::scaling);
  CLI::App* rays = add("rays", "speed of rays by walk, against a tracer on Embree", clray_bench::ray_speed);
  rays->add_option("--mesh", options.meshes, "a mesh as a further body; repeatable")->check(CLI::ExistingFile);
  CLI11_PARSE(app, argc, argv);
  try {
    return chosen(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "clray-bench: %s\n", e.what());
    return 1;
  }
}
