// SPDX-License-Identifier: Apache-2.0
// What the benchmarks of clray-bench share: options, Markdown tables and files.
#pragma once

#include <string>
#include <vector>

#include "clray/device.hpp"

namespace clray_bench {

struct Options {
  std::string out;     ///< folder for tables and pictures
  bool quick = false;  ///< --short: a few minutes less, for scripts
  int seeds = 20;
  int min_log2_rays = 8, max_log2_rays = 24;
  double max_seconds_per_case = 0.0;  ///< of tracing, by a pilot run; 0: no limit
  std::vector<std::string> devices;   ///< as for --device of clray; empty: the tests' device
  std::string runs;                   ///< file for a row per run, seed and ray count; empty: none
  std::vector<std::string> meshes;    ///< files of further bodies, of `end`
  double max_seconds = 4.0;           ///< of one run of `end`: a method's efforts end there
  std::vector<std::string> only;      ///< names that a case must contain one of; empty: all
};

int error(const Options& options);       ///< error against run time (docs/error.md)
int stability(const Options& options);   ///< stiff and extreme cases (docs/stability.md)
int specialise(const Options& options);  ///< generic against specialised programs
int sweep(const Options& options);       ///< cost of orientations
int end(const Options& options);         ///< time to given errors, against a tracer on Embree
int method(const Options& options);      ///< whether auto takes the quickest method
int shots(const Options& options);       ///< first-photon shots per second
int scaling(const Options& options);     ///< how costs grow with triangles, rays, threads, views and records
int ray_speed(const Options& options);   ///< speed of beams, shadow rays and bounces by walk, against Embree

/// Whether `name` is asked for.
bool wanted(const Options& options, const std::string& name);

/// Rows of equal length, the first the heading, as a Markdown table.
std::string markdown(const std::vector<std::vector<std::string>>& rows);

/// Writes text to `folder`/`name`, by way of a temporary file. Throws std::runtime_error.
void write_text(const std::string& folder, const std::string& name, const std::string& text);

/// "device, driver" of what the benchmarks ran on.
std::string device_line();
std::string device_line(const clray::DeviceInfo& device);

double median(std::vector<double> values);
/// The value below which `share` of the values lie (nearest rank).
double quantile(std::vector<double> values, double share);

}  // namespace clray_bench
