// SPDX-License-Identifier: Apache-2.0
// Keys of a form of their own; see key_forms.hpp. For each: reading it from a scene file, checking what was filled by
// hand, and its words for a person (empty where nothing is given).
#include "scene/file/key_forms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "clray/error.hpp"
#include "scene/file/scene_csv.hpp"
#include "scene/file/value_checks.hpp"
#include "scene/spectrum.hpp"
#include "text/text.hpp"

namespace clray {
namespace {

std::string count_text(std::size_t n, const std::string& one) {
  return n == 0 ? "" : text::counted(n, one);
}

// ---- source

constexpr Range kWavelength{0.0, 1e7, false, true};

/// A band from a filter's curve, called `name` or, if that is empty, like its file.
Band curve_band(TomlTable& t, const std::string& key, std::string name) {
  const std::string file = t.file(key);
  Spectrum curve = read_spectrum(
      file, {{"value", "transmission", "transmittance", "response", "throughput", "efficiency"}, ""}, 0.0, 1e300);
  const bool some = std::any_of(curve.value.begin(), curve.value.end(), [](double v) { return v > 0.0; });
  if (curve.value.size() < 2 || !some) {
    throw Error(ErrorCode::input, "expected a filter's curve: at least two rows, and some light passed", file);
  }
  if (name.empty()) name = std::filesystem::path(file).stem().string();
  return make_band(name, std::move(curve));
}

/// { name, low_nm, high_nm }, { name, file } or { name, filter }.
Band table_band(TomlTable b) {
  b.know({"low_nm", "high_nm", "file", "filter"});
  const std::string given = b.name("name", "");
  Band band;
  if (b.has("filter")) {
    for (const char* key : {"low_nm", "high_nm", "file"}) {
      if (b.has(key)) b.fail(key, "given beside filter, which has its own curve");
    }
    band = photometric_band(b.choice("filter", photometric_bands()));
    if (!given.empty()) band.name = given;
  } else if (b.has("file")) {
    for (const char* key : {"low_nm", "high_nm"}) {
      if (b.has(key)) b.fail(key, "given beside file; the curve has its own ends");
    }
    band = curve_band(b, "file", given);
  } else {
    const double low = b.number("low_nm", kWavelength), high = b.number("high_nm", kWavelength);
    if (!(low < high)) b.fail("high_nm", fmt::format("expected more than low_nm = {}, found {}", low, high));
    band = make_band(low, high);
    if (!given.empty()) band.name = given;
  }
  b.finish();
  return band;
}

/// One band: [low, high], "curve.csv", or a table.
Band read_band(TomlTable& t, const toml::node& node) {
  if (const toml::table* named = node.as_table()) return table_band(t.inner(*named, "source.bands"));
  if (node.is_string()) {
    const std::string word = **node.as_string();
    const std::vector<std::string>& known = photometric_bands();
    if (std::find(known.begin(), known.end(), word) != known.end()) return photometric_band(word);
    // A table of one entry, so that files are found and faults told in one place.
    toml::table one;
    one.insert("bands", *node.as_string());
    TomlTable entry = t.inner(one, "source");
    try {
      return curve_band(entry, "bands", "");
    } catch (const Error& e) {
      if (e.message().rfind("source.bands: ", 0) != 0) throw;
      const bool named = word.find_first_of("./") == std::string::npos;  // rather a filter than a file
      t.fail_at(node.source(), e.message() + (named ? fmt::format(", and no filter of the name; expected one of {}",
                                                                  fmt::join(known, ", "))
                                                    : ""));
    }
  }
  const toml::array* pair = node.as_array();
  if (pair == nullptr || pair->size() != 2) {
    t.fail_at(node.source(),
              "source.bands: expected [low_nm, high_nm], a filter's name or the file of a curve, found " + found(node));
  }
  const double low = t.number_of(*pair->get(0), "bands", kWavelength);
  const double high = t.number_of(*pair->get(1), "bands", kWavelength);
  if (!(low < high)) {
    t.fail_at(pair->get(1)->source(), fmt::format("source.bands: expected more than {}, found {}", low, high));
  }
  return make_band(low, high);
}

/// { low_nm, high_nm, count }: so many bands of equal width side by side.
void read_even_bands(TomlTable t, Source* s) {
  const double low = t.number("low_nm", kWavelength), high = t.number("high_nm", kWavelength);
  if (!(low < high)) t.fail("high_nm", fmt::format("expected more than low_nm = {}, found {}", low, high));
  const std::uint64_t count = t.whole("count", 1, 4096);
  t.finish();
  const double n = static_cast<double>(count);
  const auto edge = [&](std::uint64_t i) {
    const double share = static_cast<double>(i) / n;
    return i == count ? high : low + (high - low) * share;
  };
  for (std::uint64_t i = 0; i < count; ++i) {
    s->bands.push_back(make_band(edge(i), edge(i + 1)));
    s->bands.back().name = fmt::format("{:.6g}-{:.6g}", edge(i), edge(i + 1));
    if (i > 0 && s->bands[i].name == s->bands[i - 1].name) t.fail("count", "the bands are too narrow to be told apart");
  }
}

void read_bands(TomlTable& t, const std::string& key, Source* s) {
  const toml::node* value = t.node(key);
  if (value->is_table()) return read_even_bands(*t.table(key), s);
  const toml::array* array = value->as_array();
  if (array == nullptr || array->empty()) {
    t.fail(key, "expected [[low_nm, high_nm], …] or { low_nm, high_nm, count }, found " + found(*value));
  }
  std::set<std::string> taken;
  for (const toml::node& each : *array) {
    const Band band = read_band(t, each);
    if (!taken.insert(band.name).second)
      t.fail_at(each.source(), "source.bands: a second band of the name \"" + band.name + "\"");
    s->bands.push_back(band);
  }
}

void check_bands(const std::string& where, const Source& s) {
  for (const Band& b : s.bands) {
    check_number(where + ".bands", b.low_nm, kPositive);
    check_number(where + ".bands", b.high_nm, {b.low_nm, kInfinity, false, false});
    if (b.response) check_spectrum(where + ".bands.response", *b.response);
  }
}

/// Each with the light that the source has in it.
std::string bands_text(const Source& s) {
  Scene scene;
  scene.source = s;
  const std::vector<Band> bands = bands_of(scene);
  constexpr std::size_t kMost = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(bands.size(), kMost); ++i) {
    const Band& b = bands[i];
    const std::string range = b.response ? fmt::format("{} (curve {:.6g}-{:.6g} nm, ", b.name, b.low_nm, b.high_nm)
                              : b.name == make_band(b.low_nm, b.high_nm).name
                                  ? b.name + " nm ("
                                  : fmt::format("{} ({:.6g}-{:.6g} nm, ", b.name, b.low_nm, b.high_nm);
    text += fmt::format("{}{}{:.6g} W/m2)", i > 0 ? ", " : "", range, source_band_W_m2(s, b));
  }
  if (bands.size() <= kMost) return text;
  return text + fmt::format(" and {} more up to {:.6g} nm", bands.size() - kMost, bands.back().high_nm);
}

void read_source_spectrum(TomlTable& t, const std::string& key, Source* s) {
  const toml::node& value = *t.node(key);
  if (value.is_string() && **value.as_string() == "solar") {
    s->spectrum = solar_spectrum();
    return;
  }
  s->spectrum = read_spectrum(t.file(key), {{"irradiance", "spectral_irradiance"}, "W_m2_nm", "value"}, 0.0, 1e300);
}

void check_source_spectrum(const std::string& where, const Source& s) {
  if (s.spectrum) check_spectrum(where + ".spectrum", *s.spectrum);
}

std::string source_spectrum_text(const Source& s) {
  if (!s.spectrum) return "";
  const Spectrum& solar = solar_spectrum();
  const bool own = s.spectrum->wavelength_nm == solar.wavelength_nm && s.spectrum->value == solar.value;
  return own ? "solar" : "of " + count_text(s.spectrum->value.size(), "point");
}

// ---- observer

void read_observer_direction(TomlTable& t, const std::string& key, Observer* o) {
  const toml::node& value = *t.node(key);
  o->monostatic = value.is_string();
  if (o->monostatic) {
    o->monostatic = t.choice(key, {"source", "station"}) == "source";
    o->toward = o->monostatic ? Toward::fixed : Toward::station;
  } else if (!value.is_array()) {
    t.fail(key, "expected \"source\", \"station\" or [x, y, z], found " + found(value));
  } else {
    o->direction = t.direction(key);
  }
}

void check_observer_direction(const std::string& where, const Observer& o) {
  if (!o.monostatic && o.toward == Toward::fixed) check_unit(where + ".direction", o.direction);
}

std::string observer_direction_text(const Observer& o) {
  if (o.monostatic) return "source";
  if (o.toward != Toward::fixed) return o.toward == Toward::station ? "station" : "";
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", o.direction.x, o.direction.y, o.direction.z);
}

constexpr Range kExtinction{0.0, 100.0, true, true};

void read_extinction(TomlTable& t, const std::string& key, Observer* o) {
  if (!t.node(key)->is_table()) {
    o->extinction_mag[""] = t.number(key, kExtinction);
    return;
  }
  std::optional<TomlTable> bands = t.table(key);
  for (const std::string& band : bands->keys()) o->extinction_mag[band] = bands->number(band, kExtinction);
}

void check_extinction(const std::string& where, const Observer& o) {
  for (const auto& entry : o.extinction_mag) check_number(where + ".extinction_mag", entry.second, kExtinction);
}

std::string extinction_text(const Observer& o) {
  std::string text;
  for (const auto& [band, mag] : o.extinction_mag)
    text += fmt::format("{}{}{:.6g}", text.empty() ? "" : ", ", band.empty() ? "" : band + " ", mag);
  return text;
}

// ---- motion

void read_motion_attitudes(TomlTable& t, const std::string& key, Motion* m) {
  m->attitudes = read_attitudes(t.file(key));
  m->start_s = m->attitudes.front().time_s;
  m->stop_s = m->attitudes.back().time_s;
}

void check_motion_attitudes(const std::string& where, const Motion& m) {
  check_attitudes(where + ".attitudes", m.attitudes, kTime);
}

std::string attitudes_text(const Motion& m) {
  return count_text(m.attitudes.size(), "row");
}

/// The times of the table; a hand-filled motion of zeros takes all of it.
Range table_range(const Motion& m) {
  return {m.attitudes.front().time_s, m.attitudes.back().time_s, true, true};
}

void read_table_start(TomlTable& t, const std::string& key, Motion* m) {
  m->start_s = t.number(key, table_range(*m));
}

void check_table_start(const std::string& where, const Motion& m) {
  if (m.start_s != 0.0 || m.stop_s != 0.0) check_number(where + ".start_s", m.start_s, table_range(m));
}

std::string table_start_text(const Motion& m) {
  return fmt::format("{:.12g}", m.start_s);
}

void read_table_stop(TomlTable& t, const std::string& key, Motion* m) {
  m->stop_s = t.number(key, {m->start_s, m->attitudes.back().time_s, true, true});
}

void check_table_stop(const std::string& where, const Motion& m) {
  if (m.start_s != 0.0 || m.stop_s != 0.0) check_number(where + ".stop_s", m.stop_s, table_range(m));
}

std::string table_stop_text(const Motion& m) {
  return fmt::format("{:.12g}", m.stop_s);
}

// ---- station

/// Read before the other keys, see read_station().
void read_station_file(TomlTable& t, const std::string& key, Station* s) {
  s->file = t.file(key);
}

std::string station_file_text(const Station& s) {
  return s.file;
}

void read_ranges(TomlTable& t, const std::string& key, Station* s) {
  s->ranges = read_pairs(t.file(key), {{"time", "t"}, "s"}, {{"range", "distance"}, "m"}, 1e-3, 1e13);
}

void check_ranges(const std::string& where, const Station& s) {
  check_pairs(where + ".ranges", s.ranges, {1e-3, 1e13, true, true});
}

std::string ranges_text(const Station& s) {
  return count_text(s.ranges.size(), "row");
}

void read_cpf(TomlTable& t, const std::string& key, Station* s) {
  s->cpf_file = t.file(key);
  if (!t.has("position_m") && !t.has("site") && s->position_m == Vec3(0.0))
    t.missing("position_m", "three numbers [x, y, z]");
}

void check_cpf(const std::string& where, const Station& s) {
  if (s.cpf_file.empty() || s.position_m != Vec3(0.0)) return;
  throw Error(ErrorCode::input, "missing; a prediction needs it", where + ".position_m");
}

std::string cpf_text(const Station& s) {
  return s.cpf_file;
}

constexpr double kMostPower = 1e100;  // relative; moments of a pulse are sums of products

std::string pulse_fault(const Station& s) {
  const bool some = std::any_of(s.pulse.begin(), s.pulse.end(), [](const auto& row) { return row.second > 0.0; });
  return s.pulse.empty() || (s.pulse.size() > 1 && some) ? "" : "expected at least two rows and some power";
}

void read_pulse(TomlTable& t, const std::string& key, Station* s) {
  s->pulse = read_pairs(t.file(key), {{"time", "t"}, "ps"}, {{"power", "value"}, ""}, 0.0, kMostPower);
  for (auto& row : s->pulse) row.first /= 1e12;
  if (const std::string fault = pulse_fault(*s); !fault.empty()) t.fail(key, fault);
}

void check_pulse(const std::string& where, const Station& s) {
  check_pairs(where + ".pulse", s.pulse, {0.0, kMostPower, true, true});
  if (const std::string fault = pulse_fault(s); !fault.empty()) throw Error(ErrorCode::input, fault, where + ".pulse");
}

std::string pulse_text(const Station& s) {
  return count_text(s.pulse.size(), "point");
}

}  // namespace

namespace forms {

const KeyForm<Source> source_bands{read_bands, check_bands, bands_text};
const KeyForm<Source> source_spectrum{read_source_spectrum, check_source_spectrum, source_spectrum_text};
const KeyForm<Observer> observer_direction{read_observer_direction, check_observer_direction, observer_direction_text};
const KeyForm<Observer> observer_extinction{read_extinction, check_extinction, extinction_text};
const KeyForm<Motion> motion_attitudes{read_motion_attitudes, check_motion_attitudes, attitudes_text};
const KeyForm<Motion> motion_table_start{read_table_start, check_table_start, table_start_text};
const KeyForm<Motion> motion_table_stop{read_table_stop, check_table_stop, table_stop_text};
const KeyForm<Station> station_file{read_station_file, nullptr, station_file_text};
const KeyForm<Station> station_ranges{read_ranges, check_ranges, ranges_text};
const KeyForm<Station> station_cpf{read_cpf, check_cpf, cpf_text};
const KeyForm<Station> station_pulse{read_pulse, check_pulse, pulse_text};

}  // namespace forms
}  // namespace clray
