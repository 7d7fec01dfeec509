// SPDX-License-Identifier: Apache-2.0
// What is traced: components with their shapes and materials, the source, the observers, the motion,
// the station and the detectors. Filled from a file by load_scene() or by hand by a host application.
// Frame: the body frame (the mesh frame), metres, radians, seconds; unit vectors point away from the body.
#pragma once

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clray/constants.hpp"
#include "clray/detector.hpp"
#include "clray/error.hpp"
#include "clray/export.hpp"
#include "clray/trace.hpp"

/// The library: scenes, devices, traces, results.
CLRAY_API_BEGIN
namespace clray {

/// Three numbers: x, y, z.
using Vec3 = glm::dvec3;
/// w, x, y, z, made in this order: Quaternion(w, x, y, z).
using Quaternion = glm::dquat;

/// An epoch of UTC: a Modified Julian Date and picoseconds of that day, which has 86401 s where it ends with a leap
/// second.
struct Epoch {
  std::int64_t mjd = 0;  ///< day
  std::int64_t ps = 0;   ///< of the day, 0 up to its length
};

/// A quantity against wavelength, linear between its points. Beyond them a surface's quantity is constant; a source
/// sends nothing there, and a filter passes nothing.
/// Wavelengths in nm, strictly increasing, at least one point.
struct Spectrum {
  std::vector<double> wavelength_nm;  ///< strictly increasing
  std::vector<double> value;          ///< at those wavelengths
};

/// A tabulated isotropic BRDF: f in 1/sr on a grid of angles, see docs/scene-file.md.
struct BrdfTable {
  std::vector<double> theta_i_rad;  ///< of the light to the normal, increasing, in [0, pi/2]
  std::vector<double> theta_o_rad;  ///< of the view, the same
  std::vector<double> phi_rad;      ///< azimuth between them, increasing, in [0, pi]; 0: on one side of the normal
  std::vector<double> value;        ///< [theta_i][theta_o][phi], 1/sr
};

/// Surface reflection: a row of brdf.def and its parameters.
struct Material {
  std::string name;                          ///< unique among the materials
  std::string model = "lambert";             ///< scene-file name of a row of brdf.def
  std::map<std::string, double> parameters;  ///< by the row's keys; an absent key takes its default
  std::map<std::string, Spectrum> spectra;   ///< keys given as spectra; they override `parameters`
  bool two_sided = true;                     ///< false: the back reflects nothing
  std::shared_ptr<const BrdfTable> table;    ///< for "tabulated"
  /// Infrared (thermal) reflectance in [0,1]; used by thermal re-radiation only.
  double infrared_reflectance = 0.0;
};

/// What a mesh reader found; counted from the file's own indices.
struct MeshReport {
  std::uint64_t faces = 0;               ///< polygons in the file
  std::uint64_t triangles = 0;           ///< after triangulation
  double area_m2 = 0.0;                  ///< sum over all triangles
  std::uint64_t degenerate = 0;          ///< triangles of zero area
  std::uint64_t boundary_edges = 0;      ///< edges with one face
  std::uint64_t non_manifold_edges = 0;  ///< edges with more than two faces, or two that disagree in winding
};

/// A triangle mesh in metres, in the order of its file.
struct Mesh {
  std::vector<Vec3> vertices;                           ///< m, frame of the component
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<std::uint32_t> triangle_slot;             ///< index into material_slots, one per triangle
  std::vector<std::string> material_slots;              ///< names from usemtl; at least one entry, "" if none
  std::vector<Material> file_materials;                 ///< from the MTL; matched to slots by name
  MeshReport report;                                    ///< what the reader counted
  std::vector<std::string> warnings;                    ///< e.g. a missing MTL, with file:line
};

/// scale, then rotate about `axis` (right-handed), then translate.
struct Transform {
  Vec3 translate{0.0};       ///< m
  Vec3 axis{0.0, 0.0, 1.0};  ///< any length above 0
  double angle_rad = 0.0;    ///< right-handed
  double scale = 1.0;        ///< > 0
};

/// A joint that turns a component about a line; `follow` turns its +z toward the source or the observer.
struct Hinge {
  /// What a hinge turns toward.
  enum class Follow {
    none,     ///< nothing: its angle holds
    source,   ///< the source
    observer  ///< the first observer
  };
  Vec3 axis{1.0, 0.0, 0.0};      ///< direction of the line, body frame; any length above 0
  Vec3 point{0.0};               ///< on the line, body frame, m
  double angle_rad = 0.0;        ///< right-handed; where the hinge follows nothing, or no angle is better than another
  Follow follow = Follow::none;  ///< what turns it
};

/// One part of the body.
struct Component {
  std::string name;                          ///< unique among the components
  std::string shape = "mesh";                ///< scene-file name of a row of shape.def
  std::map<std::string, double> parameters;  ///< by the row's keys (lengths in m; booleans 0 or 1)
  std::shared_ptr<const Mesh> mesh;          ///< for "mesh"; instances share it
  std::vector<std::uint32_t> materials;      ///< index into Scene::materials, one per mesh slot (one for a shape)
  Transform transform;                       ///< of the shape or mesh into the body frame
  std::optional<Hinge> hinge;                ///< turns the component after its transform
};

/// A wavelength interval with a name such as "400-500".
struct Band {
  std::string name;      ///< unique among the bands of a source
  double low_nm = 0.0;   ///< shortest wavelength that passes
  double high_nm = 0.0;  ///< longest wavelength that passes
  /// Transmission of a filter against wavelength, any scale; null: a top hat. Nothing passes outside [low, high]
  /// nor beyond the table's ends.
  std::shared_ptr<const Spectrum> response = nullptr;
  double vega_magnitude = 0.0;  ///< of Vega in this band, which is the zero point of Vega magnitudes
  bool in_vega = false;         ///< whether observers state magnitudes of this band in the Vega system, else in AB
};

/// The filters that clray knows by name: "B", "V", "R", "I" (Johnson-Cousins), "G" (Gaia), "g", "r", "i", "z" (Sloan).
const std::vector<std::string>& photometric_bands();

/// One of them; host/scene/photometry/README.md has their sources. Throws Error(input) for another name.
Band photometric_band(const std::string& name);

/// The Sun at 1 au, 119.5 to 10000 nm, W/m²/nm.
const Spectrum& solar_spectrum();

/// Frames of orbits and directions, geocentric.
enum class Frame {
  gcrf,     ///< axes of the ICRF
  eme2000,  ///< mean equator and equinox of J2000
  tod,      ///< true equator and equinox of date
  teme,     ///< true equator, mean equinox, as of two-line elements
  itrf      ///< fixed to the Earth
};

/// What gives a direction from the body at the instants of a pass. Without a pass it is always `fixed`.
enum class Toward {
  fixed,    ///< a vector; in a pass of the frame gcrf
  sun,      ///< the Sun, computed
  station,  ///< the place of the [station]
  site,     ///< a place of its own (observers)
  table     ///< rows by time
};

/// Directions from a table; linear between its rows.
struct Directions {
  /// A direction at a time.
  struct Row {
    double time_s = 0.0;            ///< from the pass's start
    Vec3 direction{0.0, 0.0, 1.0};  ///< unit vector away from the body
    double range_m = 0.0;           ///< 0: not known
  };
  std::string file;           ///< of `rows`, as a scene file names it; empty if they were filled by hand
  bool in_body = false;       ///< in the body frame, else in `frame`
  Frame frame = Frame::gcrf;  ///< gcrf or itrf
  std::vector<Row> rows;      ///< times increasing
};

/// The light: parallel, of unit irradiance unless a detector states otherwise.
struct Source {
  /// What shines.
  enum class Kind {
    laser,  ///< one wavelength
    sun     ///< a spectrum, in bands
  };
  Kind kind = Kind::laser;           ///< of the light
  Vec3 direction{0.0, 0.0, 1.0};     ///< unit vector toward the source, if that is fixed
  double wavelength_nm = 532.0;      ///< of a laser
  std::vector<Band> bands;           ///< empty: the laser line; a sun's 400-700 nm, for pressure all its light
  std::optional<Spectrum> spectrum;  ///< W/m²/nm; a sun without one is Planck at 5772 K
  double blackbody_K = 0.0;          ///< > 0: Planck at this temperature, scaled to irradiance_W_m2
  double irradiance_W_m2 = constants::kSolarConstant_W_m2;  ///< of a sun or blackbody, all wavelengths
  Toward toward = Toward::fixed;                            ///< what gives the direction
  Directions directions{};                                  ///< of Toward::table
};

/// Who looks. `monostatic` puts the observer exactly at the source, whatever the direction says.
struct Observer {
  std::string name;               ///< needed, and unique, where there are several
  Vec3 direction{0.0, 0.0, 1.0};  ///< unit vector toward the observer, if that is fixed
  bool monostatic = true;         ///< at the source
  double acceptance_rad = 0.0;    ///< half angle of the cone that collects mirror reflections; 0: none
  double range_m = 0.0;           ///< distance, for received power and magnitude; 0: that of the station, if any
  Toward toward = Toward::fixed;  ///< what gives the direction
  Vec3 site_m{0.0};               ///< of Toward::site: its place, Earth-fixed
  Directions directions{};        ///< of Toward::table
  /// Magnitudes that the atmosphere takes per air mass, by the name of a band; "": in every band. Of a site in a pass.
  std::map<std::string, double> extinction_mag{};
};

/// Whether an observer is at the source: the scene says so, or the two are the same place, or the two fixed directions
/// are equal bit for bit.
inline bool at_source(const Observer& observer, const Source& source) {
  if (observer.monostatic) return true;
  if (observer.toward != source.toward) return false;
  if (source.toward == Toward::fixed) return observer.direction == source.direction;
  return source.toward == Toward::station || source.toward == Toward::sun;
}

/// Body-to-space attitude at a time.
struct Attitude {
  double time_s = 0.0;                           ///< of the motion's or the pass's clock
  Quaternion body_to_space{1.0, 0.0, 0.0, 0.0};  ///< unit quaternion: turns vectors of the body frame into space
};

/// Spin about a fixed axis, or a table of attitudes (then `attitudes` is not empty).
struct Motion {
  Vec3 axis{0.0, 0.0, 1.0};         ///< of spin, right-handed, the same in body and space; any length above 0
  double period_s = 0.0;            ///< of a turn, > 0
  double phase_rad = 0.0;           ///< attitude at time 0
  double start_s = 0.0;             ///< time of the first orientation
  double stop_s = 0.0;              ///< no orientation after it
  double step_rad = 0.0;            ///< of spin; an orientation is that at its step's start
  std::vector<Attitude> attitudes;  ///< a table, times increasing; empty for a spin
};

/// One view of the body: a time, how the body stands, where light comes from, and who looks from where. An instant of
/// the motion is one (a single one, the identity, without motion), a direction of a grid is another.
struct Orientation {
  double time_s = 0.0;                           ///< of the motion's or the pass's clock
  Quaternion body_to_space{1.0, 0.0, 0.0, 0.0};  ///< unit quaternion: turns vectors of the body frame into space
  Vec3 source{0.0, 0.0, 1.0};                    ///< toward the source, body frame
  std::vector<Vec3> observers{};                 ///< body frame, one per Scene::observers
  std::vector<double> ranges_m{};                ///< to each observer at that time; 0: not known
  double light = 1.0;           ///< irradiance of the source, as a share of the one that the scene states
  double source_range_m = 0.0;  ///< to a laser's station; 0: not known
  /// Of the body over the horizon of each observer's site; NaN, or no entry, where there is none.
  std::vector<double> elevations_rad{};
};

/// How the body stands during a pass: its axes lie along those of the law, turned by the offset.
struct PassAttitude {
  /// Where the axes of the body lie.
  enum class Law {
    inertial,            ///< along gcrf
    nadir,               ///< z to the Earth's centre, y against the orbit's normal, x ahead
    nadir_yaw_steering,  ///< z to the Earth's centre, x toward the Sun
    sun_pointing,        ///< z to the Sun
    spin                 ///< turning about spin_axis
  };
  Law law = Law::inertial;           ///< where there is neither a file nor a table
  std::string file;                  ///< a CCSDS AEM; replaces the law
  std::string attitudes_file;        ///< of `attitudes`; empty if they were filled by hand
  std::vector<Attitude> attitudes;   ///< a table, body to gcrf, times from the pass's start; replaces the law
  Vec3 spin_axis{0.0, 0.0, 1.0};     ///< right-handed, the same in the body and in the spin's frame
  double spin_period_s = 0.0;        ///< of Law::spin
  double spin_phase_rad = 0.0;       ///< at the pass's start
  bool spin_in_orbit_frame = false;  ///< else in gcrf
  Vec3 offset_axis{0.0, 0.0, 1.0};   ///< the body is turned about it, from the law's axes
  double offset_rad = 0.0;           ///< by so much, right-handed
};

/// A pass: a body on its orbit, at its instants. Light and observers then move by themselves (docs/physics.md, section
/// 10). Instead of a motion.
struct Pass {
  Epoch start;                                ///< MJD 0: not given
  double stop_s = 0.0;                        ///< from the start, in SI seconds
  double step_s = 0.0;                        ///< from instant to instant, or
  double step_rad = 0.0;                      ///< as few instants as hold this angle, or
  std::string times_file;                     ///< of `times_s`; empty if they were filled by hand
  std::vector<double> times_s;                ///< the instants themselves, from the start, increasing
  std::string ephemeris;                      ///< file: ILRS CPF, CCSDS OEM, or a table of states
  Frame frame = Frame::gcrf;                  ///< of a table of states
  std::string eop;                            ///< file of UT1 - UTC and polar motion; empty: both zero
  double min_elevation_rad = 0.0;             ///< of the body over the horizon of a site or station
  bool aberration = false;                    ///< directions as the moving body meets them
  PassAttitude attitude;                      ///< how the body stands
  std::map<std::string, std::string> places;  ///< where keys stand in the scene file, for messages
};

/// A laser-ranging station and its link (docs/physics.md, section 5); defaults are those printed by a run.
struct Station {
  std::string file;            ///< what the scene leaves out is read from this station file; empty: there is none
  std::string name = "clray";  ///< in CRD files
  double range_m = 1.0e6;      ///< fixed range, when neither table nor prediction is given
  std::vector<std::pair<double, double>> ranges;  ///< (time_s, range_m), increasing time
  std::string cpf_file;                           ///< an ILRS prediction (CPF); needs position_m
  Vec3 position_m{0.0};                           ///< Earth-fixed
  double start_mjd = 0.0;                         ///< epoch of session time 0 (UTC); 0: the CPF's first record
  double pulse_energy_J = 0.08;                   ///< of the transmitted pulse
  double pulse_fwhm_s = 0.0;                      ///< 0: a delta pulse
  std::vector<std::pair<double, double>> pulse;   ///< (time_s, relative power) table; overrides fwhm
  double rate_Hz = 2000.0;                        ///< of shots
  double aperture_m = 0.5;                        ///< receiver diameter
  double divergence_rad = 25.0e-6;                ///< 1/e² half-angle
  double pointing_rad = 0.0;                      ///< error of the beam's pointing
  double eta_q = 1.0;                             ///< quantum efficiency of the detector, 0 to 1
  double eta_t = 1.0;                             ///< transmission of the transmitting optics, 0 to 1
  double eta_r = 1.0;                             ///< transmission of the receiving optics, 0 to 1
  double T_a = 1.0;                               ///< one-way transmission of the atmosphere, 0 to 1
  double T_c = 1.0;                               ///< one-way transmission of cirrus, 0 to 1
  double noise_per_ns = 0.001;                    ///< photons of the sky that are detected while the gate is open
  double dark_per_ns = 0.0;                       ///< counts of the detector without light
  double gate_s = 100.0e-9;                       ///< length of the window, centred on the expected return
  double jitter_fwhm_s = 0.0;                     ///< of the timing, Gaussian
  double dead_time_s = 0.0;                       ///< of the detector, after each count
  bool flag_signal = false;                       ///< CRD filter flag 1 noise, 2 signal; else 0
  double normal_point_s = 0.0;                    ///< bins of normal points, from the start of the UTC day; 0: none
  // What CRD files say of the station; it changes no range.
  int pad = 0;                    ///< its pad in the International Laser Ranging Service
  int system = 0;                 ///< its system number there
  int occupancy = 0;              ///< its occupancy sequence number there
  std::string network = "na";     ///< its network in the same files
  double pressure_hPa = 1013.25;  ///< of the standard atmosphere
  double temperature_K = 288.15;  ///< of the standard atmosphere
  double humidity_percent = 0.0;  ///< relative
};

/// Reads a station file (TOML): the keys of a scene's [station]. Throws Error(input) with file:line:column.
Station load_station(const std::string& path);

/// Replacements of materials under which the same hits are shaded again.
struct Variant {
  std::string name;                 ///< unique among the variants
  std::vector<Material> materials;  ///< replace the scene's materials of the same name
};

/// Everything a run needs.
struct Scene {
  std::string path;                     ///< as given by the user, empty if built by hand
  std::string name;                     ///< stem of the path
  Vec3 reference_point{0.0};            ///< delay zero and torque point, m
  std::vector<Material> materials;      ///< that components name by their index
  std::vector<Component> components;    ///< at least one
  std::vector<Variant> variants;        ///< each is one more result for the same rays; none: the materials as they are
  Source source;                        ///< the light
  std::vector<Observer> observers;      ///< at least one after load_scene()
  std::optional<Motion> motion;         ///< none: one view, the body frame at rest in space
  std::optional<Station> station;       ///< for sessions and expected photons
  std::vector<DetectorSpec> detectors;  ///< at least one after load_scene()
  TraceOptions trace;                   ///< how many rays, when to stop
  std::vector<std::string> warnings;    ///< of the reader, each with its place in the file
  std::optional<Pass> pass;             ///< instead of a motion
  /// Views given one by one, instead of a motion or a pass. Their `observers` may be empty: then an observer at the
  /// source looks along the view's `source`, and another along its own direction. Without `ranges_m` the ranges are
  /// those of observers and station.
  std::vector<Orientation> views{};
};

/// What the command line may say about a scene; it overrides the file.
struct SceneOptions {
  double length_unit_m = 0.0;          ///< of mesh files; 0: what the scene file says, or metres
  std::string material;                ///< "model key=value …": overrides every material
  std::optional<Vec3> source;          ///< unit vector toward the source
  std::optional<Vec3> observer;        ///< unit vector toward the first observer
  bool observer_at_source = false;     ///< the first observer is at the source
  std::vector<std::string> detectors;  ///< kinds; replace the file's list
  std::optional<int> bins;             ///< of every delay detector
  /// Meshes in memory, by the names that components of a scene file give as `file`; no file is looked for then.
  std::map<std::string, std::shared_ptr<const Mesh>> meshes{};
  /// Files that stand anywhere, by the names that keys of a scene file give them: what to open instead.
  std::map<std::string, std::string> files{};
};

/// Reads a scene file (.toml) or a bare mesh (.obj .ply .stl .off).
/// Throws Error(input) with file:line[:column], the key, and what was expected.
Scene load_scene(const std::string& path, const SceneOptions& options = {});

/// The same from the text of a scene file. `path` is where it would stand: messages name it, and files are looked for
/// beside it.
Scene parse_scene(const std::string& text, const std::string& path, const SceneOptions& options = {});

/// An error that names a member of a scene ("detectors[0].bins"), as those of trace() and check_scene() do, as one that
/// names its place in the scene file: file, line and column, or the file alone where it does not speak of the member.
/// Other errors, and those of scenes that are not from a readable scene file, stay as they are.
Error placed_in_file(const Error& error, const std::string& path);

/// A mesh in memory, of one material slot: vertices in metres, triangles counter-clockwise seen from outside. Throws
/// Error(input) for vertices that there are not, or where all is without area.
std::shared_ptr<const Mesh> make_mesh(std::vector<Vec3> vertices,
                                      const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// Reads one mesh file; coordinates are multiplied by `length_unit_m`. Throws Error(input).
std::shared_ptr<const Mesh> load_mesh(const std::string& path, double length_unit_m = 1.0);

/// Checks a scene built by hand as load_scene() checks one from a file. Throws Error(input).
void check_scene(const Scene& scene);

/// What clray understood of a scene, for a person: components, materials, extents, light, detectors. Throws as
/// check_scene() does.
std::string describe_scene(const Scene& scene);

}  // namespace clray
CLRAY_API_END
