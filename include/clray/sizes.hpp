// SPDX-License-Identifier: Apache-2.0
// How much memory and disk a scene's results take, before anything is traced.
#pragma once

#include "clray/export.hpp"
#include "clray/scene.hpp"

CLRAY_API_BEGIN
namespace clray {

/// Bytes, within a factor of about two; what does not grow with views, lanes, bins or pixels is left out.
struct SceneSizes {
  double memory = 0.0;  ///< of the host, sums and results together
  double disk = 0.0;    ///< of the files without plots
};

/// For a scene that check_scene() accepts.
SceneSizes scene_sizes(const Scene& scene);

/// "about 6.2 GB of memory and 460 MB on disk".
std::string size_text(const Scene& scene);

/// "the results need about 15 PB of memory, and this machine has 25 GB", or "" where it has so many bytes.
std::string memory_fault(double bytes);

/// Plans the histograms whose number of bins follows from `bin_ps` and a window that the body gives, before anything is
/// traced. Throws Error(input) where there are too many bins for a histogram or for this machine. Of other scenes
/// size_fault() knows enough.
void check_windows(const Scene& scene);

/// What is impossible on this machine, or "": more memory than it has, more disk than is free where `folder` will be
/// (not looked at where that is empty).
std::string size_fault(const Scene& scene, const std::string& folder);

}  // namespace clray
CLRAY_API_END
