// SPDX-License-Identifier: Apache-2.0
// Whether a detector's numbers are solved or sampled, and why (docs/exact.md).
#pragma once

#include <cstddef>
#include <string>

#include "body/geometry.hpp"

namespace clray {

/// How numbers come about.
enum class PassMethod {
  points,       ///< rays find all of them
  first_exact,  ///< the first bounce is solved, rays find the rest
  tiles,        ///< tiles that one face covers are solved, points see what is in the others: no rays
  exact         ///< all are solved: no points, one replicate
};

/// How those of a detector do.
struct MethodChoice {
  PassMethod how = PassMethod::points;
  std::string why;
};

/// "points", "first bounce exact", "tiles" or "exact".
std::string method_name(PassMethod how);

/// Whether all numbers of a scene may turn out to be exact, so that no trees are needed; only its faces are not asked.
bool may_need_no_rays(const Scene& scene);

/// The method for a detector of the beam in so many views. Throws Error(input) where the scene asks for exact numbers
/// and they cannot be had.
MethodChoice choose_method(const Scene& scene, const Geometry& geometry, const DetectorSpec& detector,
                           std::size_t views);

}  // namespace clray
