// SPDX-License-Identifier: Apache-2.0
// See harness.hpp.
#include "laws/harness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "clray/error.hpp"
#include "clray/trace.hpp"
#include "laws/scene_text.hpp"
#include "support/scenes.hpp"

namespace clray_test {

using clray::Result;
using clray::Scene;

namespace {

constexpr int kLog2Rays = 13;
constexpr double kAlarm = 0.05;       // of a trial, by chance, that is run again
constexpr double kFalseAlarm = 0.01;  // of all trials together, that any fails by chance
constexpr double kTrialsOfScene = 7.0;

constexpr std::size_t kMostLines = 8;  // of records that deviate

std::string folder_of(const std::string& name) {
  return std::filesystem::temp_directory_path().string() + "/clray-laws/" + name;
}

std::string text_of(const Comparison& c) {
  return fmt::format("  {}: {:.6g} ± {:.2g} in the first, {:.6g} ± {:.2g} in the second: t = {:.1f}", c.name,
                     c.first.value, c.first.error, c.second.value, c.second.error, c.t);
}

std::string lines_of(const std::vector<std::string>& found) {
  std::string text;
  for (std::size_t i = 0; i < found.size() && i < kMostLines; ++i) text += found[i] + "\n";
  if (found.size() > kMostLines) text += fmt::format("  and {} more\n", found.size() - kMostLines);
  return text;
}

/// Equal bits; but the force on the body is that on its parts, added in their order, and angles and windows are worked
/// out from positions: 1e-13 of the scale is a few roundings.
bool same_bits(const Comparison& c, bool solved) {
  if (std::isnan(c.first.value) && std::isnan(c.second.value)) return true;
  const std::string& kind = c.second.kind;
  const bool added = kind == "force" || kind == "torque" || kind == "window" || kind == "exact" || kind == "balance";
  // Exact numbers are sums over pieces that another view or other faces cut elsewhere.
  const double slack = (solved  ? 1e-11
                        : added ? 1e-13
                                : 0.0) *
                       std::max(std::fabs(c.first.scale), std::fabs(c.first.value));
  return std::fabs(c.first.value - c.second.value) <= slack && std::fabs(c.first.error - c.second.error) <= slack;
}

/// Warnings that speak of a run's rays and not of its scene.
bool of_sampling(const std::string& warning) {
  return warning.find("claimed error") != std::string::npos || warning.find("target error") != std::string::npos;
}

std::set<std::string> kinds_of(const Result& result) {
  std::set<std::string> kinds;
  for (const std::string& w : result.warnings) {
    if (!of_sampling(w)) kinds.insert(warning_kind(w));
  }
  return kinds;
}

/// Kinds of warning of the run alone that the combined run lacks. Left out: what is near its threshold of 1 %, and
/// "no hits" and "black pictures", which are right for a dark member of a bright run: a picture holds all bands.
std::vector<std::string> missing_warnings(const Result& combined, const Result& one) {
  std::vector<std::string> missing;
  const std::set<std::string> there = kinds_of(combined);
  const clray::Diagnostics& d = one.diagnostics;
  for (const std::string& kind : kinds_of(one)) {
    if (kind.find("no hits") != std::string::npos || kind.find("black pictures") != std::string::npos) continue;
    if (kind.find("cut off") != std::string::npos && d.truncated_energy_fraction < 0.02) continue;
    if (kind.find("window") != std::string::npos && std::max(d.above_window_fraction, d.below_window_fraction) < 0.02)
      continue;
    if (there.count(kind) == 0) missing.push_back(kind);
  }
  return missing;
}

/// Whether a record is of the member that a warning names: "detector, observer a, variant b, band c".
bool is_of(const std::string& record, const std::string& member) {
  std::size_t at = 0;
  for (std::size_t end; at < member.size(); at = end + 2) {
    end = std::min(member.find(", ", at), member.size());
    std::string word = member.substr(at, end - at);
    for (const char* kind : {"observer ", "variant ", "band "}) {
      if (word.rfind(kind, 0) == 0) word.erase(0, std::string(kind).size());
    }
    if (("/" + record).find("/" + word + "/") == std::string::npos) return false;
  }
  return true;
}

/// Records that a warning calls zero and that are not.
std::vector<std::string> lit_though_dark(const std::string& warning, const Records& records) {
  std::vector<std::string> lit;
  const std::size_t open = warning.find("all results are zero (");
  if (open == std::string::npos) return lit;
  const std::string names = warning.substr(warning.find('(', open) + 1);
  const std::string kind = warning.find("picture") != std::string::npos ? "picture"
                           : warning.find("seen") != std::string::npos  ? "total"
                                                                        : "force";
  for (const auto& [name, r] : records) {
    if (r.kind != kind || r.value == 0.0 || name.find("/absorbed") != std::string::npos) continue;
    bool named = names.rfind("all records", 0) == 0;
    for (std::size_t at = 0, end; at < names.size() && !named; at = end + 2) {
      end = std::min(names.find(';', at), names.find(')', at));
      named = is_of(name, names.substr(at, end - at));
    }
    if (named) lit.push_back(name);
  }
  return lit;
}

/// What must hold within any result, exactly or to rounding.
std::vector<std::string> broken(const Result& result, const Scene& scene) {
  std::vector<std::string> faults;
  const auto fault = [&](const std::string& what) { faults.push_back("  within one result: " + what); };
  const auto& e = result.paths;
  if (e.started != e.escaped + e.killed + e.capped)
    fault(fmt::format("{} paths started, {} escaped, {} killed, {} capped", e.started, e.escaped, e.killed, e.capped));
  for (const auto& d : result.delay) {
    double sum = d.below_m2_per_sr + d.above_m2_per_sr;
    for (const double bin : d.bin_m2_per_sr) sum += bin;
    const double total = d.intensity_m2_per_sr.value;
    // Additions of so many numbers, each rounded.
    if (!(std::fabs(sum - total) <= 1e-12 * total))
      fault(fmt::format("bins of {} sum to {}, not {}", d.key.detector, sum, total));
  }
  const Records records = records_of(result, scene);
  for (const std::string& w : result.warnings) {
    for (const std::string& lit : lit_though_dark(w, records)) fault("\"" + w + "\", but " + lit + " is not");
  }
  for (const auto& p : result.pressure) {
    clray::Vec3 sum(0.0), size(0.0);
    for (const auto& part : p.component_m2) {
      sum += part.value;
      for (int k = 0; k < 3; ++k) size[k] += std::fabs(part.value[k]);
    }
    for (int k = 0; k < 3; ++k) {
      if (!(std::fabs(sum[k] - p.coefficient_m2.value[k]) <= 1e-12 * size[k]))
        fault(fmt::format("shares of {} do not sum to its force", p.key.detector));
    }
  }
  return faults;
}

std::vector<Comparison> compare(const Trial& trial, const Result& first, const Result& second) {
  Records b = records_of(second, trial.second, trial.second_names);
  if (trial.adjust) b = trial.adjust(b);
  if (trial.only) {
    for (auto it = b.begin(); it != b.end();) it = trial.only(it->first, it->second) ? std::next(it) : b.erase(it);
  }
  return compare_records(records_of(first, trial.first), b);
}

}  // namespace

int law_scenes() {
  const char* asked = std::getenv("CLRAY_LAWS_SCENES");
  if (asked != nullptr) return std::atoi(asked);
  return long_tests() ? 334 : 2;
}

int law_frames() {
  return law_scenes() > 100 ? 40 : 6;
}

Result LawHarness::run_with(Scene scene, int log2_rays, std::uint64_t seed) const {
  rays(scene, log2_rays, seed);
  if (solved_) {
    // Rays that are asked for ask for points. A target that nobody meets takes as many.
    scene.trace.method = clray::Method::automatic;
    scene.trace.rays = 0;
    scene.trace.target_error_percent = 1e-9;
    scene.trace.max_rays = std::uint64_t{1} << log2_rays;
  }
  const Result result = clray_test::run(scene);
  const auto count = [&](const clray::Estimate& a) { ++methods_[a.exact() ? 2 : a.partly_exact() ? 1 : 0]; };
  for (const auto& d : result.delay) count(d.intensity_m2_per_sr);
  for (const auto& s : result.spectrometer) count(s.intensity_m2_per_sr);
  return result;
}

double LawHarness::trials() const {
  return kTrialsOfScene * scenes_;
}

void LawHarness::fail(const RandomScene& random, const Trial* trial, const std::string& what) {
  const std::string folder =
      folder_of(fmt::format("{}-{}-{}", static_cast<int>(group_), random.seed, failures_.size()));
  std::string text = fmt::format("seed {}: {}\n{}\n", random.seed, trial != nullptr ? trial->law : "the scene", what);
  if (trial != nullptr) {
    text += "# the first scene\n" + write_scene(trial->first, folder + "-first");
    text += "# the second scene\n" + write_scene(trial->second, folder + "-second");
  } else {
    text += write_scene(random.scene, folder);
  }
  failures_.push_back(text);
}

void LawHarness::judge_again(const RandomScene& random, const Trial& trial, const std::vector<std::string>& names) {
  ++again_;
  const Result first = run_with(trial.first, kLog2Rays + 4, 7000 + random.seed);
  const Result second = run_with(trial.second, kLog2Rays + 4, 8000 + random.seed);
  const double limit = student_limit(kFalseAlarm / (trials() * kAlarm) / static_cast<double>(names.size()));
  std::vector<std::string> found;
  for (const Comparison& c : compare(trial, first, second)) {
    if (std::find(names.begin(), names.end(), c.name) == names.end()) continue;
    if (!c.counts)
      ++doubtful_;
    else if (c.t > limit)
      found.push_back(text_of(c) + fmt::format(", limit {:.1f}", limit));
  }
  if (!found.empty()) fail(random, &trial, lines_of(found));
}

void LawHarness::run_trial(const RandomScene& random, const Trial& trial, const Result& combined) {
  ++tried_;
  Result other;
  const std::uint64_t seed = random.seed;
  const Result* first = &combined;
  Result second;
  try {
    if (!trial.of_scene) {
      other = run_with(trial.first, kLog2Rays, seed);
      first = &other;
    }
    second = run_with(trial.second, kLog2Rays, trial.same_bits ? seed : seed + 5000);
  } catch (const clray::Error& e) {
    return fail(random, &trial, std::string("  refused: ") + e.what());
  }
  for (const std::string& what : broken(second, trial.second)) fail(random, &trial, what);
  const std::vector<Comparison> all = compare(trial, *first, second);
  compared_ += static_cast<int>(all.size());
  if (trial.warnings) {
    for (const std::string& kind : missing_warnings(*first, second))
      fail(random, &trial, "  a warning of the second that the first lacks: " + kind);
  }
  if (trial.same_bits) {
    std::vector<std::string> found;
    for (const Comparison& c : all) {
      if (!same_bits(c, solved_)) found.push_back(text_of(c) + ", and must be of equal bits");
    }
    if (!found.empty()) fail(random, &trial, lines_of(found));
    return;
  }
  of_scene_.insert(of_scene_.end(), all.begin(), all.end());
  const double limit = student_limit(kAlarm / std::max<std::size_t>(all.size(), 1));
  std::vector<std::string> suspects;
  for (const Comparison& c : all) {
    if (c.t > limit) suspects.push_back(c.name);
  }
  if (!suspects.empty()) judge_again(random, trial, suspects);
}

void LawHarness::run_scene(std::uint64_t seed) {
  const RandomScene random = draw_scene(seed, frames_, flat(seed));
  of_scene_.clear();
  Result combined;
  try {
    combined = run_with(random.scene, kLog2Rays, seed);
  } catch (const clray::Error& e) {
    // Refused before anything is traced, in words: no wrong number.
    if (e.code() == clray::ErrorCode::input || e.code() == clray::ErrorCode::usage) {
      ++refused_;
      refusals_.push_back(fmt::format("seed {}: {}", seed, e.what()));
    } else {
      fail(random, nullptr, std::string("  ") + e.what());
    }
    return;
  }
  for (const std::string& what : broken(combined, random.scene)) fail(random, nullptr, what);
  Draw draw(seed + 900000);
  std::vector<Trial> trials;
  if (group_ == LawGroup::alone) trials = alone_trials(random, combined, draw);
  if (group_ == LawGroup::order) trials = order_trials(random, draw);
  if (group_ == LawGroup::symmetry) trials = symmetry_trials(random, combined, draw);
  for (const Trial& trial : trials) run_trial(random, trial, combined);
  chi_.add_scene(of_scene_);
}

std::vector<std::string> LawHarness::run() {
  if (const char* asked = std::getenv("CLRAY_LAWS_SEED")) {
    const std::uint64_t seed = std::strtoull(asked, nullptr, 10);
    const std::string folder = folder_of(std::to_string(seed));
    write_scene(draw_scene(seed, frames_, flat(seed)).scene, folder);
    fmt::print("the scene of seed {} is {}/scene.toml\n", seed, folder);
    run_scene(seed);
  } else {
    for (int s = 1; s <= scenes_; ++s)
      run_scene(1000 * static_cast<std::uint64_t>(group_) + static_cast<std::uint64_t>(s));
  }
  if (refused_ > scenes_ / 5) {
    std::string text = fmt::format("{} of {} scenes were refused:\n", refused_, scenes_);
    for (const std::string& why : refusals_) text += "  " + why + "\n";
    failures_.push_back(text);
  }
  return failures_;
}

std::string LawHarness::counts() const {
  return fmt::format("{} trials, {} records, {} trials again, {} records doubtful there, {} scenes refused", tried_,
                     compared_, again_, doubtful_, refused_);
}

std::string LawHarness::summary() const {
  std::string text = counts();
  for (const auto& [kind, m] : chi_.means())
    text += fmt::format("\n  {}: mean t² {:.3f} ± {:.3f} over {:.0f} records of {} scenes", kind, m.mean, m.error,
                        m.records, m.scenes);
  for (const std::string& why : refusals_) text += "\n  refused: " + why;
  return text;
}

std::vector<std::string> LawHarness::small_claims() const {
  // The difference of two runs of 16 replicates has 15 (one of them alone makes the error) to 30 degrees of freedom: a
  // mean t² of 15/13 at most. Beside it, 5 % of the error for replicates that are not quite normal.
  constexpr double kMost = 15.0 / 13.0 * 1.05 * 1.05;
  constexpr int kFew = 20;  // scenes from which on the spread between them says something
  std::vector<std::string> found;
  for (const auto& [kind, m] : chi_.means()) {
    if (m.scenes >= kFew && m.mean - 4.0 * m.error > kMost)
      found.push_back(
          fmt::format("{}: mean t² {:.3f} ± {:.3f}, at most {:.2f} expected", kind, m.mean, m.error, kMost));
  }
  return found;
}

}  // namespace clray_test
