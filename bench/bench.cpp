// SPDX-License-Identifier: Apache-2.0
// See bench.hpp.
#include "bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "support/scenes.hpp"

namespace clray_bench {

bool wanted(const Options& options, const std::string& name) {
  return options.only.empty() || std::any_of(options.only.begin(), options.only.end(), [&](const std::string& part) {
           return name.find(part) != std::string::npos;
         });
}

std::string markdown(const std::vector<std::vector<std::string>>& rows) {
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::string& cell : rows[i]) text += "| " + cell + " ";
    text += "|\n";
    if (i == 0) {
      for (std::size_t k = 0; k < rows[i].size(); ++k) text += "|---";
      text += "|\n";
    }
  }
  return text;
}

void write_text(const std::string& folder, const std::string& name, const std::string& text) {
  std::filesystem::create_directories(folder);
  const std::string path = folder + "/" + name, part = path + ".part";
  std::ofstream file(part);
  file << text;
  file.close();
  if (!file) throw std::runtime_error("cannot write " + part);
  std::filesystem::rename(part, path);
}

std::string device_line() {
  return device_line(clray_test::device().info());
}

std::string device_line(const clray::DeviceInfo& d) {
  return fmt::format("{} ({}, {} compute units, {})", d.name, d.platform, d.compute_units, d.driver);
}

double median(std::vector<double> values) {
  return quantile(std::move(values), 0.5);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size())) - 1.0;
  return values[static_cast<std::size_t>(std::max(rank, 0.0))];
}

}  // namespace clray_bench
