// SPDX-License-Identifier: Apache-2.0
// Elementary functions of clray's own, in fp64, bit-identical on every conforming device and host.
#ifndef CLRAY_ELEMENTARY_H
#define CLRAY_ELEMENTARY_H

#include "shared/portable.h"

// el_exp, el_expm1, el_log, el_log1p, el_pow, el_sincos, el_atan2, el_acos, sample_cosine_hemisphere

#endif
