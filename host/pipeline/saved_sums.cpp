// SPDX-License-Identifier: Apache-2.0
// Files of sums; see saved_sums.hpp. A file is: "clray sums", a version, the sums, and the checksum of these, which
// stands at the end, since nothing that was written is gone back to. Numbers are little-endian. Pages of numbers are
// nothing, narrow or wide, as in memory.
#include "pipeline/saved_sums.hpp"

#include <algorithm>
#include <cstdio>
#include <type_traits>

#include "clray/error.hpp"
#include "device/embedded.hpp"
#include "pipeline/pass_buffers.hpp"
#include "text/hash.hpp"
#include "text/input_file.hpp"

namespace clray {
namespace {

constexpr std::uint64_t kVersion = 2;
constexpr std::uint64_t kPage = 1024;  // numbers of a page of a file
constexpr std::size_t kWord = 8;       // bytes of the version and of the checksum

using text::BytesReader;
using text::BytesWriter;

template <class Narrow, class Wide>
void put(BytesWriter& out, const PagedNumbers<Narrow, Wide>& numbers) {
  out.number(numbers.size());
  for (std::uint64_t first = 0; first < numbers.size(); first += kPage) {
    const std::uint64_t count = std::min<std::uint64_t>(kPage, numbers.size() - first);
    int kind = 0;
    for (std::uint64_t k = numbers.next(first); k < first + count && kind < 2; ++k) {
      const Wide value = numbers[k];
      if (value != 0) kind = static_cast<Wide>(static_cast<Narrow>(value)) == value ? std::max(kind, 1) : 2;
    }
    out.number(static_cast<std::uint64_t>(kind), 1);
    if (kind == 1)
      out.many<sizeof(Narrow)>(
          count, [&](std::uint64_t k) { return static_cast<std::uint64_t>(static_cast<Narrow>(numbers[first + k])); });
    if (kind == 2) {
      constexpr std::uint64_t kWords = sizeof(Wide) / 8;
      out.many<8>(kWords * count, [&](std::uint64_t k) {
        return static_cast<std::uint64_t>(static_cast<unsigned __int128>(numbers[first + k / kWords]) >>
                                          (64 * (k % kWords)));
      });
    }
  }
}

template <class Narrow, class Wide>
void get(BytesReader& in, PagedNumbers<Narrow, Wide>* numbers) {
  const std::uint64_t size = in.number();
  if (size / kPage > in.left()) in.fail();
  *numbers = PagedNumbers<Narrow, Wide>(size);
  for (std::uint64_t first = 0; first < size; first += kPage) {
    const std::uint64_t count = std::min<std::uint64_t>(kPage, size - first);
    const std::uint64_t kind = in.number(1);
    if (kind > 2) in.fail();
    if (kind == 1)
      in.many<sizeof(Narrow)>(count, [&](std::uint64_t k, std::uint64_t number) {
        numbers->set(first + k, static_cast<Wide>(static_cast<Narrow>(number)));
      });
    if (kind == 2) {
      constexpr std::uint64_t kWords = sizeof(Wide) / 8;
      unsigned __int128 value = 0;
      in.many<8>(kWords * count, [&](std::uint64_t k, std::uint64_t number) {
        value = k % kWords == 0 ? number : value | static_cast<unsigned __int128>(number) << 64;
        if (k % kWords == kWords - 1) numbers->set(first + k / kWords, static_cast<Wide>(value));
      });
    }
  }
}

}  // namespace

void put(BytesWriter& out, const Sums& sums) {
  put(out, sums.values);
  put(out, sums.counts);
  out.number(sums.events.size());
  for (const auto& view : sums.events) {
    for (const std::uint64_t n : view) out.number(n);
  }
  out.numbers(sums.points);
  out.reals(sums.rounding);
  out.reals(sums.area_rounding);
}

Sums get_sums(BytesReader& in) {
  Sums sums;
  get(in, &sums.values);
  get(in, &sums.counts);
  sums.events.resize(in.count(CLRAY_COUNTERS * sizeof(std::uint64_t)));
  for (auto& view : sums.events) {
    for (std::uint64_t& n : view) n = in.number();
  }
  sums.points = in.numbers<std::uint64_t>();
  sums.rounding = in.reals();
  sums.area_rounding = in.reals();
  return sums;
}

namespace {

void put(BytesWriter& out, const SavedPass& pass) {
  out.number(pass.fingerprint);
  out.number(pass.complete ? 1 : 0, 1);
  out.numbers(pass.first);
  put(out, pass.found);
  put(out, pass.confirmed);
  out.numbers(pass.epochs);
  out.number(pass.notes.size());
  for (const StepNote& note : pass.notes) {
    out.number(note.view, 4);
    out.number(note.epoch, 4);
    out.number(note.points);
    out.real(note.error);
  }
  out.number(pass.errors.size());
  for (const ErrorPoint& e : pass.errors) {
    out.text(e.phase);
    out.number(e.rays);
    for (const double x : {e.seconds, e.relative_standard_error, e.first_total, e.first_standard_error}) out.real(x);
  }
  out.real(pass.search_s);
  out.real(pass.confirm_s);
  out.number(pass.step.epoch, 4);
  out.number(pass.step.from);
  out.number(pass.step.points);
  out.numbers(pass.step.views);
  out.number(pass.step.done);
  put(out, pass.step.more);
}

SavedPass get_pass(BytesReader& in) {
  SavedPass pass;
  pass.fingerprint = in.number();
  pass.complete = in.number(1) != 0;
  pass.first = in.numbers<std::uint64_t>();
  pass.found = get_sums(in);
  pass.confirmed = get_sums(in);
  pass.epochs = in.numbers<std::uint32_t>();
  pass.notes.resize(in.count(24));
  for (StepNote& note : pass.notes) {
    note.view = static_cast<std::uint32_t>(in.number(4));
    note.epoch = static_cast<std::uint32_t>(in.number(4));
    note.points = in.number();
    note.error = in.real();
  }
  pass.errors.resize(in.count(48));
  for (ErrorPoint& e : pass.errors) {
    e.phase = in.text();
    e.rays = in.number();
    for (double* x : {&e.seconds, &e.relative_standard_error, &e.first_total, &e.first_standard_error}) *x = in.real();
  }
  pass.search_s = in.real();
  pass.confirm_s = in.real();
  pass.step.epoch = static_cast<std::uint32_t>(in.number(4));
  pass.step.from = in.number();
  pass.step.points = in.number();
  pass.step.views = in.numbers<std::uint32_t>();
  pass.step.done = in.number();
  pass.step.more = get_sums(in);
  return pass;
}

template <class T>
std::uint64_t sum_of(std::uint64_t state, const T* data, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  state = checksum(&count, sizeof count, state);
  return checksum(data, count * sizeof(T), state);
}

std::uint64_t kernels_sum() {
  static const std::uint64_t all = [] {
    std::uint64_t state = kFnvStart;
    for (const auto& [name, text] : embedded_kernels()) state = sum_of(state, text.data(), text.size());
    return state;
  }();
  return all;
}

}  // namespace

std::vector<const PassPlan*> passes_of(const std::vector<PassPlan>& plans) {
  std::vector<const PassPlan*> passes;
  for (const PassPlan& plan : plans) {
    if (plan.first) passes.push_back(&plan.first->plan);
    passes.push_back(&plan);
  }
  return passes;
}

std::uint64_t fingerprint_of(const PassPlan& plan, const Geometry& geometry) {
  PassBuffers in(plan, geometry);
  in.nodes = {};
  in.leaves = {};  // how faces are found has no say in what is found
  std::uint64_t state = kernels_sum();
#define CLRAY_ADD(type, name) state = sum_of(state, in.name.data, in.name.data != nullptr ? in.name.count : 0);
  CLRAY_BUFFERS(CLRAY_ADD)
#undef CLRAY_ADD
  for (const auto& parts : plan.motions) state = sum_of(state, parts.data(), parts.size());
  const SumShape& shape = plan.layout.shape;
  const auto how = static_cast<std::uint64_t>(plan.request.how);
  for (const std::uint64_t n : {shape.views, shape.lanes, shape.connections, shape.replicates, plan.layout.values,
                                plan.layout.counts, how, static_cast<std::uint64_t>(plan.first != nullptr)})
    state = sum_of(state, &n, 1);
  for (const SumBlock& block : plan.layout.blocks) state = sum_of(state, block.name.data(), block.name.size());
  for (const ViewScales& scales : plan.scales.views) state = sum_of(state, &scales.weight_bits, 1);
  return state != 0 ? state : 1;
}

void write_sums(const SavedSums& sums, const std::function<void(std::string_view)>& put_bytes) {
  BytesWriter head;
  head.raw(kSavedMagic);
  head.number(kVersion);
  put_bytes(head.bytes());
  std::uint64_t sum = kFnvStart;
  BytesWriter out([&](std::string_view block) {
    sum = checksum(block.data(), block.size(), sum);
    put_bytes(block);
  });
  out.numbers(std::vector<std::uint32_t>{sums.share.number, sums.share.of});
  out.number(sums.note.size());
  for (const std::string& word : sums.note) out.text(word);
  out.number(sums.passes.size());
  for (const SavedPass& pass : sums.passes) put(out, pass);
  out.end();
  BytesWriter seal;
  seal.number(sum);
  put_bytes(seal.bytes());
}

SavedSums read_sums(std::uint64_t size, const std::function<void(char*, std::size_t)>& get_bytes,
                    const std::string& name) {
  const std::uint64_t head_size = std::min<std::uint64_t>(size, kSavedMagic.size() + kWord);
  std::string start(head_size, '\0');
  get_bytes(start.data(), start.size());
  if (start.substr(0, kSavedMagic.size()) != kSavedMagic)
    throw Error(ErrorCode::input, "these are no sums of clray", name);
  BytesReader head(std::string_view(start).substr(kSavedMagic.size()), name);
  const std::uint64_t version = head.number();
  if (version != kVersion)
    throw Error(ErrorCode::input,
                "these sums have version " + std::to_string(version) + ", expected " + std::to_string(kVersion), name);
  if (size < head_size + kWord) head.fail();
  std::uint64_t sum = kFnvStart;
  BytesReader in(
      size - head_size - kWord,
      [&](char* where, std::size_t count) {
        get_bytes(where, count);
        sum = checksum(where, count, sum);
      },
      name);
  SavedSums sums;
  const auto share = in.numbers<std::uint32_t>();
  if (share.size() != 2 || share[0] < 1 || share[0] > share[1]) in.fail();
  sums.share = {share[0], share[1]};
  sums.note.resize(in.count(8));
  for (std::string& word : sums.note) word = in.text();
  sums.passes.resize(in.count(64));
  for (SavedPass& pass : sums.passes) pass = get_pass(in);
  if (in.left() != 0) in.fail();
  std::string seal(kWord, '\0');
  get_bytes(seal.data(), seal.size());
  if (BytesReader(seal, name).number() != sum) in.fail();
  return sums;
}

std::string to_bytes(const SavedSums& sums) {
  std::string bytes;
  write_sums(sums, [&](std::string_view block) { bytes.append(block); });
  return bytes;
}

SavedSums from_bytes(std::string_view bytes, const std::string& name) {
  BytesReader all(bytes, name);
  return read_sums(
      bytes.size(), [&](char* where, std::size_t count) { all.take(count).copy(where, count); }, name);
}

SavedSums read_sums_file(const std::string& file) {
  const text::InputFile in = text::open_input(file);
  const std::uint64_t size = text::size_of(in);
  return read_sums(
      size,
      [&](char* where, std::size_t count) {
        if (std::fread(where, 1, count, in.get()) != count) throw Error(ErrorCode::input, "the file is damaged", file);
      },
      file);
}

bool fits(const Sums& sums, const SumLayout& layout) {
  const std::size_t views = layout.shape.views, rows = views * layout.shape.lanes * layout.shape.connections;
  return sums.values.size() == layout.values && sums.counts.size() == layout.counts && sums.events.size() == views &&
         sums.points.size() == views && (sums.rounding.empty() || sums.rounding.size() == rows) &&
         (sums.area_rounding.empty() || sums.area_rounding.size() == views);
}

namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw Error(ErrorCode::usage, why, name);
}

std::string share_name(std::uint32_t number, std::uint32_t of) {
  return "share " + std::to_string(number) + " of " + std::to_string(of);
}

void check_shares(const std::vector<SavedSums>& shares, const std::vector<std::string>& names) {
  const std::uint32_t of = shares.front().share.of;
  std::vector<std::string> seen(of);
  for (std::size_t k = 0; k < shares.size(); ++k) {
    const Share& share = shares[k].share;
    if (share.of != of)
      refuse(names[k], "it is " + share_name(share.number, share.of) + ", others are of " + std::to_string(of));
    if (!seen[share.number - 1].empty())
      refuse(names[k], "it is " + share_name(share.number, of) + ", and so is " + seen[share.number - 1]);
    seen[share.number - 1] = names[k];
    const auto& passes = shares[k].passes;
    if (!std::all_of(passes.begin(), passes.end(), [](const SavedPass& pass) { return pass.complete; }))
      refuse(names[k], share_name(share.number, of) + " is not finished: --resume goes on with it");
    if (passes.size() != shares.front().passes.size()) refuse(names[k], "it belongs to another scene");
  }
  for (std::uint32_t number = 1; number <= of; ++number) {
    if (seen[number - 1].empty()) refuse(names.front(), share_name(number, of) + " is missing");
  }
}

/// Adds the points of a share, which begin where the others end.
void add_points(const SumLayout& layout, const SavedPass& share, SavedPass* to) {
  to->found.add(layout, share.found);
  for (std::size_t v = 0; v < share.found.points.size(); ++v) {
    const std::uint64_t first = share.first.empty() ? 0 : share.first[v];
    if (share.found.points[v] > first) to->found.points[v] += share.found.points[v] - first;
  }
}

}  // namespace

SavedSums merged(std::vector<SavedSums> shares, const std::vector<std::string>& names,
                 const std::vector<const SumLayout*>& layouts) {
  check_shares(shares, names);
  SavedSums all;
  all.note = shares.front().note;
  all.passes.resize(layouts.size());
  for (std::size_t k = 0; k < layouts.size(); ++k) {
    SavedPass& pass = all.passes[k];
    pass.complete = true;
    pass.fingerprint = shares.front().passes[k].fingerprint;
    pass.found = Sums(*layouts[k]);
    pass.epochs.assign(layouts[k]->shape.views, 0);
    for (SavedSums& share : shares) {
      add_points(*layouts[k], share.passes[k], &pass);
      share.passes[k] = SavedPass();
    }
  }
  return all;
}

}  // namespace clray
