// SPDX-License-Identifier: Apache-2.0
// See run_saver.hpp.
#include "pipeline/run_saver.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

#include "clray/error.hpp"
#include "pipeline/clock.hpp"
#include "text/output_file.hpp"

namespace clray {
namespace {

constexpr double kMostOverhead = 0.05;  // of the time, for saving

}  // namespace

void RunSaver::begin(const std::vector<PassPlan>& plans, const Geometry& geometry) {
  geometry_ = &geometry;
  last_s_ = now();
  std::vector<const SumLayout*> layouts;
  plans_ = passes_of(plans);
  for (const PassPlan* plan : plans_) layouts.push_back(&plan->layout);
  std::vector<SavedSums> found;
  for (const std::string& name : saving_.from) {
    found.push_back(read_sums_file(name));
    check(found.back().passes, name);
  }
  const bool shares = found.size() > 1 || (found.size() == 1 && found[0].share.of > 1 && !has_one_of_several());
  if (shares) {
    sums_ = merged(std::move(found), saving_.from, layouts);
  } else if (!found.empty()) {
    sums_ = std::move(found.front());
    if (sums_.share.number != share().number || sums_.share.of != share().of)
      throw Error(ErrorCode::usage, "it has another share of the run", saving_.from.front());
  } else {
    sums_.passes.resize(plans_.size());
  }
  sums_.note = saving_.note;
  sums_.share = saving_.share;
}

void RunSaver::check(const std::vector<SavedPass>& passes, const std::string& name) const {
  bool same = passes.size() == plans_.size();
  for (std::size_t k = 0; same && k < passes.size(); ++k)
    same = passes[k].fingerprint == fingerprint_of(*plans_[k], *geometry_);
  if (!same)
    throw Error(ErrorCode::usage,
                "these sums belong to another scene, to other options (such as --seed or --method), or to another "
                "version of clray",
                name);
  for (std::size_t k = 0; k < passes.size(); ++k) {
    const SavedPass& pass = passes[k];
    const std::size_t views = plans_[k]->layout.shape.views;
    for (const Sums* sums : {&pass.found, &pass.confirmed, &pass.step.more}) {
      if (!sums->points.empty() && !fits(*sums, plans_[k]->layout))
        throw Error(ErrorCode::input, "the file is damaged", name);
    }
    const bool views_fit =
        (pass.first.empty() || pass.first.size() == views) && (pass.epochs.empty() || pass.epochs.size() == views);
    if (!views_fit) throw Error(ErrorCode::input, "the file is damaged", name);
  }
}

SavedPass& RunSaver::pass(const PassPlan& plan) {
  const auto at = std::find(plans_.begin(), plans_.end(), &plan);
  return sums_.passes[static_cast<std::size_t>(at - plans_.begin())];
}

bool RunSaver::has_anything() const {
  return std::any_of(sums_.passes.begin(), sums_.passes.end(),
                     [](const SavedPass& pass) { return pass.complete || !pass.notes.empty() || pass.step.done > 0; });
}

Sums RunSaver::hand_over(const PassPlan& plan, bool whole) {
  const bool last = plans_.back() == &plan;
  if (last && whole && saving_.keep) save();
  Sums& found = pass(plan).found;
  return writes() && !last ? found : std::move(found);  // files that later passes write have them, too
}

Checkpoint RunSaver::checkpoint() {
  Checkpoint c;
  if (!writes() || saving_.every_s <= 0.0) return c;
  c.every_s = saving_.every_s;
  c.due = [this] { return now() - last_s_ > std::max(saving_.every_s, cost_s_ / kMostOverhead); };
  c.save = [this] { save(); };
  return c;
}

void RunSaver::save() {
  if (!writes()) return;
  const double start = now();
  for (std::size_t k = 0; k < plans_.size(); ++k) {
    std::uint64_t& print = sums_.passes[k].fingerprint;
    if (print == 0) print = fingerprint_of(*plans_[k], *geometry_);
  }
  std::error_code ignored;  // what cannot be made cannot be written to
  const std::filesystem::path folder = std::filesystem::path(saving_.file).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
  text::replace_output_file(saving_.file, [this](text::OutputFile& file) {
    write_sums(sums_, [&](std::string_view block) { file.put(block); });
  });
  last_s_ = now();
  cost_s_ = last_s_ - start;
}

bool is_saved(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string head(kSavedMagic.size(), '\0');
  return in.read(head.data(), static_cast<std::streamsize>(head.size())) && head == kSavedMagic;
}

SavedRun read_saved(const std::string& file) {
  const SavedSums sums = read_sums_file(file);
  SavedRun run{sums.note, sums.share, true};
  for (const SavedPass& pass : sums.passes) run.complete = run.complete && pass.complete;
  return run;
}

}  // namespace clray
