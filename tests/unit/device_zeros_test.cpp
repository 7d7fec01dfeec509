// SPDX-License-Identifier: Apache-2.0
// Numbers that are taken leave zeros, with pages of the host and without, and large pages go back to the system.
#include <doctest/doctest.h>

#include <numeric>

#include "clray/device.hpp"
#include "device/zeros.hpp"

using namespace clray;

TEST_CASE("numbers of a device are taken once, piece by piece, and zeros remain") {
  Device device("cpu");
  OpenedDevice opened = device.impl().devices.front();
  constexpr std::size_t kCount = (1u << 19) + 12345;  // three pieces
  for (const bool shares : {false, opened.shares_memory}) {
    CAPTURE(shares);
    opened.shares_memory = shares;
    const Zeros zeros = make_zeros<std::uint32_t>(opened, kCount);
    CHECK((zeros.pages != nullptr) == shares);
    std::vector<std::uint32_t> written(kCount);
    std::iota(written.begin(), written.end(), 1u);
    write_buffer(opened, zeros.buffer, written);
    const std::size_t first = 77, count = kCount - 100;
    std::vector<std::uint32_t> taken(kCount);
    take_zeros<std::uint32_t>(opened, zeros, first, count, [&](std::uint64_t at, const std::uint32_t* more, auto n) {
      for (std::size_t k = 0; k < n; ++k) taken[at + k] += more[k];
    });
    const std::vector<std::uint32_t> left = read_buffer<std::uint32_t>(opened, zeros.buffer, kCount);
    std::size_t wrong = 0;
    for (std::size_t k = 0; k < kCount; ++k) {
      const bool inside = k >= first && k < first + count;
      wrong += taken[k] != (inside ? written[k] : 0u) || left[k] != (inside ? 0u : written[k]);
    }
    CHECK(wrong == 0);
    clear_zeros<std::uint32_t>(opened, zeros, 0, kCount);
    const std::vector<std::uint32_t> cleared = read_buffer<std::uint32_t>(opened, zeros.buffer, kCount);
    CHECK(std::count(cleared.begin(), cleared.end(), 0u) == static_cast<std::ptrdiff_t>(kCount));
  }
}

TEST_CASE("bytes are cleared wherever they begin and end") {
  const ZeroPages pages(1u << 20);
  auto* const bytes = static_cast<unsigned char*>(pages.data());
  for (const auto& [first, count] :
       {std::pair<std::size_t, std::size_t>{0, 1u << 20}, {5, 1000000}, {4096, 300000}, {100, 8}, {4095, 2}, {7, 0}}) {
    std::fill(bytes, bytes + (1u << 20), static_cast<unsigned char>(9));
    ZeroPages::clear(bytes + first, count);
    std::size_t zeros = 0;
    for (std::size_t k = first; k < first + count; ++k) zeros += bytes[k] == 0;
    CHECK(zeros == count);
    CHECK(std::count(bytes, bytes + (1u << 20), 0) == static_cast<std::ptrdiff_t>(count));
  }
}
