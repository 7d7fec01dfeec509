// SPDX-License-Identifier: Apache-2.0
// Devices and threads. ctest runs each test file in a process of its own, so the first case here is that process's
// first call of OpenCL: the moment at which drivers set themselves up.
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "clray/device.hpp"
#include "device/device_impl.hpp"

using namespace clray;

TEST_CASE("twelve threads open a device each, all at once") {
  constexpr int kThreads = 12;
  std::atomic<int> waiting{0};
  std::vector<std::string> opened(kThreads);
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      ++waiting;
      while (waiting < kThreads) std::this_thread::yield();
      try {
        opened[i] = Device("cpu").info().name;
      } catch (const Error& error) {
        opened[i] = error.what();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const std::string alone = Device("cpu").info().name;
  for (const std::string& name : opened) CHECK(name == alone);
}

TEST_CASE("a Device serves one call at a time, and refuses one that comes from within another") {
  Device device("cpu");
  std::atomic<int> inside{0}, most{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      const DeviceUse use(device);
      most = std::max(most.load(), ++inside);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      --inside;
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(most == 1);
  const DeviceUse use(device);
  try {
    const DeviceUse again(device);
    CHECK_MESSAGE(false, "no error");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::usage);
    CHECK(error.message() == "the device is busy with the call that this one comes from");
  }
}

TEST_CASE("a Device that was moved from says so") {
  Device first("cpu");
  Device second = std::move(first);
  CHECK_NOTHROW(second.info());
  CHECK_THROWS_WITH_AS(first.info(), "this Device was moved from", Error);  // NOLINT: that is the test
  CHECK_THROWS_WITH_AS(first.impl(), "this Device was moved from", Error);
}
