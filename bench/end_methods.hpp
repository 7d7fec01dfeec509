// SPDX-License-Identifier: Apache-2.0
// The methods that clray-bench end holds against each other. A method has efforts (counts of points, or what else makes
// it work longer), and at an effort and a seed it gives a total and bins in a time. Another method is another row.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench.hpp"
#include "clray/device.hpp"
#include "clray/scene.hpp"

namespace clray_bench {

/// A pulse, and what finding it took.
struct Answer {
  double total = 0.0;        ///< m²/sr
  std::vector<double> bins;  ///< m²/sr
  double seconds = 0.0;      ///< of tracing
  double prepared_s = 0.0;   ///< of geometry and trees, before it
};

struct EndMethod {
  std::string name;
  bool ends = false;         ///< it gives the exact answer: one effort, errors are zero
  std::vector<int> efforts;  ///< ascending; one more is twice the work
  std::function<Answer(int effort, std::uint64_t seed)> run;
};

/// A body to be measured: a scene of one Lambert mesh, lit and seen from one place, with a delay detector.
struct EndCase {
  std::string name;
  clray::Scene scene;
};

/// clray's own methods. Efforts are log2 of rays.
std::vector<EndMethod> clray_methods(const EndCase& which, const std::vector<int>& log2_rays, clray::Device& device);

/// The rival: an own tracer on Embree, with points of a jittered grid and with random points (end_embree.cpp). Empty
/// where clray-bench was built without Embree. `window`: the bins of the exact answer. *about says how near it comes to
/// bare intersection.
struct Window {
  double first_s = 0.0, width_s = 0.0;
  std::size_t bins = 0;
};
std::vector<EndMethod> embree_methods(const EndCase& which, const Window& window, const std::vector<int>& log2_rays,
                                      std::string* about);

/// Its version, or that it is left out.
std::string embree_line();

}  // namespace clray_bench
