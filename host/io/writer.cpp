// SPDX-License-Identifier: Apache-2.0
// write_result(): the order in which a result's files are made, and the names they get. Plots come before the
// summary, so that it can say which are missing.
#include "io/writer.hpp"

#include <cmath>

#include "clray/error.hpp"
#include "clray/write.hpp"
#include "io/detector/room.hpp"
#include "text/text.hpp"

namespace clray::io {

std::string Writer::add(const std::string& stem, const std::string& extension) {
  files.push_back(names.file(stem, extension));
  return files.back();
}

TableFile Writer::table(const std::string& name, const std::string& what, const std::string& units) const {
  return TableFile(folder.path(name), result, scene, what, units);
}

void Writer::draw(const Plot& plot, const std::string& name) {
  const bool stopped = options.stop != nullptr && *options.stop;
  const std::string trouble = stopped ? "no " + name + ": interrupted" : plot.draw(folder.folder());
  if (trouble.empty()) return;
  files.pop_back();
  names.release(name);
  warnings.push_back(trouble);
}

std::string Writer::scene_name() const {
  return scene.name.empty() ? "scene" : scene.name;
}

const DetectorSpec* Writer::detector_of(const ResultKey& key) const {
  for (const auto& detector : scene.detectors) {
    if (shown_name(detector) == key.detector) return &detector;
  }
  return nullptr;
}

std::string Writer::kind_of(const ResultKey& key) const {
  const DetectorSpec* detector = detector_of(key);
  return detector != nullptr ? detector->kind : key.detector;
}

std::string Writer::stem(const std::string& first, const ResultKey& key, bool of_band) {
  const std::string kind = kind_of(key);
  int of_kind = 0;
  for (const auto& detector : scene.detectors) of_kind += detector.kind == kind;
  std::vector<std::string> parts{of_kind > 1 && first == kind ? key.detector : first};
  if (of_kind > 1 && first != kind) parts.push_back(key.detector);
  for (const auto& part : {key.observer, key.variant}) {
    if (!part.empty()) parts.push_back(part);
  }
  if (of_band && !key.band.empty()) parts.push_back(key.band);
  return names.stem(parts, first);
}

std::string Writer::title(const std::string& kind, const ResultKey& key) const {
  std::string title = scene_name();
  if (!key.detector.empty() && key.detector != kind) title += ", " + key.detector;
  if (!key.observer.empty()) title += ", seen from " + key.observer;
  if (!key.variant.empty()) title += ", " + key.variant;
  return title;
}

/// Words for an error: tracing may have taken hours, so what is written stays.
std::string kept_in(OutputFolder& place) {
  const std::string folder = place.keep();
  return folder.empty() ? "" : "; the files that were finished are in " + shown(folder);
}

TimeUnit readable_time_unit(double seconds) {
  constexpr TimeUnit kUnits[] = {{1.0, "s"}, {1e3, "ms"}, {1e6, "µs"}, {1e9, "ns"}, {1e12, "ps"}, {1e15, "fs"}};
  if (!(seconds > 0.0)) return kUnits[3];
  // Laser ranging uses nanoseconds. Other units are taken only if the numbers would be hard to read.
  if (seconds > 0.05e-9 && seconds < 20e-6) return kUnits[3];
  for (const auto& unit : kUnits) {
    if (seconds * unit.per_second >= 1.0) return unit;
  }
  return kUnits[5];
}

double time_of(const Result& result, const ResultKey& key) {
  return key.orientation < result.orientations.size() ? result.orientations[key.orientation].time_s : 0.0;
}

}  // namespace clray::io

namespace clray {

std::vector<std::string> write_result(const Result& result, const Scene& scene, const std::string& folder,
                                      const WriteOptions& options) {
  check_scene(scene);
  check_result(result, scene);
  io::OutputFolder place(folder);
  Reference reference;
  if (!options.reference_file.empty()) reference = load_reference(options.reference_file);
  io::Writer writer{result, scene, options, place, options.reference_file.empty() ? nullptr : &reference, {}, {}, {}};
  for (const char* own : {"error", "summary", "pass", "totals", "orientations"}) writer.names.reserve(own);
  try {
    for (const io::RecordRoom* room : io::record_rooms()) room->files(writer);
    io::write_error(writer);
    io::write_pass(writer);
    std::vector<MoreFiles> more;
    for (const auto& write_more : options.more) {
      more.push_back(write_more(place.folder()));
      writer.files.insert(writer.files.end(), more.back().names.begin(), more.back().names.end());
    }
    io::write_summary(writer, more);
    place.commit();
  } catch (const Error& error) {
    throw Error(error.code(), error.message() + io::kept_in(place), error.context());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::output, "cannot write the result: not enough memory" + io::kept_in(place), folder);
  } catch (const std::exception& error) {
    throw Error(ErrorCode::output, std::string("cannot write the result: ") + error.what() + io::kept_in(place),
                folder);
  }
  if (options.warnings)
    options.warnings->insert(options.warnings->end(), writer.warnings.begin(), writer.warnings.end());
  return writer.files;
}

}  // namespace clray
