// SPDX-License-Identifier: Apache-2.0
// What the shared library shows: what public headers declare between these two. Everything else in it is hidden. (An
// attribute of the namespace would not do: clang hides a function that is defined in another block of the namespace.)
#pragma once

#if defined(__GNUC__)
#define CLRAY_API_BEGIN _Pragma("GCC visibility push(default)")
#define CLRAY_API_END _Pragma("GCC visibility pop")
#else
#define CLRAY_API_BEGIN
#define CLRAY_API_END
#endif
