// SPDX-License-Identifier: Apache-2.0
// What the shared library shows: the namespace of the public headers. Everything else in it is hidden.
#pragma once

#if defined(__GNUC__)
#define CLRAY_API [[gnu::visibility("default")]]
#else
#define CLRAY_API
#endif
