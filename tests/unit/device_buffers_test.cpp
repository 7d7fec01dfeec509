// SPDX-License-Identifier: Apache-2.0
// What a device cannot hold in one buffer is refused with what would need less, before anything is allocated.
#include <doctest/doctest.h>

#include "device/buffers.hpp"
#include "device_support.hpp"

using namespace clray;

TEST_CASE("buffers beyond what a device gives are refused, those within are not") {
  OpenedDevice opened = test::opened_cpu();
  const auto limit = static_cast<double>(opened.device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>());
  CHECK_NOTHROW(check_buffer_size(opened, limit, "the faces of a view", "faces"));
  CHECK_THROWS_WITH_AS(check_buffer_size(opened, 2.0 * limit, "the faces of a view", "faces"),
                       doctest::Contains("fewer faces are needed"), Error);
  CHECK_NOTHROW(check_sums_size(opened, 1000));
  CHECK_THROWS_WITH_AS(check_sums_size(opened, std::uint64_t{1} << 60), doctest::Contains("fewer bins"), Error);
  try {
    check_sums_size(opened, std::uint64_t{1} << 60);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::input);
    CHECK(std::string(error.what()).find("GiB in one buffer") != std::string::npos);
  }
}
