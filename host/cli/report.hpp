// SPDX-License-Identifier: Apache-2.0
// What the command line shows a person: the progress bar, the closing table, the lists.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "clray/result.hpp"
#include "clray/write.hpp"

namespace clray::cli {

/// A bar on standard error, only where that is a terminal.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar() { clear(); }
  void show(const Progress& progress);
  void clear();

 private:
  bool shown_ = false, wanted_ = false;
  std::chrono::steady_clock::time_point last_{};
};

/// Words such as "4.2 M" for counts.
std::string short_count(double value);
/// Words such as "1.3 s", "2 min 5 s" for times.
std::string short_time(double seconds);

std::string device_table(const std::vector<DeviceInfo>& devices);
std::string device_line(const DeviceInfo& device);
std::string explanation(const Result& result);

/// The closing table. `reference` may be null.
std::string closing_table(const Result& result, const Scene& scene, const std::string& folder,
                          const std::vector<std::string>& files, const Reference* reference);

/// What a job of several ranks says behind its result.
std::string ranks_line(std::uint32_t ranks, std::uint64_t bytes);

}  // namespace clray::cli
