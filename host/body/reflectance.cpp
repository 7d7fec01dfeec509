// SPDX-License-Identifier: Apache-2.0
// See reflectance.hpp. An interval is halved until the line over it meets the function in the middle and at the
// quarters.
#include "body/reflectance.hpp"

#include <algorithm>
#include <cmath>

#include "shared/elementary.h"

namespace clray {
namespace {

constexpr double kLeastMu = 0x1p-40;      // stands for mu = 0, where models may be singular
constexpr double kLeastWidth = 0x1p-40;   // of an interval: a step in a table becomes a ramp of this width
constexpr std::size_t kMostNodes = 4096;  // beyond them a function that is rough everywhere is halved no further

struct Node {
  double mu, value;
};

class Table {
 public:
  explicit Table(const std::function<double(double)>& reflectance) : reflectance_(reflectance) {}

  std::vector<Node> build(const std::vector<double>& seeds) {
    Node last = node(seeds.front());
    nodes_.push_back(last);
    for (std::size_t k = 1; k < seeds.size(); ++k) {
      const Node next = node(seeds[k]);
      refine(last, between(last, next), next);
      last = next;
    }
    return std::move(nodes_);
  }

 private:
  Node node(double mu) const { return {mu, reflectance_(std::max(mu, kLeastMu))}; }
  Node between(const Node& a, const Node& b) const { return node(a.mu + 0.5 * (b.mu - a.mu)); }

  /// Appends the nodes after `a` up to and including `b`; `middle` is the node between them.
  void refine(const Node& a, const Node& middle, const Node& b) {
    const Node first = between(a, middle), last = between(middle, b);
    if (b.mu - a.mu > kLeastWidth && nodes_.size() < kMostNodes &&
        !(straight(a, middle, b) && straight(a, first, middle) && straight(middle, last, b))) {
      refine(a, first, middle);
      refine(middle, last, b);
    } else {
      nodes_.push_back(b);
    }
  }

  static bool straight(const Node& a, const Node& middle, const Node& b) {
    return std::fabs(0.5 * (a.value + b.value) - middle.value) <= 0.5 * kReflectanceError;
  }

  const std::function<double(double)>& reflectance_;
  std::vector<Node> nodes_;
};

}  // namespace

std::vector<double> reflectance_table(const std::function<double(double)>& reflectance,
                                      const std::vector<double>& theta_rad) {
  std::vector<double> seeds{0.0, 0.375, 0.75, 1.0};
  for (double mu = 0x1p-24; mu < 1.0; mu *= 4.0) seeds.push_back(mu);  // grazing incidence has features of any scale
  for (const double theta : theta_rad) {
    double s, c;
    el_sincos(theta, &s, &c);
    if (c > 0.0 && c < 1.0) seeds.push_back(c);
  }
  std::sort(seeds.begin(), seeds.end());
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  const std::vector<Node> nodes = Table(reflectance).build(seeds);
  std::vector<double> table{static_cast<double>(nodes.size())};
  for (const Node& node : nodes) table.push_back(node.mu);
  for (const Node& node : nodes) table.push_back(node.value);
  return table;
}

}  // namespace clray
