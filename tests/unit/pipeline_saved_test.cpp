// SPDX-License-Identifier: Apache-2.0
// Files of sums: what is written is read, and no damaged byte, no cut and no lie about a length is taken or harms.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "clray/error.hpp"
#include "pipeline/saved_sums.hpp"
#include "support/sealed_sums.hpp"

using namespace clray;

namespace {

SumLayout layout() {
  SumLayout layout;
  layout.shape = {2, 1, 1, 3};
  TableSum weight, count, greatest;
  weight.rows = count.rows = greatest.rows = SumRows::connection;
  weight.scale = SumScale::weight;
  count.scale = SumScale::count;
  greatest.scale = SumScale::greatest;
  layout.add(weight, 1500);
  layout.add(count, 7);
  layout.add(greatest, 5);
  return layout;
}

Sums some_sums(unsigned seed) {
  std::mt19937_64 random(seed);
  Sums sums(layout());
  for (std::uint64_t k = 0; k < sums.values.size(); ++k) {
    const auto value = static_cast<Sum>(static_cast<std::int64_t>(random()));
    if (k > 3000) sums.values.set(k, k % 1000 == 7 ? value * (Sum{1} << 40) - 1 : k % 3 == 0 ? value : 0);
  }
  for (std::uint64_t k = 0; k < sums.counts.size(); ++k) sums.counts.set(k, random() >> (k % 2 == 0 ? 40 : 20));
  sums.events[1][2] = random();
  sums.points = {random(), 3};
  sums.rounding = {1.5, -0.0};
  return sums;
}

SavedSums some() {
  SavedSums sums;
  sums.note = {"/a folder", "clray", ""};
  sums.share = {2, 5};
  sums.passes.resize(2);
  SavedPass& pass = sums.passes[0];
  pass.fingerprint = 77;
  pass.complete = true;
  pass.first = {0, 4};
  pass.found = some_sums(1);
  pass.epochs = {0, 3};
  pass.notes = {{1, 2, 3, 0.25}};
  pass.errors.push_back({"search", 16384, 0.01, 0.03, 0.34});
  pass.search_s = 0.5;
  sums.passes[1].step = {1, 1024, 2048, {0, 1}, 512, some_sums(2)};
  return sums;
}

bool refused(const std::string& bytes) {
  try {
    from_bytes(bytes, "a file");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::input);
    CHECK(error.context() == "a file");
    return true;
  }
  return false;
}

}  // namespace

TEST_CASE("sums are read as they were written, wide, narrow and none") {
  const SavedSums sums = some();
  const std::string bytes = to_bytes(sums);
  const SavedSums again = from_bytes(bytes, "a file");
  CHECK(to_bytes(again) == bytes);
  CHECK(again.note == sums.note);
  CHECK(again.share.number == 2);
  CHECK(again.share.of == 5);
  const Sums &a = sums.passes[0].found, &b = again.passes[0].found;
  REQUIRE(fits(b, layout()));
  for (std::uint64_t k = 0; k < a.values.size(); ++k) REQUIRE((a.values[k] == b.values[k]));
  for (std::uint64_t k = 0; k < a.counts.size(); ++k) REQUIRE(a.counts[k] == b.counts[k]);
  CHECK(a.events == b.events);
  CHECK(a.points == b.points);
  CHECK(a.rounding == b.rounding);
  CHECK(again.passes[0].notes[0].error == 0.25);
  CHECK(again.passes[0].errors[0].phase == "search");
  CHECK(again.passes[1].step.done == 512);
  CHECK(again.passes[1].step.views == sums.passes[1].step.views);
  SumLayout other = layout();
  other.shape.views = 1;
  CHECK_FALSE(fits(b, other));
}

TEST_CASE("sums of many blocks of a file are read as they were written, and a byte of any block matters") {
  SavedSums sums = some();
  SumLayout large = layout();
  large.blocks.clear();
  large.values = large.counts = 0;
  TableSum weight;
  weight.rows = SumRows::connection;
  weight.scale = SumScale::weight;
  large.add(weight, 100'000);  // 2 views, 3 replicates: 600,000 numbers, from 4.8 MB on
  sums.passes[1].found = Sums(large);
  std::mt19937_64 random(8);
  Sums& found = sums.passes[1].found;
  for (std::uint64_t k = 0; k < found.values.size(); ++k) {
    const auto value = static_cast<Sum>(static_cast<std::int64_t>(random()));
    found.values.set(k, k / 1024 % 5 == 3 ? value * (Sum{1} << 50) : value);
  }
  sums.note.emplace_back(3 * text::kBlockOfBytes / 2, 'n');  // a word longer than a block
  std::string bytes;
  std::size_t most = 0;
  write_sums(sums, [&](std::string_view block) {
    most = std::max(most, block.size());
    bytes.append(block);
  });
  CHECK(most == text::kBlockOfBytes);
  REQUIRE(bytes.size() > 6 * text::kBlockOfBytes);
  const SavedSums again = from_bytes(bytes, "a file");
  CHECK(again.note == sums.note);
  bool same = fits(again.passes[1].found, large) == fits(found, large);
  for (std::uint64_t k = 0; k < found.values.size(); ++k)
    same = same && found.values[k] == again.passes[1].found.values[k];
  CHECK(same);
  CHECK((to_bytes(again) == bytes));
  for (int k = 0; k < 40; ++k) {
    std::string bad = bytes;
    bad[random() % bad.size()] ^= static_cast<char>(1 << random() % 8);
    CHECK(refused(bad));
  }
}

TEST_CASE("sums add: values and counts by adding, the greatest by the greater") {
  const SumLayout l = layout();
  Sums a(l), b(l);
  const SumBlock& greatest = l.blocks[2];
  a.values.set(4, 5);
  b.values.set(4, (Sum{1} << 90) - 7);
  a.counts.set(3, 10);
  b.counts.set(3, 20);
  a.counts.set(greatest.offset, 10);
  b.counts.set(greatest.offset, 20);
  a.counts.set(greatest.offset + 1, 10);
  b.counts.set(greatest.offset + 1, 2);
  a.points = {8, 8};
  b.points = {16, 16};
  b.events[0][1] = 3;
  b.area_rounding = {0.5, 0.25};
  a.add(l, b);
  CHECK((a.values[4] == (Sum{1} << 90) - 2));
  CHECK(a.counts[3] == 30);
  CHECK(a.counts[greatest.offset] == 20);
  CHECK(a.counts[greatest.offset + 1] == 10);
  CHECK(a.events[0][1] == 3);
  CHECK(a.points[0] == 8);
  CHECK(a.area_rounding == std::vector<double>{0.5, 0.25});
}

TEST_CASE("a file of sums with any byte changed, or cut anywhere, is refused") {
  const std::string bytes = to_bytes(some());
  REQUIRE_FALSE(refused(bytes));
  std::mt19937 random(3);
  for (int k = 0; k < 2000; ++k) {
    std::string bad = bytes;
    const std::size_t at = k < 60 ? static_cast<std::size_t>(k) : random() % bytes.size();
    bad[at] = static_cast<char>(bad[at] ^ (1 << random() % 8));
    CHECK(refused(bad));
  }
  for (std::size_t length = 0; length < bytes.size(); length += length < 100 ? 1 : 997)
    CHECK(refused(bytes.substr(0, length)));
  CHECK(refused(bytes + "x"));
}

TEST_CASE("a file of sums that lies, with a right checksum, is refused or read, and takes no more memory than it has") {
  const std::string whole = to_bytes(some());
  const std::string rest = clray_test::between_seals(whole);
  std::mt19937_64 random(4);
  int taken = 0;
  for (int k = 0; k < 2000; ++k) {
    std::string bad = rest;
    const std::size_t at = random() % (k % 2 == 0 ? 200 : bad.size());
    const std::uint64_t lie = k % 3 == 0 ? random() : k % 3 == 1 ? ~0ull >> (random() % 64) : random() % 256;
    for (std::size_t b = 0; b < 8 && at + b < bad.size(); ++b) bad[at + b] = static_cast<char>(lie >> (8 * b));
    if (k % 5 == 0) bad.resize(random() % bad.size());
    try {
      from_bytes(clray_test::sealed(bad), "a file");
      ++taken;
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::input);
    }
  }
  CHECK(taken > 0);
}
