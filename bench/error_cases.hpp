// SPDX-License-Identifier: Apache-2.0
// The cases of clray-bench error: scenes whose total has a closed form.
#pragma once

#include <string>
#include <vector>

#include "support/closed_forms.hpp"

namespace clray_bench {

/// The total is the first of the result: A of a delay camera or spectrometer, |C| of pressure (which differs from the
/// component toward the Sun by the square of the error across only).
struct ErrorCase {
  std::string name;
  clray::Scene scene;
  double exact = 0.0;
  clray_test::Cdf share;     ///< of the pulse by delay, s; empty where bins are not compared
  clray_test::Cdf hits;      ///< of the area that the beam sees, by delay, s: where plain random rays land
  double model_error = 0.0;  ///< relative difference of the scene from its closed form (meshes)
  double load_s = 0.0;       ///< of reading it from files
};

std::vector<ErrorCase> error_cases();

}  // namespace clray_bench
