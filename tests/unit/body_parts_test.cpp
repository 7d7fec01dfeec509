// SPDX-License-Identifier: Apache-2.0
// Work that cores share, and numbers of primitives brought into another order: against the plain way to do each.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <stdexcept>

#include "body/in_parts.hpp"
#include "body/raw_primitives.hpp"

using namespace clray;

TEST_CASE("sorting in parts is sorting, of any number") {
  std::mt19937 random(5);
  for (const std::size_t count : {0u, 1u, 2u, 1000u, 16384u, 50000u, 300001u}) {
    for (const unsigned most : {0u, 1u, 2u, 3u, 5u, 8u}) {
      CAPTURE(count);
      CAPTURE(most);
      std::vector<std::uint32_t> values(count);
      std::iota(values.begin(), values.end(), 0u);
      std::shuffle(values.begin(), values.end(), random);
      sort_in_parts(
          &values, [](std::uint32_t a, std::uint32_t b) { return a > b; }, most);
      std::size_t wrong = 0;
      for (std::size_t k = 0; k < count; ++k) wrong += values[k] != count - 1 - k;
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("runs of equals are sorted in parts, whatever their lengths") {
  using Pair = std::pair<int, std::uint32_t>;
  std::mt19937 random(6);
  for (const int kinds : {1, 2, 3, 1000, 70000}) {
    CAPTURE(kinds);
    std::vector<Pair> values(100000);
    for (std::uint32_t k = 0; k < values.size(); ++k) values[k] = {static_cast<int>(random() % kinds), k};
    std::shuffle(values.begin(), values.end(), random);
    std::vector<Pair> expected = values;
    std::sort(expected.begin(), expected.end());
    std::stable_sort(values.begin(), values.end(), [](const Pair& a, const Pair& b) { return a.first < b.first; });
    sort_equals_in_parts(
        &values, [](const Pair& a, const Pair& b) { return a.first == b.first; },
        [](const Pair& a, const Pair& b) { return a.second < b.second; });
    CHECK(values == expected);
  }
}

TEST_CASE("each element is in one part, and a failure of any part is thrown") {
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    std::vector<int> seen(1000, 0);
    in_parts(seen.size(), threads, [&](std::size_t first, std::size_t end) {
      for (std::size_t k = first; k < end; ++k) ++seen[k];
    });
    CHECK(std::count(seen.begin(), seen.end(), 1) == 1000);
    const auto fails = [&](std::size_t, std::size_t end) {
      if (end == seen.size()) throw std::runtime_error("the last part");
    };
    CHECK_THROWS_WITH(in_parts(seen.size(), threads, fails), "the last part");
  }
}

TEST_CASE("numbers of primitives are brought into any order, with some left out, by any number of threads") {
  std::mt19937 random(6);
  for (const bool shapes : {false, true}) {
    for (const std::size_t count : {1u, 2u, 50u, 1000u, 40000u}) {  // the last by several threads
      for (const std::size_t kept : {count, (count + 1) / 2}) {
        CAPTURE(shapes);
        CAPTURE(count);
        std::vector<RawPrimitive> raw(count);
        std::vector<double> numbers;
        for (RawPrimitive& one : raw) {
          one.data = static_cast<std::uint32_t>(numbers.size());
          one.size = shapes && random() % 3 == 0 ? 17 : 9;
          for (std::uint32_t k = 0; k < one.size; ++k) numbers.push_back(static_cast<double>(random()));
        }
        std::vector<std::uint32_t> order(count);
        std::iota(order.begin(), order.end(), 0u);
        std::shuffle(order.begin(), order.end(), random);
        order.resize(kept);
        std::vector<double> expected;
        for (const std::uint32_t k : order) {
          for (std::uint32_t n = 0; n < raw[k].size; ++n) expected.push_back(numbers[raw[k].data + n]);
        }
        CHECK(in_order(numbers, raw, order) == expected);
        const std::vector<RawPrimitive> moved = in_order(raw, order);
        bool same = moved.size() == order.size();
        for (std::size_t k = 0; same && k < order.size(); ++k) same = moved[k].data == raw[order[k]].data;
        CHECK(same);
      }
    }
  }
}

TEST_CASE("raw primitives: of neighbours alike in numbers, shape and material one stays, with its numbers") {
  // Triangles a a' b b b and shapes c c, where a' has another material, and the last c another shape.
  std::vector<double> numbers;
  std::vector<RawPrimitive> raw;
  const auto put = [&](double value, std::uint32_t size, std::uint32_t material, std::uint32_t shape) {
    RawPrimitive one;
    one.data = static_cast<std::uint32_t>(numbers.size());
    one.size = size;
    one.material = material;
    one.shape = shape;
    raw.push_back(one);
    numbers.insert(numbers.end(), size, value);
  };
  put(1.0, 9, 0, 0);
  put(1.0, 9, 1, 0);
  for (int k = 0; k < 3; ++k) put(2.0, 9, 1, 0);
  put(3.0, 17, 1, 1);
  put(3.0, 17, 1, 1);
  put(3.0, 17, 1, 2);
  drop_copies(&raw, &numbers);
  REQUIRE(raw.size() == 5);
  REQUIRE(numbers.size() == 3 * 9 + 2 * 17);
  const double values[] = {1.0, 1.0, 2.0, 3.0, 3.0};
  const std::uint32_t shapes[] = {0, 0, 0, 1, 2};
  std::uint32_t end = 0;
  for (std::size_t k = 0; k < 5; ++k) {
    CAPTURE(k);
    CHECK(raw[k].data == end);
    CHECK(raw[k].shape == shapes[k]);
    for (std::uint32_t n = 0; n < raw[k].size; ++n) CHECK(numbers[raw[k].data + n] == values[k]);
    end += raw[k].size;
  }
}
