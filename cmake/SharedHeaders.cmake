# SPDX-License-Identifier: Apache-2.0
# Headers that nearly every file reads, compiled once: clray_own_shared_headers() makes them for one target,
# clray_use_shared_headers() gives them to others that are compiled with the same options. They save a third of a build
# from nothing. A launcher such as ccache finds more without them, so they are left out beside one; that also shows
# whether each file includes what it uses.
set(CLRAY_SHARED_HEADERS
    <fmt/format.h> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory> <optional>
    <set> <string> <vector> <clray/error.hpp> <clray/result.hpp> <clray/scene.hpp>)

if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
  add_compile_options(-pthread)  # users of OpenEXR have it, and one set of headers must do for all
endif()

function(clray_own_shared_headers target)
  if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
    target_precompile_headers(${target} PRIVATE ${CLRAY_SHARED_HEADERS} ${ARGN})
  endif()
endfunction()

function(clray_use_shared_headers target owner)
  if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()
