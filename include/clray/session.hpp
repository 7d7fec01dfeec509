// SPDX-License-Identifier: Apache-2.0
// Laser ranging: from the delay camera's A(t) to what a station records (docs/physics.md, section 5): expected photon
// rates, the link budget, and sessions of single-photon shots as tables, a picture and ILRS CRD v2 full-rate data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clray/export.hpp"
#include "clray/result.hpp"
#include "clray/write.hpp"

CLRAY_API_BEGIN
namespace clray {

/// Shots of a laser-ranging session over the motion of `scene`, from its delay results (docs/physics.md, section 5);
/// written by write_result() where the scene has a station and a motion.
struct SessionSummary {
  std::uint64_t shots = 0;   ///< fired
  std::uint64_t signal = 0;  ///< that detected a photon of the body
  std::uint64_t noise = 0;   ///< that detected another
  std::uint64_t none = 0;    ///< that detected nothing
};

/// How to run a session.
struct SessionOptions {
  bool plots = true;                  ///< also draw the picture
  Device* device = nullptr;           ///< samples the shots there; else on this machine's cores. Same bits either way.
  int threads = 0;                    ///< of the host; 0: one per core
  std::uint64_t first_shot = 0;       ///< redo a part alone: from this shot on
  std::uint64_t shots = 0;            ///< so many shots; 0: to the end of the motion
  std::string stem = "observations";  ///< of the file names
  /// Which delay results: names as in ResultKey. All empty: the first group seen from the source.
  std::string detector;
  std::string observer;                          ///< the same
  std::string variant;                           ///< the same
  std::vector<std::string>* warnings = nullptr;  ///< receives what went wrong without harm
};

/// Samples all shots of the session and writes `<stem>.csv`, `<stem>.crd` and `<stem>.png` into the existing `folder`.
/// Needs scene.station, scene.motion and a laser; the seed is result.seed. Memory does not grow with the shots.
/// Throws Error(input) for a station that makes no sense, Error(output) where a file cannot be written.
SessionSummary write_session(const Result& result, const Scene& scene, const std::string& folder,
                             const SessionOptions& options = {});

/// The same for WriteOptions::more: one session for each group of delay results seen from the source (several
/// variants or detectors have their names in the file names), with the link budget in the summary entry "session".
MoreFiles session_files(const Result& result, const Scene& scene, const std::string& folder,
                        const SessionOptions& options = {});

/// Whether a scene makes a session: it has a station, a motion, a laser and an observer at the source.
bool has_session(const Scene& scene);

/// Expected signal photons per ns in each bin of `delay` at that range, transmit pulse included. What the pulse carries
/// out of the window is left out. Throws Error(input) for a station or range that makes no sense.
std::vector<double> photons_per_ns(const DelayResult& delay, const Station& station, double range_m,
                                   double wavelength_nm = 532.0);

/// Fills in `photons_per_ns` of all delay results of a scene with a station and a laser. Each is at the range of its
/// orientation's time. An observer who is not at the station has the station's receiver, and a range of his own or else
/// the station's. Throws Error(input).
void expect_photons(const Scene& scene, Result* result);

/// The link budget of a result's first delay record, for a person: every factor with its value, unit, default and
/// range, and the photons per pulse. Empty without a station, a laser or a delay record. Throws Error(input).
std::string link_budget_text(const Scene& scene, const Result& result);

}  // namespace clray
CLRAY_API_END
