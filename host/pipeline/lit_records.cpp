// SPDX-License-Identifier: Apache-2.0
// See lit_records.hpp.
#include "pipeline/lit_records.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace clray {

std::string record_label(const ResultKey& key, const char* fallback) {
  std::string text = key.detector.empty() ? fallback : key.detector;
  if (!key.observer.empty()) text += ", observer " + key.observer;
  if (!key.variant.empty()) text += ", variant " + key.variant;
  if (!key.band.empty()) text += ", band " + key.band;
  return text;
}

void LitRecords::note(const TableRow& row, const ResultKey& key, bool lit) {
  auto& records = kinds_[row.pixel ? 2 : row.connects ? 0 : 1];
  const std::string name = record_label(key);
  const auto found = std::find_if(records.begin(), records.end(), [&](const auto& r) { return r.first == name; });
  if (found == records.end()) {
    records.emplace_back(name, lit);
  } else {
    found->second = found->second || lit;
  }
}

std::vector<std::string> LitRecords::warnings(bool sampled) const {
  const char* const what[] = {
      sampled ? "no hits: rays found nothing that is lit and seen" : "no hits: nothing that was lit is seen",
      sampled ? "no hits: rays found no light on the body" : "no hits: no light meets the body",
      "black pictures: nothing that is seen was lit"};
  std::vector<std::string> warnings;
  for (std::size_t kind = 0; kind < kinds_.size(); ++kind) {
    std::string names;
    std::size_t dark = 0;
    for (const auto& [name, lit] : kinds_[kind]) {
      if (!lit && ++dark <= 4) names += (names.empty() ? "" : "; ") + name;
    }
    if (dark == 0) continue;
    if (dark > 4) names += fmt::format("; and {} more", dark - 4);
    const bool all = dark == kinds_[kind].size() && dark > 1;
    warnings.push_back(fmt::format("{}: all results are zero ({})", what[kind], all ? "all records" : names));
  }
  return warnings;
}

}  // namespace clray
