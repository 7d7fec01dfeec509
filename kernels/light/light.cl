// SPDX-License-Identifier: Apache-2.0
// Light on its way: one number for each lane (a variant and band) that a path carries.
#ifndef CLRAY_LIGHT_CL
#define CLRAY_LIGHT_CL

#include "shared/abi.h"

#ifndef CLRAY_LANE_ROOM  // where the number of lanes is known at run time only, the most that there can be
#define CLRAY_LANE_ROOM CLRAY_LANES
#endif

typedef struct Light {
  f64 lane[CLRAY_LANE_ROOM];
} Light;

/// The same in every lane.
static Light light_even(f64 value) {
  Light light;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) light.lane[lane] = value;
  return light;
}

static Light light_scaled(const Light* light, f64 factor) {
  Light scaled;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) scaled.lane[lane] = light->lane[lane] * factor;
  return scaled;
}

/// What `after` has more than `before`.
static Light light_gain(const Light* after, const Light* before) {
  Light gain;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) gain.lane[lane] = after->lane[lane] - before->lane[lane];
  return gain;
}

/// The largest over the lanes.
static f64 light_largest(const Light* light) {
  f64 largest = 0.0;
  for (u32 lane = 0; lane < CLRAY_LANES; ++lane) largest = f64_max(largest, light->lane[lane]);
  return largest;
}

#endif
