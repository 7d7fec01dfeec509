// SPDX-License-Identifier: Apache-2.0
// From a scene's motion to the orientations that are traced: light and observers in the body frame at each step.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "clray/result.hpp"

namespace clray {

/// The most steps that a motion may have.
constexpr double kMaxOrientations = 1e7;

/// First and last time of a motion, s: start_s and stop_s, or the ends of a table of which both are 0.
std::pair<double, double> motion_span(const Motion& motion);

/// Steps of a motion: spin has one at start_s and one after each full step up to and including stop_s; a table one at
/// start_s and one per entry after it up to stop_s (all entries where both are 0). Throws Error(input) if too many.
std::size_t orientation_count(const Motion& motion);

/// One entry per step of the motion (one, the identity, without motion). Whole turns are removed before any
/// trigonometry, which is clray's own (shared/elementary.h), so the result has the same bits on every host.
std::vector<Orientation> orientations(const Scene& scene);

/// Attitude at any time within the motion (slerp between table entries). Throws Error(input) outside it.
Quaternion attitude_at(const Motion& motion, double time_s);

/// Angle to turn a hinge by, rad, so that the component's +z comes nearest to the direction that it follows
/// (body frame); the fixed angle_rad where it follows nothing.
double hinge_angle(const Hinge& hinge, const Transform& transform, const Vec3& source, const Vec3& observer);

}  // namespace clray
