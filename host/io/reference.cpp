// SPDX-License-Identifier: Apache-2.0
// --reference: totals of a saved summary.json, or of a delay.csv (ours or a closed form's table), against which the
// true error of a result is measured.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "clray/error.hpp"
#include "clray/write.hpp"
#include "io/writer.hpp"
#include "text/input_file.hpp"
#include "text/text.hpp"

namespace clray {

namespace {

using io::Total;
constexpr std::size_t kMostNamed = 6;  ///< in a message
constexpr const char* kFirst = "";     ///< path of a reference that belongs to the first delay, whatever its name

[[noreturn]] void fail(const std::string& file, std::size_t line, const std::string& message) {
  throw Error(ErrorCode::input, message, line ? file + ":" + std::to_string(line) : file);
}

bool read_number(std::string_view text, double& value) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
}

std::string text_of(const nlohmann::json& entry, const char* key) {
  return entry.is_object() && entry.contains(key) && entry[key].is_string() ? entry[key].get<std::string>()
                                                                            : std::string{};
}

/// The cells of a line of ours, quoted as RFC 4180 says.
std::vector<std::string> quoted_cells(std::string_view line) {
  std::vector<std::string> cells{""};
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (inside && i + 1 < line.size() && line[i + 1] == '"')
        cells.back() += line[i++];
      else
        inside = !inside;
    } else if (line[i] == ',' && !inside) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  return cells;
}

/// The table of totals beside a summary of many orientations (summary.cpp writes its columns).
Reference from_totals(const std::string& summary, const std::string& name) {
  const std::filesystem::path path =
      std::filesystem::path(summary).parent_path() / std::filesystem::path(name).filename();
  const std::string file = path.string(), text = text::read_input_file(file);
  Reference reference{summary, {}};
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (line.empty() || line[0] == '#' || line.substr(0, 9) == "detector,") continue;
    const std::vector<std::string> c = quoted_cells(line);
    double orientation = 0.0, of_sum = 0.0, value = 0.0;
    if (c.size() != 10 || !read_number(c[4], orientation) || !read_number(c[6], of_sum))
      fail(file, number, "no row of totals; expected the table that clray writes beside its summary.json");
    if (!read_number(c[7], value)) continue;  // NaN: nothing to compare with
    io::Total total{{c[0], c[1], c[2], c[3], static_cast<std::size_t>(orientation)}, value, 0.0, "", c[5]};
    total.number = static_cast<std::uint64_t>(of_sum);
    reference.totals[io::total_path(total)] = value;
  }
  if (reference.totals.empty()) fail(file, 0, "holds no totals to compare with");
  return reference;
}

Reference from_summary(const std::string& file, const std::string& text) {
  const auto summary = nlohmann::json::parse(text, nullptr, false);
  if (summary.is_discarded()) fail(file, 0, "not valid JSON; expected the summary.json of a clray result");
  if (summary.is_object() && summary.contains("totals") && !text_of(summary["totals"], "file").empty())
    return from_totals(file, text_of(summary["totals"], "file"));
  if (!summary.is_object() || !summary.contains("totals") || !summary["totals"].is_array()) {
    fail(file, 0, "holds no totals; expected the summary.json of a clray result");
  }
  Reference reference{file, {}};
  for (const auto& entry : summary["totals"]) {
    if (!entry.is_object() || !entry.contains("value") || !entry["value"].is_number()) continue;
    ResultKey key{text_of(entry, "detector"), text_of(entry, "observer"), text_of(entry, "variant"),
                  text_of(entry, "band"), 0};
    if (entry.contains("orientation") && entry["orientation"].is_number_unsigned()) {
      key.orientation = entry["orientation"].get<std::size_t>();
    }
    io::Total total{key, entry["value"].get<double>(), 0.0, "", text_of(entry, "sum")};
    if (entry.contains("number") && entry["number"].is_number_unsigned())
      total.number = entry["number"].get<std::uint64_t>();
    reference.totals[io::total_path(total)] = total.value;
  }
  if (reference.totals.empty()) fail(file, 0, "holds no totals to compare with");
  return reference;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t comma; (comma = line.find(',')) != std::string_view::npos; line.remove_prefix(comma + 1)) {
    cells.push_back(line.substr(0, comma));
  }
  cells.push_back(line);
  return cells;
}

/// The total is that of the comment line if there is one (it knows what lies outside the window), else the sum of the
/// bins.
Reference from_table(const std::string& file, const std::string& text) {
  constexpr std::string_view kTotal = "# total_m2_per_sr: ";
  std::vector<double> delay, density;
  double stated = std::nan("");
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const auto line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (line.substr(0, kTotal.size()) == kTotal) {
      const auto rest = line.substr(kTotal.size());
      if (!read_number(rest.substr(0, rest.find_first_of(" ,")), stated))
        fail(file, number, "the total is not a number");
    }
    if (line.empty() || line == "\r" || line.front() == '#' || line.substr(0, 8) == "delay_ns") continue;
    const auto cells = split(line);
    double x = 0.0, y = 0.0;
    if (cells.size() < 2 || !read_number(cells[0], x) || !read_number(cells[1], y)) {
      fail(file, number,
           "expected delay_ns,intensity_m2_per_sr_per_ns as two numbers (of a delay.csv of one orientation)");
    }
    delay.push_back(x);
    density.push_back(y);
  }
  if (delay.empty()) fail(file, 0, "holds no rows; expected a delay.csv");
  double sum = 0.0;
  for (const double value : density) sum += value;
  if (delay.size() > 1) sum *= (delay.back() - delay.front()) / static_cast<double>(delay.size() - 1);
  if (std::isnan(stated) && delay.size() == 1) fail(file, 0, "one row has no bin width; expected at least two");
  return {file, {{kFirst, std::isnan(stated) ? sum : stated}}};
}

/// Whether it is what a delay.csv has the total of: the first delay.
bool is_first_delay(const Result& result, const Total& total) {
  if (result.delay.empty() || !total.sum.empty()) return false;
  Total first = total;
  first.key = result.delay.front().key;
  return io::total_path(first) == io::total_path(total);
}

double wanted_total(const Result& result, const Total& total, const Reference& reference) {
  auto found = reference.totals.find(io::total_path(total));
  if (found == reference.totals.end() && is_first_delay(result, total)) found = reference.totals.find(kFirst);
  return found == reference.totals.end() ? std::nan("") : found->second;
}

/// The names of a total's path before its band: detector, observer and variant. Names have no slashes.
std::array<std::string, 3> names_of(const std::string& path) {
  std::array<std::string, 3> names;
  std::size_t begin = 0;
  for (std::string& name : names) {
    const std::size_t end = path.find('/', begin);
    name = path.substr(begin, end - begin);
    begin = end == std::string::npos ? path.size() : end + 1;
  }
  return names;
}

template <class List>
bool has_name(const List& list, const std::string& name) {
  return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
}

/// Whether results of the scene may have these names. Some detectors have no observer.
bool may_have(const Scene& scene, const std::array<std::string, 3>& names) {
  const std::string &detector = names[0], &observer = names[1], &variant = names[2];  // C++17 captures no bindings
  const bool measured = std::any_of(scene.detectors.begin(), scene.detectors.end(), [&](const DetectorSpec& d) {
    return (d.name.empty() ? d.kind : d.name) == detector;
  });
  return measured && (observer.empty() || has_name(scene.observers, observer)) &&
         (variant.empty() ? scene.variants.empty() : has_name(scene.variants, variant));
}

std::string shown_names(const std::array<std::string, 3>& names) {
  std::string shown = names[0];
  for (const std::string* name : {&names[1], &names[2]}) {
    if (!name->empty()) shown += " / " + *name;
  }
  return shown;
}

}  // namespace

Reference load_reference(const std::string& file) {
  const std::string text = text::read_input_file(file);
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) fail(file, 0, "is empty; expected a summary.json or a delay.csv");
  return text[first] == '{' ? from_summary(file, text) : from_table(file, text);
}

void check_reference(const Reference& reference, const Scene& scene) {
  std::set<std::string> known;
  for (const auto& [path, value] : reference.totals) {
    const bool fits = path == kFirst ? std::any_of(scene.detectors.begin(), scene.detectors.end(),
                                                   [](const DetectorSpec& d) { return d.kind == "delay"; })
                                     : may_have(scene, names_of(path));
    if (fits) return;
    known.insert(path == kFirst ? "delay" : shown_names(names_of(path)));
  }
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  if (known.size() > kMostNamed) list = text::counted(known.size(), "record");
  fail(reference.file, 0,
       "holds totals of " + list + ", and none of this scene's; expected one detector, observer and variant in common");
}

double relative_true_error(const Result& result, const Reference& reference) {
  double largest = std::nan("");
  for (const auto& total : io::totals(result)) {
    const double wanted = wanted_total(result, total, reference);
    // A zero that was expected to be zero has no error.
    const double error = total.value == wanted ? 0.0 : std::fabs(total.value - wanted) / std::fabs(wanted);
    if (!std::isnan(error) && !(error <= largest)) largest = error;
  }
  return largest;
}

namespace io {

std::string total_path(const Total& total) {
  const ResultKey& key = total.key;
  std::string path =
      key.detector + "/" + key.observer + "/" + key.variant + "/" + key.band + "/" + std::to_string(key.orientation);
  if (!total.sum.empty()) path += "/" + total.sum + "/" + std::to_string(total.number);
  return path;
}

double first_reference_total(const Result& result, const Reference& reference) {
  const auto all = totals(result);
  return all.empty() ? std::nan("") : wanted_total(result, all.front(), reference);
}

}  // namespace io

}  // namespace clray
