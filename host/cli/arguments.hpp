// SPDX-License-Identifier: Apache-2.0
// The command line's arguments: parsed, checked, and applied to a scene. Units as typed by the user are turned into
// those of the public interface here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clray/saved.hpp"
#include "clray/scene.hpp"

namespace clray::cli {

/// What the user asked for.
struct Arguments {
  std::string scene, device, list, out, reference, command;
  bool explain = false, no_plots = false, netcdf = false, quiet = false, dump_kernel = false, check = false;
  SceneOptions scene_options;

  std::optional<std::uint64_t> rays, seed, slice_points;
  std::optional<double> target_error_percent, time_limit_s;
  std::optional<int> max_bounces, work_group;
  std::optional<SamplerKind> sampler;
  std::optional<std::string> walk;
  std::optional<Method> method;
  bool no_specialise = false, force_bistatic = false;

  // Saved sums (clray/saved.hpp).
  std::string verb;                   ///< "merge", "verify" or nothing
  std::vector<std::string> operands;  ///< what is merged or verified
  std::string resume;                 ///< the result to go on with
  std::vector<std::string> from;      ///< files of sums to go on from
  std::vector<std::string> note;      ///< this command, for whoever goes on: the folder and the words
  double checkpoint_s = 30.0;
  std::uint64_t memory_bytes = 0;  ///< 0: any
  bool keep_sums = false;
  Share share;

  bool finished = false;  ///< help or version were printed: nothing is left to do
};

/// Throws Error(usage). Prints help and version itself.
Arguments parse_arguments(int argc, char** argv);

/// Parses one command's words over what is known.
void parse_words(std::vector<std::string> words, Arguments* arguments);

/// What --resume, merge and verify go on with: the arguments of the saved run, and these (of `words`) over them.
void go_on(const std::vector<std::string>& words, Arguments* arguments);

/// The file of sums of a result's folder, or that file itself.
std::string sums_file(const std::string& folder);

/// The command line's word over the scene file's.
void apply(const Arguments& arguments, Scene& scene);

/// "1e6", "2^22", "4M" (k, M, G = 10^3, 10^6, 10^9). Throws Error(usage) naming `option`.
std::uint64_t parse_count(const std::string& text, const std::string& option);
/// "30", "30s", "500ms", "5m", "2h", in seconds.
double parse_duration(const std::string& text, const std::string& option);
/// "1" or "1%".
double parse_percent(const std::string& text, const std::string& option);
/// "X,Y,Z", as a unit vector.
Vec3 parse_direction(const std::string& text, const std::string& option);
/// "i/n", 1 to n.
Share parse_share(const std::string& text, const std::string& option);
/// "800M", "4G", "1.5G", in bytes (k, M, G = 10^3, 10^6, 10^9; the letter B may follow).
std::uint64_t parse_bytes(const std::string& text, const std::string& option);
/// One of length_units(), or a number of metres.
double parse_length_unit(const std::string& text, const std::string& option);

}  // namespace clray::cli
