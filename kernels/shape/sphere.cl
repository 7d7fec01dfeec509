// SPDX-License-Identifier: Apache-2.0
// Sphere of radius p[0] about the origin.
#include "shape/shape.h"
