// SPDX-License-Identifier: Apache-2.0
// clray-bench error: error against run time. For every case with a closed form, sampler, device and ray count the true
// and the claimed error over many seeds, and the wall time split. Writes error.md, error.csv and error.png.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "bench.hpp"
#include "error_report.hpp"

namespace clray_bench {

namespace {

const char* const kIntroduction =
    "Errors are relative to the closed form of the total. Samplers: `random`, plain random points on the beam's "
    "rectangle;\n"
    "`sobol`, Owen-scrambled Sobol points on it; `stratified`, the default: such points on strata of silhouette, delay "
    "and peaks.\n"
    "Claimed: the standard error over the value; a fair claim has a median true error of 0.67 of it. Slope: of the "
    "root mean square (rms) true\nerror against rays, where that is below 30 %. Time to p %: tracing until "
    "90 % of seeds are that near (~: by the slope).\n"
    "One run a seed gives every doubling from 2^14 rays on: its points begin with those of a shorter run, and its "
    "totals there are equal to\n"
    "the bit (checked at 2^14, 2^18 and 2^22 in the cases with bins). Of pressure the total is |C|, the error that "
    "along C. The bowl is a mesh whose\nfacets differ from the closed form by up to 0.02 %. The box-wing is "
    "meshes/box_wing.obj with its MTL; no part of it hides another in these views.\n"
    "Of the sphere with n = 100000 some twenty rays in a million of the beam meet the peak: before random or plain "
    "Sobol points "
    "do, totals and claims are those of the rest.\n";

Curve measure_and_print(const ErrorCase& c, const Sampler& sampler, int most, const Options& options,
                        clray::Device& device, std::string* runs) {
  Curve curve = measure(c, sampler, most, options, device, runs);
  for (const Point& p : curve.points)
    fmt::print("{:22} {:10} 2^{:<2} true {:9.2e}  claimed {:9.2e}  {:.3f} s\n", c.name, sampler.name, p.log2_rays,
               rms(p.truth), rms(p.claim), median(p.seconds));
  std::fflush(stdout);
  return curve;
}

DeviceCurves measure_all(const std::vector<ErrorCase>& cases, const Options& options, clray::Device& device,
                         std::string* runs) {
  DeviceCurves all{device_line(device.info()), {}, {}, {}};
  for (const ErrorCase& c : cases) {
    if (!wanted(options, c.name)) continue;
    const int most = affordable(c, options, device);
    if (const std::optional<Solved> solved = solve(c, device)) {
      all.solved.push_back(*solved);
      all.tiles.push_back(measure_and_print(c, kTiles, std::min(most, kMostTiles), options, device, runs));
    }
    for (const Sampler& sampler : kSamplers)
      all.curves.push_back(measure_and_print(c, sampler, most, options, device, runs));
  }
  return all;
}

/// Which cases stopped at fewer rays, and why.
std::string stopped_early(const std::vector<Curve>& curves, const Options& options) {
  std::string names;
  for (std::size_t i = 0; i < curves.size(); i += kSamplerCount) {
    const int last = curves[i].points.back().log2_rays;
    if (last < options.max_log2_rays)
      names += fmt::format("{}{} at 2^{}", names.empty() ? "" : ", ", curves[i].which->name, last);
  }
  if (names.empty()) return "";
  return fmt::format(
      "\nStopped at fewer rays, because all seeds and samplers would have traced for more than {:g} s "
      "(`--max-seconds-per-case`): {}.\n",
      options.max_seconds_per_case, names);
}

std::string command_options(const Options& options) {
  std::string text = options.quick ? " --short" : "";
  if (options.max_seconds_per_case > 0.0)
    text += fmt::format(" --max-seconds-per-case {:g}", options.max_seconds_per_case);
  for (const std::string& device : options.devices) text += " --device " + device;
  return text;
}

std::string section(const DeviceCurves& d, const std::string& picture, const Options& options, clray::Device& device) {
  const std::string replicates = replicates_table(options, device);
  return fmt::format(
      "\n## {}\n{}\n![error against time]({})\n\n### Totals at the largest ray count\n\n{}\n"
      "### The exact method\n\nCases that it takes ([exact.md](exact.md)); in the picture a cross, at its time and its "
      "rounding bound.\n\n{}\n"
      "### Tiles\n\nThe same cases with points in tiles. A run finds each doubling anew, so its time is that of all "
      "of them.\n\n{}\n"
      "### Rays to 0.1 %\n\nRays at which the rms true error falls below 0.1 % for good, interpolated between the "
      "doublings measured.\n~: beyond the last, by the slope.\n\n{}\n"
      "### Claims\n\nRms true error over rms claimed, by rays: 1 is fair, above 1 claims too little.\n\n{}\n"
      "### Error per bin (512 bins)\n\nRms over seeds and bins, of the same bins for both: those in which plain "
      "random rays leave 10 hits or more on average, by\nthe closed form.\n\n{}\n"
      "### Where the time goes\n\nSeconds at the largest ray count, medians; programs come from the cache after the "
      "first run.\n\n{}{}",
      d.device, stopped_early(d.curves, options), picture, totals_table(d.curves), solved_table(d.solved),
      totals_table(d.tiles), rays_table(d.curves), fairness_table(d.curves), bins_table(d.curves),
      split_table(d.curves),
      replicates.empty()
          ? ""
          : "\n### The cost of a claim\n\nThe same 2^16 stratified rays as 4, 16 and 32 replicates.\n\n" + replicates);
}

}  // namespace

int error(const Options& asked) {
  Options options = asked;
  if (options.quick) {
    options.max_log2_rays = std::min(options.max_log2_rays, 16);
    options.seeds = std::min(options.seeds, 5);
  }
  options.max_log2_rays = std::max(options.max_log2_rays, options.min_log2_rays);
  const std::string typed = command_options(options);
  if (options.devices.empty()) options.devices.push_back(clray_test::device_name());
  // A short or partial run does not replace the results of the full one.
  const std::string stem = options.quick || !options.only.empty() ? "error-short" : "error";
  const std::vector<ErrorCase> cases = error_cases();
  std::string runs = "case,sampler,rays,seed,true_error,claimed_standard_error,trace_s\n", text;
  std::vector<DeviceCurves> all;
  for (std::size_t i = 0; i < options.devices.size(); ++i) {
    clray::Device device(options.devices[i]);
    all.push_back(measure_all(cases, options, device, &runs));
    if (all.back().curves.empty()) return 2;
    const std::string picture = stem + (i == 0 ? "" : "-" + std::to_string(i + 1)) + ".png";
    plot_error(options.out, picture, all.back());
    text += section(all.back(), picture, options, device);
  }
  write_text(options.out, stem + ".csv", error_csv(all));
  if (!options.runs.empty()) {
    const std::filesystem::path path = std::filesystem::absolute(options.runs);
    write_text(path.parent_path(), path.filename(), runs);
  }
  write_text(
      options.out, stem + ".md",
      fmt::format("# Error against run time\n\nWritten by `clray-bench error{}`: {} seeds, 2^{} to 2^{} "
                  "rays; the numbers behind the picture are in\n{}.csv. {}{}",
                  typed, options.seeds, options.min_log2_rays, options.max_log2_rays, stem, kIntroduction, text));
  return 0;
}

}  // namespace clray_bench
