// SPDX-License-Identifier: Apache-2.0
// Numbers that kernels use in more than one place; shared/portable.h includes them, so the host has them too. The
// constants of physics are the host's alone: include/clray/constants.hpp.
#ifndef CLRAY_CONSTANTS_H
#define CLRAY_CONSTANTS_H

#define CLRAY_PI 3.14159265358979323846
#define CLRAY_INV_PI 0.31830988618379067154
#define CLRAY_TWO_TO_32 4294967296.0
#define CLRAY_TWO_TO_MINUS_32 2.3283064365386963e-10

#endif
