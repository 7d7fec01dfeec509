// SPDX-License-Identifier: Apache-2.0
// The section [pass] of a scene file with its attitude, and the tables by time of a pass. Rules about several keys
// stand here and in scene_pass_check.cpp.
#include <fmt/format.h>

#include "clray/error.hpp"
#include "ephemeris/epoch.hpp"
#include "scene/file/keys.hpp"
#include "scene/file/scene_csv.hpp"
#include "scene/scene_parts.hpp"

namespace clray {
namespace {

/// Reads the file of the instants. Without a start its first date is the start.
void read_instants(Pass* p) {
  CsvColumn time{{"time", "t"}, "s"};
  time.dated = true;
  const CsvTable table = read_csv(p->times_file, {time}, CsvHeader::required);
  if (p->start.mjd == 0) {
    const std::optional<Epoch> first = first_date(table);
    if (!first) {
      throw Error(ErrorCode::input, "its times are seconds; expected pass.start beside it, from which they count",
                  p->times_file);
    }
    p->start = *first;
  }
  p->times_s = read_times(table, p->start);
  p->stop_s = p->times_s.back();
}

/// Fills in where a pass's light comes from if the scene does not say.
void default_source(Scene* scene, bool given) {
  if (given || scene->source.toward != Toward::fixed) return;
  scene->source.toward = scene->source.kind == Source::Kind::sun ? Toward::sun : Toward::station;
}

}  // namespace

void read_pass(TomlTable& root, Scene* scene) {
  std::optional<TomlTable> t = root.table("pass");
  if (!t) return;
  if (root.has("motion"))
    throw Error(ErrorCode::input, "pass: given beside [motion]; expected only one of them", t->place());
  Pass p;
  t->know({"attitude"});
  if (std::optional<TomlTable> attitude = t->table("attitude")) {
    read_keys(*attitude, &p.attitude);
    if (p.attitude.law == PassAttitude::Law::spin && p.attitude.spin_period_s == 0.0)
      attitude->missing("spin", "a table { axis, period_s, … }");
  }
  read_keys(*t, &p);
  for (const KeyRow& row : key_rows("pass")) p.places[row.key.name] = t->place(row.key.name);
  if (!p.times_file.empty()) read_instants(&p);
  if (p.start.mjd == 0) t->missing("start", "a date");
  if (p.times_s.empty()) {
    if (!t->has("stop") && !t->has("stop_mjd")) t->missing("stop", "a date");
    if (p.step_s == 0.0 && p.step_rad == 0.0) t->missing("step_s", "a number in (0,1e9], or step_deg, or times");
  }
  if (p.ephemeris.empty()) t->missing("ephemeris", "the name of a file");
  if (!p.attitude.attitudes_file.empty())
    p.attitude.attitudes = read_dated_attitudes(p.attitude.attitudes_file, p.start);
  scene->pass = std::move(p);
}

void read_pass_directions(TomlTable& root, Scene* scene) {
  if (!scene->pass) return;
  std::optional<TomlTable> source = root.table("source");
  default_source(scene, source && source->has("direction"));
  const Epoch start = scene->pass->start;
  if (!scene->source.directions.file.empty())
    scene->source.directions.rows = read_directions(scene->source.directions.file, start);
  for (Observer& o : scene->observers) {
    if (!o.directions.file.empty()) o.directions.rows = read_directions(o.directions.file, start);
  }
}

}  // namespace clray
