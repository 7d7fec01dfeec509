// SPDX-License-Identifier: Apache-2.0
// The cases of clray-bench error: scenes whose total has a closed form.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/closed_forms.hpp"

namespace clray_bench {

struct Found {
  double value = 0.0, standard_error = 0.0;
};

struct ErrorCase {
  std::string name;
  clray::Scene scene;
  double exact = 0.0;
  std::function<Found(const clray::Result&)> found;
  std::function<double(double)> share;  ///< CDF of the pulse, s; empty where bins are not compared
  double model_error = 0.0;             ///< relative difference of the scene from its closed form (meshes)
};

std::vector<ErrorCase> error_cases();

}  // namespace clray_bench
