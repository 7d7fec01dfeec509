// SPDX-License-Identifier: Apache-2.0
// Every struct that crosses between host and device. Only 32- and 64-bit scalars and arrays of them; padding is
// explicit; sizes are asserted on both sides.
#ifndef CLRAY_ABI_H
#define CLRAY_ABI_H

#include "shared/portable.h"

#define CLRAY_MATERIAL_PARAMETERS 12

#define CLRAY_MATERIAL_TWO_SIDED 1u

/// One material under one lane (variant and band). p: the row's keys in order, then derived numbers.
typedef struct ClrayMaterial {
  u32 model;            // row number in brdf.def
  u32 flags;
  u32 table;            // offset of the model's own table in `tables`
  u32 reflectance;      // offset of the directional-reflectance table in `tables`
  f64 p[CLRAY_MATERIAL_PARAMETERS];
} ClrayMaterial;

#ifdef __cplusplus
static_assert(sizeof(ClrayMaterial) == 112, "abi");
#endif

#endif
