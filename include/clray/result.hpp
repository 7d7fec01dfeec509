// SPDX-License-Identifier: Apache-2.0
// What a run found: every number with its standard error, per detector, observer, variant, band and
// orientation. SI units (m, s, sr, N); files convert to the units in their column names.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "clray/device.hpp"
#include "clray/scene.hpp"

namespace clray {

/// A number with its error, from the spread of the replicates.
struct Estimate {
  double value = 0.0;
  double standard_error = 0.0;
  double low = 0.0, high = 0.0;  ///< 95 % Student-t interval
  /// How well the squared standard error is known: 0.10 on average for 16 normal replicates, at most 0.82, when one
  /// replicate differs from all others. NaN without any spread.
  double relative_variance_of_variance = 0.0;
  /// Of an exact number, or of its exact part (docs/exact.md): a bound of the rounding error, in its unit. NaN for an
  /// estimate from rays alone.
  double rounding_bound = std::numeric_limits<double>::quiet_NaN();
  /// Of a number whose first bounce alone is solved: that part of the value, which has no standard error. Else NaN.
  double exact_part = std::numeric_limits<double>::quiet_NaN();
  bool tiles = false;  ///< points lay in tiles (docs/exact.md), not on rays

  bool exact() const { return rounding_bound >= 0.0 && std::isnan(exact_part); }
  bool partly_exact() const { return !std::isnan(exact_part); }
};

/// A vector with a standard error per component.
struct VectorEstimate {
  Vec3 value{0.0};
  Vec3 standard_error{0.0};
  Vec3 relative_variance_of_variance{0.0};                           ///< as in Estimate
  double rounding_bound = std::numeric_limits<double>::quiet_NaN();  ///< of each component, as in Estimate
  Vec3 exact_part{std::numeric_limits<double>::quiet_NaN()};         ///< as in Estimate

  bool partly_exact() const { return !std::isnan(exact_part.x); }
};

/// Which member of a run a record belongs to; empty names where there is only one.
struct ResultKey {
  std::string detector;  ///< its shown_name()
  std::string observer;
  std::string variant;
  std::string band;
  std::size_t orientation = 0;  ///< index into Result::orientations
};

/// A place on the Earth at an instant of a pass, as light from the body arrives there (from a station: midway between
/// fire and return).
struct SiteSight {
  int observer = -1;                                             ///< index into Scene::observers; -1: the station
  double range_m = 0.0, elevation_rad = 0.0, azimuth_rad = 0.0;  ///< of the body; azimuth from north over east
  bool seen = false;                                             ///< at or above the pass's least elevation
  double sun_elevation_rad = 0.0;
  bool daylight = false;  ///< the Sun's centre is above -0.833 degrees: sunrise to sunset
};

/// An instant of a pass, traced or not.
struct PassInstant {
  Epoch epoch;
  double time_s = 0.0;          ///< from the pass's start, SI seconds
  double until_s = 0.0;         ///< it holds until then: the next instant, or where the orbit's file ends
  std::string reason;           ///< why it is not traced; empty where it is
  std::size_t orientation = 0;  ///< index into Result::orientations, if it is traced
  bool placed = false;          ///< whether orbit and attitude are known; else nothing below is
  Vec3 position_m{0.0};         ///< gcrf
  Orientation view;             ///< body_to_space: to gcrf
  Vec3 sun{0.0, 0.0, 1.0};      ///< toward the Sun, body frame
  double sun_share = 1.0;       ///< of the Sun's disk past the Earth
  std::vector<SiteSight> sites;
  bool traced() const { return placed && reason.empty(); }
};

/// The delay camera: A(t), see docs/physics.md, section 1.
struct DelayResult {
  ResultKey key;
  Estimate intensity_m2_per_sr;  ///< A, everything including below and above the window
  Estimate mean_delay_s, rms_width_s;
  double first_bin_start_s = 0.0, bin_width_s = 0.0;
  std::vector<double> bin_m2_per_sr;       ///< A per bin (not per second)
  std::vector<double> bin_standard_error;  ///< same unit
  std::vector<double> bin_upper_bound;     ///< for unresolved bins; same unit
  std::vector<std::uint64_t> hits;
  std::vector<std::uint8_t> resolved;
  double below_m2_per_sr = 0.0, above_m2_per_sr = 0.0;
  std::vector<double> photons_per_ns;  ///< expected rate per bin at the station; empty without one
};

/// The one-pixel spectrometer: A in one band.
struct SpectrometerResult {
  ResultKey key;
  Band band;
  Estimate intensity_m2_per_sr;
  double source_W_m2 = 0.0;                                        ///< of the source inside the band
  double received_W_m2 = 0.0, received_W_m2_standard_error = 0.0;  ///< at the observer's range; 0 without one
  double magnitude_AB = 0.0, magnitude_standard_error = 0.0;       ///< NaN without a range
  double magnitude_Vega = 0.0;                                     ///< NaN also where Vega's table has no light
  double phase_angle_rad = 0.0;
  double air_mass = 0.0;        ///< on the way to the observer's site; NaN where none is known
  double extinction_mag = 0.0;  ///< within received power and magnitudes: the observer's, times the air mass
};

/// Radiation force and torque per unit irradiance, net of all bounces.
struct PressureResult {
  ResultKey key;
  Band band;                                               ///< of the light that pushes
  double source_W_m2 = 0.0;                                ///< of the source inside the band
  Vec3 sun{0.0, 0.0, 1.0};                                 ///< toward the source, body frame
  VectorEstimate coefficient_m2;                           ///< C = F c / E
  VectorEstimate torque_coefficient_m3;                    ///< about the reference point
  std::vector<VectorEstimate> component_m2, component_m3;  ///< shares, one per Scene::components
  Estimate absorbed_m2;                                    ///< absorbed power over irradiance
};

/// A picture or cube: radiance over irradiance (1/sr) per pixel and band.
struct ImageResult {
  ResultKey key;
  int width = 0, height = 0;
  double pixel_m = 0.0;                               ///< edge of a pixel at the body
  Vec3 right{1, 0, 0}, up{0, 1, 0}, toward{0, 0, 1};  ///< image axes in the body frame
  double centre_right_m = 0.0, centre_up_m = 0.0;     ///< the picture's centre from the reference point, on those axes
  /// Power over irradiance that leaves the body from mirrors toward no cone and is in no picture, after meeting a
  /// mirror first: by mirrors alone, and with other surfaces between. The largest over the bands.
  double unseen_mirrors_m2 = 0.0, unseen_caustics_m2 = 0.0;
  std::vector<Band> bands;
  std::vector<double> band_source_W_m2;
  std::vector<float> coverage;                ///< [y][x] share of the pixel covered by the body; row 0 on top
  std::vector<double> radiance_per_sr;        ///< [band][y][x] radiance per unit irradiance
  std::vector<double> standard_error_per_sr;  ///< same shape
};

/// The numbers of a sum that a detector's row states with a unit, each with its error.
struct TableResult {
  ResultKey key;
  std::string name;  ///< of the sum
  std::string unit;
  std::vector<Estimate> values;
};

/// Energy books of one variant and band where paths scatter, as power over irradiance, the mean over the orientations
/// (docs/physics.md, section 4). Of a grid of Sun directions, the mean over the grid; `key.detector` then names its
/// detector, else it is empty.
struct EnergyBooks {
  ResultKey key;
  Estimate incident_m2, reflected_m2, absorbed_m2, roulette_m2, truncated_m2, unconnected_specular_m2;
};

/// Paths of all passes, exact: started is the sum of the others.
struct PathCounts {
  std::uint64_t started = 0, escaped = 0, killed = 0, capped = 0;
};

/// One point of error against run time.
struct ErrorPoint {
  std::string phase;                     ///< "search", "confirm" or "trace"
  std::uint64_t rays = 0;                ///< per orientation
  double seconds = 0.0;                  ///< of tracing, from the phase's start
  double relative_standard_error = 0.0;  ///< the largest over all targets; NaN if all totals are zero
  double first_total =
      std::numeric_limits<double>::quiet_NaN();  ///< of the result, in its unit (of a vector its length); NaN: not kept
  double first_standard_error = std::numeric_limits<double>::quiet_NaN();  ///< of first_total; of a vector, along it
};

/// Failures are counted, never hidden. All are zero in a sound run.
struct Diagnostics {
  std::uint64_t non_finite = 0, stack_overflow = 0, lost_rays = 0, accumulator_overflow = 0;
  double below_window_fraction = 0.0, above_window_fraction = 0.0, truncated_energy_fraction = 0.0;
};

struct Seconds {
  double load = 0.0, bvh = 0.0, compile = 0.0, trace = 0.0, total = 0.0;
};

/// Everything a run found.
struct Result {
  DeviceInfo device;
  std::uint64_t seed = 0;
  std::uint64_t rays = 0;        ///< per orientation, of the result (the confirmation's); 0: all numbers are exact
  std::uint64_t rays_total = 0;  ///< traced in all
  int replicates = 0;
  std::uint64_t digest = 0;  ///< of all integer sums: equal digests mean equal results
  bool partial = false;      ///< ended early by a signal or the time limit
  bool target_asked = false, target_reached = false;
  double target_percent = 0.0;  ///< 95 % half-width over the value that was asked for; 0: none
  /// That of the result, the largest over all totals; NaN where all are zero.
  double reached_percent = std::numeric_limits<double>::quiet_NaN();
  /// What ended the tracing: "exact" (nothing was sampled), "target", "zero" (all totals are zero, so no target can be
  /// met), "rays" (as given), "max_rays", "samples" (of a picture's search), "time limit" or "interrupt". If there were
  /// several passes, that of the first that missed the target.
  std::string stopped_by;
  double extent_m = 0.0;  ///< longest side of the box around the body, axes of the body frame
  MeshReport mesh;        ///< all meshes together
  Seconds seconds;
  Diagnostics diagnostics;
  PathCounts paths;
  std::vector<EnergyBooks> energy;          ///< in the order of variants and bands; empty where no path scatters
  std::vector<std::string> kept, left_out;  ///< decisions of specialisation, each with its reason
  std::vector<std::string> warnings;
  std::vector<ErrorPoint> errors;
  std::vector<Orientation> orientations;
  std::vector<DelayResult> delay;
  std::vector<SpectrometerResult> spectrometer;
  std::vector<PressureResult> pressure;
  std::vector<ImageResult> image;     ///< of rgb and hyperspectral detectors
  std::vector<TableResult> table;     ///< of detectors that have sums and no results of their own
  std::vector<PassInstant> instants;  ///< of a pass, all of them
};

/// Files that another part adds to a result, and its entry in the summary.
struct MoreFiles {
  std::vector<std::string> names;         ///< written into the folder given
  std::string summary_key, summary_json;  ///< an entry for summary.json, as JSON text; empty for none
  std::string text = {};                  ///< shown to a person at the end of a run; may be empty
};

/// How to write results.
struct WriteOptions {
  bool plots = true;
  bool netcdf = false;                           ///< also NetCDF files, beside the tables and cubes that have one
  std::string command;                           ///< as typed, for the summary
  std::string reference_file;                    ///< a summary.json or delay.csv to measure the true error against
  std::vector<std::string>* warnings = nullptr;  ///< receives what went wrong without harm (no gnuplot, …)
  const std::atomic<bool>* stop = nullptr;       ///< once set, no more plots are drawn
  /// Called with the unfinished folder; what it writes there appears with the rest, or not at all.
  std::vector<std::function<MoreFiles(const std::string& folder)>> more;
};

/// Checks that the parts of a result fit each other and the scene (sizes, orientations), as those of trace() do.
/// What writes results calls it. Throws Error(usage) with the member's path.
void check_result(const Result& result, const Scene& scene);

/// Writes summary.json, tables and pictures into `folder`, which appears (or is replaced) only whole.
/// Returns the file names written. Throws Error(output); Error(input, usage) for a scene or result that cannot be.
std::vector<std::string> write_result(const Result& result, const Scene& scene, const std::string& folder,
                                      const WriteOptions& options = {});

/// Whether write_result() could put a result at `folder`: throws Error(output) where it could not, because something
/// that is not a clray result stands there or the place cannot be written. Leaves nothing behind.
void check_output(const std::string& folder);

/// Where a result belongs that was meant for `folder`: there, unless an interrupt ended it and a result stands there
/// that is complete or has more rays. Then it is the folder's name with ".partial".
std::string result_folder(const Result& result, const std::string& folder);

/// Totals to measure the true error against, by "detector/observer/variant/band/orientation"; behind it "/sum/number"
/// for sums that are results by themselves. In the units of the totals in summary.json.
struct Reference {
  std::string file;
  std::map<std::string, double> totals;
};

/// Reads a summary.json or a delay.csv. Throws Error(input).
Reference load_reference(const std::string& file);

/// The largest |total − reference| / |reference| over the totals that both have; NaN where they share none.
double relative_true_error(const Result& result, const Reference& reference);

/// What a person wants to see of a result first, as UTF-8 text.
struct ResultText {
  std::vector<std::pair<std::string, std::string>>
      rows;            ///< of a single record: what, and its value with error and unit
  std::string tables;  ///< of all others, each behind an empty line
  std::string totals;  ///< a line for each record or number
};
ResultText describe_result(const Result& result);

/// "1.2345 ± 0.0012": a number rounded to two digits of its error, in powers of ten where that reads better.
std::string format_with_error(double value, double error);

/// Shots of a laser-ranging session over the motion of `scene`, from its delay results (docs/physics.md, section 5);
/// written by write_result() where the scene has a station and a motion.
struct SessionSummary {
  std::uint64_t shots = 0, signal = 0, noise = 0, none = 0;
};

}  // namespace clray
