// SPDX-License-Identifier: Apache-2.0
// Keys of a pass that have a form of their own (key_forms.hpp): dates, files, places, tables with a frame. Tables by
// time are read afterwards (scene_toml_pass.cpp), as their times may count from the pass's start.
#include <fmt/format.h>

#include <cmath>

#include "clray/error.hpp"
#include "ephemeris/epoch.hpp"
#include "ephemeris/site.hpp"
#include "scene/file/key_forms.hpp"
#include "scene/file/key_member.hpp"
#include "scene/file/value_checks.hpp"
#include "shared/portable.h"
#include "text/text.hpp"

namespace clray {
namespace {

using ephemeris::Epoch;

constexpr double kLongest_s = 1e9;  // of a pass

// ---- dates

/// A date of TOML, or a text that is one.
Epoch read_date(TomlTable& t, const std::string& key) {
  const toml::node& value = *t.node(key);
  Epoch epoch;
  if (const auto* text = value.as_string(); text != nullptr && ephemeris::read_date(text->get(), &epoch)) return epoch;
  const char* expected = "expected a date such as 2026-11-25T18:02:00Z, found ";
  if (const auto* date = value.as_date()) {
    if (ephemeris::mjd_of(date->get().year, date->get().month, date->get().day, &epoch.mjd)) return epoch;
  }
  const auto* both = value.as_date_time();
  if (both == nullptr) t.fail(key, expected + found(value));
  const toml::date_time& d = both->get();
  if (!ephemeris::mjd_of(d.date.year, d.date.month, d.date.day, &epoch.mjd)) t.fail(key, expected + found(value));
  const std::int64_t seconds = (d.time.hour * 60 + d.time.minute) * 60 + d.time.second;
  epoch.ps = seconds * ephemeris::kPicosecondsPerSecond + static_cast<std::int64_t>(d.time.nanosecond) * 1000;
  // An hour's offset is one of the calendar.
  if (d.offset) epoch.ps -= static_cast<std::int64_t>(d.offset->minutes) * 60 * ephemeris::kPicosecondsPerSecond;
  return ephemeris::normalised(epoch);
}

Epoch read_mjd(TomlTable& t, const std::string& key) {
  const double mjd = t.number(key, {1.0, 1e6, true, true}), day = std::floor(mjd);
  return ephemeris::epoch_of(static_cast<std::int64_t>(day), (mjd - day) * 86400.0);
}

void check_start(const std::string& where, const Pass& p) {
  if (p.start.mjd >= 1 && p.start.mjd <= 1000000 && p.start.ps >= 0 &&
      p.start.ps <= 86401 * ephemeris::kPicosecondsPerSecond)
    return;
  throw Error(ErrorCode::input, "missing; expected a date", where + ".start");
}

void read_start(TomlTable& t, const std::string& key, Pass* p) {
  p->start = read_date(t, key);
}
void read_start_mjd(TomlTable& t, const std::string& key, Pass* p) {
  p->start = read_mjd(t, key);
}
std::string start_text(const Pass& p) {
  return p.start.mjd == 0 ? "" : ephemeris::iso_text(p.start);
}

/// Sets the end of a pass, whose start must be there.
void set_stop(TomlTable& t, const std::string& key, const Epoch& stop, Pass* p) {
  if (p->start.mjd == 0) t.missing("start", "a date");
  p->stop_s = ephemeris::seconds_between(p->start, stop);
  if (!(p->stop_s >= 0.0 && p->stop_s <= kLongest_s)) {
    t.fail(key, fmt::format("expected a date from the start ({}) on, found {}", ephemeris::iso_text(p->start),
                            ephemeris::iso_text(stop)));
  }
}

void read_stop(TomlTable& t, const std::string& key, Pass* p) {
  set_stop(t, key, read_date(t, key), p);
}
void read_stop_mjd(TomlTable& t, const std::string& key, Pass* p) {
  set_stop(t, key, read_mjd(t, key), p);
}
void check_stop(const std::string& where, const Pass& p) {
  check_number(where + ".stop_s", p.stop_s, {0.0, kLongest_s, true, true});
}
std::string stop_text(const Pass& p) {
  return p.start.mjd == 0 || !p.times_s.empty() ? "" : ephemeris::iso_text(ephemeris::later(p.start, p.stop_s));
}

std::string no_text(const Pass&) {
  return "";  // worded by the key beside it
}

// ---- instants and files

void read_times_file(TomlTable& t, const std::string& key, Pass* p) {
  p->times_file = t.file(key);
}
void check_times(const std::string& where, const Pass& p) {
  for (std::size_t i = 0; i < p.times_s.size(); ++i) {
    check_number(where + ".times_s", p.times_s[i], {-kLongest_s, kLongest_s, true, true});
    if (i > 0 && !(p.times_s[i] > p.times_s[i - 1]))
      throw Error(ErrorCode::input, "times must increase", where + ".times_s");
  }
}
std::string times_text(const Pass& p) {
  return p.times_s.empty() ? "" : text::counted(p.times_s.size(), "instant");
}

void read_ephemeris(TomlTable& t, const std::string& key, Pass* p) {
  p->ephemeris = t.file(key);
}
std::string ephemeris_text(const Pass& p) {
  return p.ephemeris;
}
void read_eop(TomlTable& t, const std::string& key, Pass* p) {
  p->eop = t.file(key);
}
std::string eop_text(const Pass& p) {
  return p.eop;
}

// ---- places

Vec3 read_site(TomlTable& t, const std::string& key) {
  std::optional<TomlTable> site = t.table(key);
  const double degree = CLRAY_PI / 180.0;
  site->know({"latitude_deg", "longitude_deg", "height_m"});
  ephemeris::Geodetic g;
  g.latitude_rad = site->number("latitude_deg", {-90.0, 90.0, true, true}) * degree;
  g.longitude_rad = site->number("longitude_deg", {-360.0, 360.0, true, true}) * degree;
  g.height_m = site->number("height_m", {-1e4, 1e7, true, true}, 0.0);
  site->finish();
  return ephemeris::place_of(g);
}

std::string site_text(const Vec3& place_m) {
  const ephemeris::Geodetic g = ephemeris::geodetic_of(place_m);
  const double degree = CLRAY_PI / 180.0;
  return fmt::format("latitude {:.6f} deg, longitude {:.6f} deg, height {:.1f} m", g.latitude_rad / degree,
                     g.longitude_rad / degree, g.height_m);
}

std::string place_of_earth_fault(const Vec3& place_m) {
  const double radius = std::sqrt(place_m.x * place_m.x + place_m.y * place_m.y + place_m.z * place_m.z);
  if (radius > 6.3e6 && radius < 1.7e7) return "";
  return fmt::format("expected Earth-fixed metres of a place on the Earth or above, found {:.6g} m from its centre",
                     radius);
}

void read_observer_site(TomlTable& t, const std::string& key, Observer* o) {
  o->site_m = read_site(t, key);
  o->toward = Toward::site;
  o->monostatic = false;
}
void check_observer_site(const std::string& where, const Observer& o) {
  if (o.toward != Toward::site) return;
  if (const std::string fault = place_of_earth_fault(o.site_m); !fault.empty())
    throw Error(ErrorCode::input, fault, where + ".site_m");
  if (o.range_m != 0.0)
    throw Error(ErrorCode::input, "given beside a site, whose range follows from the orbit", where + ".range_m");
}
std::string observer_site_text(const Observer& o) {
  return o.toward == Toward::site ? site_text(o.site_m) : "";
}

void read_observer_ecef(TomlTable& t, const std::string& key, Observer* o) {
  o->site_m = t.vector(key);
  if (const std::string fault = place_of_earth_fault(o->site_m); !fault.empty()) t.fail(key, fault);
  o->toward = Toward::site;
  o->monostatic = false;
}
std::string no_observer_text(const Observer&) {
  return "";  // worded as a site
}

void read_observer_station(TomlTable& t, const std::string& key, Observer* o) {
  const Station station = load_station(t.file(key));
  if (station.position_m == Vec3(0.0)) t.fail(key, "the file gives no place; expected site or position_m in it");
  o->site_m = station.position_m;
  if (const std::string fault = place_of_earth_fault(o->site_m); !fault.empty()) t.fail(key, fault);
  o->toward = Toward::site;
  o->monostatic = false;
  if (!t.has("name")) o->name = station.name;
}

void read_station_site(TomlTable& t, const std::string& key, Station* s) {
  s->position_m = read_site(t, key);
}
std::string station_site_text(const Station& s) {
  return place_of_earth_fault(s.position_m).empty() ? site_text(s.position_m) : "";
}

// ---- directions

const std::vector<std::string> kFrameNames{"body", "gcrf", "itrf"};

Directions read_directions_key(TomlTable& t, const std::string& key) {
  Directions d;
  d.file = t.file(key);
  const std::string frame = t.choice("frame", kFrameNames);
  d.in_body = frame == "body";
  d.frame = frame == "itrf" ? Frame::itrf : Frame::gcrf;
  return d;
}

/// The frame is read with the directions.
template <class Section>
void read_frame(TomlTable& t, const std::string& key, Section* s) {
  if (s->toward != Toward::table) t.fail(key, "belongs to directions");
}

template <class Section>
std::string frame_text(const Section& s) {
  if (s.toward != Toward::table) return "";
  return s.directions.in_body ? "body" : s.directions.frame == Frame::itrf ? "itrf" : "gcrf";
}

void check_directions(const std::string& where, Toward toward, const Directions& d) {
  if (toward != Toward::table) return;
  const std::string path = where + ".directions";
  if (d.rows.empty()) throw Error(ErrorCode::input, "missing; expected at least one row", path);
  if (!d.in_body && d.frame != Frame::gcrf && d.frame != Frame::itrf)
    throw Error(ErrorCode::input, "expected the frame gcrf or itrf", path);
  for (std::size_t i = 0; i < d.rows.size(); ++i) {
    check_unit(path, d.rows[i].direction);
    check_number(path + ".time_s", d.rows[i].time_s, kTime);
    check_number(path + ".range_m", d.rows[i].range_m, {0.0, 1e13, true, true});
    if (i > 0 && !(d.rows[i].time_s > d.rows[i - 1].time_s)) throw Error(ErrorCode::input, "times must increase", path);
  }
}

std::string directions_text(Toward toward, const Directions& d) {
  return toward == Toward::table ? text::counted(d.rows.size(), "row") : "";
}

void read_source_directions(TomlTable& t, const std::string& key, Source* s) {
  s->directions = read_directions_key(t, key);
  s->toward = Toward::table;
}
void check_source_directions(const std::string& where, const Source& s) {
  check_directions(where, s.toward, s.directions);
}
std::string source_directions_text(const Source& s) {
  return directions_text(s.toward, s.directions);
}
void read_observer_directions(TomlTable& t, const std::string& key, Observer* o) {
  o->directions = read_directions_key(t, key);
  o->toward = Toward::table;
  o->monostatic = false;
}
void check_observer_directions(const std::string& where, const Observer& o) {
  check_directions(where, o.toward, o.directions);
}
std::string observer_directions_text(const Observer& o) {
  return directions_text(o.toward, o.directions);
}

void read_source_direction(TomlTable& t, const std::string& key, Source* s) {
  const toml::node& value = *t.node(key);
  if (value.is_string()) {
    s->toward = t.choice(key, {"sun", "station"}) == "sun" ? Toward::sun : Toward::station;
  } else {
    s->direction = t.direction(key);
  }
}
void check_source_direction(const std::string& where, const Source& s) {
  if (s.toward == Toward::fixed) check_unit(where + ".direction", s.direction);
  if (s.toward == Toward::site) throw Error(ErrorCode::input, "expected no site of a source", where + ".toward");
}
std::string source_direction_text(const Source& s) {
  if (s.toward == Toward::sun) return "sun";
  if (s.toward == Toward::station) return "station";
  return s.toward == Toward::fixed ? vector_text(s.direction) : "";
}

// ---- attitude

void read_attitude_file(TomlTable& t, const std::string& key, PassAttitude* a) {
  a->file = t.file(key);
}
std::string attitude_file_text(const PassAttitude& a) {
  return a.file;
}
void read_attitude_table(TomlTable& t, const std::string& key, PassAttitude* a) {
  a->attitudes_file = t.file(key);
}
void check_attitude_table(const std::string& where, const PassAttitude& a) {
  check_attitudes(where + ".attitudes", a.attitudes, kAny);
}
std::string attitude_table_text(const PassAttitude& a) {
  return a.attitudes.empty() ? "" : text::counted(a.attitudes.size(), "row");
}

void read_spin(TomlTable& t, const std::string& key, PassAttitude* a) {
  if (a->law != PassAttitude::Law::spin) t.fail(key, "belongs to law = \"spin\"");
  std::optional<TomlTable> spin = t.table(key);
  spin->know({"axis", "period_s", "phase_deg", "frame"});
  a->spin_axis = spin->direction("axis");
  a->spin_period_s = spin->number("period_s", {1e-6, 1e9, true, true});
  a->spin_phase_rad = std::fmod(spin->number("phase_deg", kAny, 0.0), 360.0) / 180.0 * CLRAY_PI;
  a->spin_in_orbit_frame = spin->choice("frame", {"gcrf", "orbit"}, "gcrf") == "orbit";
  spin->finish();
}
void check_spin(const std::string& where, const PassAttitude& a) {
  if (a.law != PassAttitude::Law::spin) return;
  check_unit(where + ".spin_axis", a.spin_axis);
  check_number(where + ".spin_period_s", a.spin_period_s, {1e-6, 1e9, true, true});
  check_number(where + ".spin_phase_rad", a.spin_phase_rad, kAny);
}
std::string spin_text(const PassAttitude& a) {
  if (a.law != PassAttitude::Law::spin) return "";
  return fmt::format("axis {} in {}, period_s {:.9g}, phase_deg {:.9g}", vector_text(a.spin_axis),
                     a.spin_in_orbit_frame ? "orbit" : "gcrf", a.spin_period_s, a.spin_phase_rad / CLRAY_PI * 180.0);
}

void read_offset(TomlTable& t, const std::string& key, PassAttitude* a) {
  std::optional<TomlTable> offset = t.table(key);
  offset->know({"axis", "angle_deg"});
  a->offset_axis = offset->direction("axis");
  a->offset_rad = std::fmod(offset->number("angle_deg", kAny), 360.0) / 180.0 * CLRAY_PI;
  offset->finish();
}
void check_offset(const std::string& where, const PassAttitude& a) {
  check_unit(where + ".offset_axis", a.offset_axis);
  check_number(where + ".offset_rad", a.offset_rad, kAny);
}
std::string offset_text(const PassAttitude& a) {
  if (a.offset_rad == 0.0) return "";
  return fmt::format("{:.9g} deg about {}", a.offset_rad / CLRAY_PI * 180.0, vector_text(a.offset_axis));
}

}  // namespace

namespace forms {

const KeyForm<Source> source_direction{read_source_direction, check_source_direction, source_direction_text};
const KeyForm<Source> source_directions{read_source_directions, check_source_directions, source_directions_text};
const KeyForm<Source> source_frame{read_frame, nullptr, frame_text};
const KeyForm<Observer> observer_frame{read_frame, nullptr, frame_text};
const KeyForm<Observer> observer_site{read_observer_site, check_observer_site, observer_site_text};
const KeyForm<Observer> observer_ecef{read_observer_ecef, nullptr, no_observer_text};
const KeyForm<Observer> observer_directions{read_observer_directions, check_observer_directions,
                                            observer_directions_text};
const KeyForm<Pass> pass_start{read_start, check_start, start_text};
const KeyForm<Pass> pass_start_mjd{read_start_mjd, nullptr, no_text};
const KeyForm<Pass> pass_times{read_times_file, check_times, times_text};
const KeyForm<Pass> pass_stop{read_stop, check_stop, stop_text};
const KeyForm<Pass> pass_stop_mjd{read_stop_mjd, nullptr, no_text};
const KeyForm<Pass> pass_ephemeris{read_ephemeris, nullptr, ephemeris_text};
const KeyForm<Pass> pass_eop{read_eop, nullptr, eop_text};
const KeyForm<PassAttitude> attitude_file{read_attitude_file, nullptr, attitude_file_text};
const KeyForm<PassAttitude> attitude_attitudes{read_attitude_table, check_attitude_table, attitude_table_text};
const KeyForm<PassAttitude> attitude_spin{read_spin, check_spin, spin_text};
const KeyForm<PassAttitude> attitude_offset{read_offset, check_offset, offset_text};
const KeyForm<Observer> observer_station{read_observer_station, nullptr, no_observer_text};
const KeyForm<Station> station_site{read_station_site, nullptr, station_site_text};

}  // namespace forms
}  // namespace clray
