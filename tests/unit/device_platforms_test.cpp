// SPDX-License-Identifier: Apache-2.0
// Listing and choosing devices, the kernel cache's folder, error names, buffers.
#include <doctest/doctest.h>

#include <cstdint>

#include "device/buffers.hpp"
#include "device/platforms.hpp"

using namespace clray;

namespace {

FoundDevice made_up(int index, const char* name, cl_device_type type, bool fp64, const char* platform = "P") {
  FoundDevice found;
  found.info.index = index;
  found.info.name = name;
  found.info.platform = platform;
  found.info.type = device_type_name(type);
  found.info.fp64 = fp64;
  found.type = type;
  return found;
}

const std::vector<FoundDevice> kDevices = {
    made_up(0, "Simulator", CL_DEVICE_TYPE_CPU | CL_DEVICE_TYPE_GPU, true, "Oclgrind"),
    made_up(1, "Small GPU", CL_DEVICE_TYPE_GPU, false),
    made_up(2, "Processor", CL_DEVICE_TYPE_CPU | CL_DEVICE_TYPE_DEFAULT, true),
    made_up(3, "Big GPU", CL_DEVICE_TYPE_GPU, true),
    made_up(4, "Big GPU", CL_DEVICE_TYPE_GPU, true),
};

int chosen(const std::vector<FoundDevice>& devices, const std::string& choice) {
  return choose_devices(devices, choice).front().info.index;
}

std::string error_of(const std::vector<FoundDevice>& devices, const std::string& choice) {
  try {
    choose_devices(devices, choice);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::device);
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("device types are bit masks") {
  CHECK(device_type_name(CL_DEVICE_TYPE_CPU | CL_DEVICE_TYPE_DEFAULT) == "cpu");
  CHECK(device_type_name(CL_DEVICE_TYPE_CPU | CL_DEVICE_TYPE_GPU) == "cpu+gpu");
  CHECK(device_type_name(CL_DEVICE_TYPE_ACCELERATOR) == "accelerator");
  CHECK(device_type_name(0) == "unknown");
}

TEST_CASE("choice of a device") {
  CHECK(chosen(kDevices, "") == 3);
  CHECK(chosen(kDevices, "gpu") == 3);
  CHECK(chosen(kDevices, "cpu") == 2);
  CHECK(chosen(kDevices, "0") == 0);
  CHECK(chosen(kDevices, "4") == 4);
  CHECK(chosen(kDevices, "oclgrind") == 0);
  CHECK(chosen(kDevices, "process") == 2);
  CHECK(chosen(kDevices, "Big GPU") == 3);
  const auto all = choose_devices(kDevices, "all");
  REQUIRE(all.size() == 3);
  CHECK(all[0].info.index == 2);
  CHECK(all[2].info.index == 4);
}

TEST_CASE("processes of one machine deal its devices among them, or share them where there are too few") {
  const auto dealt = [](const std::string& choice, unsigned number, unsigned of) {
    std::vector<int> indices;
    for (const FoundDevice& found : deal_devices(kDevices, choice, {number, of})) indices.push_back(found.info.index);
    return indices;
  };
  CHECK(dealt("all", 0, 1) == std::vector<int>{2, 3, 4});
  CHECK(dealt("all", 0, 2) == std::vector<int>{2, 4});
  CHECK(dealt("all", 1, 2) == std::vector<int>{3});
  CHECK(dealt("all", 4, 5) == std::vector<int>{3});
  for (const std::string choice : {"", "gpu"}) {
    CHECK(dealt(choice, 0, 1) == std::vector<int>{3});
    CHECK(dealt(choice, 0, 4) == std::vector<int>{3});
    CHECK(dealt(choice, 1, 4) == std::vector<int>{4});
    CHECK(dealt(choice, 2, 4) == std::vector<int>{3});
  }
  CHECK(dealt("cpu", 1, 2) == std::vector<int>{2});
  CHECK(dealt("4", 0, 2) == std::vector<int>{4});
}

TEST_CASE("a device that claims to be CPU and GPU is taken only when asked for") {
  const std::vector<FoundDevice> simulator = {kDevices[0]};
  CHECK(error_of(simulator, "").find("choose one by name or index: 0 Simulator (cpu+gpu, Oclgrind)") !=
        std::string::npos);
  CHECK(chosen(simulator, "cpu") == 0);
  CHECK(chosen({kDevices[0], kDevices[2]}, "") == 2);
}

TEST_CASE("of several CPU runtimes PoCL is the default, whatever the others are called; any is taken by name") {
  const char* const pocl = "Portable Computing Language";
  const auto cpu = [](int index, const char* platform, bool fp64 = true) {
    return made_up(index, "Processor", CL_DEVICE_TYPE_CPU, fp64, platform);
  };
  for (const char* other : {"Intel(R) OpenCL", "AMD Accelerated", "Zebra"}) {
    const std::vector<FoundDevice> first{cpu(0, other), cpu(1, pocl)}, last{cpu(0, pocl), cpu(1, other)};
    CHECK(choose_devices(first, "").front().info.platform == pocl);
    CHECK(choose_devices(first, "cpu").front().info.platform == pocl);
    CHECK(choose_devices(last, "cpu").front().info.platform == pocl);
    CHECK(choose_devices(first, other).front().info.platform == other);
    CHECK(choose_devices(first, "0").front().info.platform == other);
  }
  // One that cannot compute in double precision is no choice.
  CHECK(choose_devices({cpu(0, "Intel(R) OpenCL"), cpu(1, pocl, false)}, "cpu").front().info.index == 0);
  // Where PoCL fails, the next runtime is taken, and that is said.
  const std::vector<FoundDevice> both{cpu(0, "Intel(R) OpenCL"), cpu(1, pocl)};
  std::vector<std::string> notes;
  const auto open = [&](const FoundDevice& found) {
    if (found.info.platform == pocl) throw Error(ErrorCode::device, "refused", found.info.name);
    OpenedDevice opened;
    opened.info = found.info;
    return opened;
  };
  CHECK(open_devices(both, "", {}, open, &notes).front().info.index == 0);
  CHECK(notes.size() == 1);
}

TEST_CASE("a choice that cannot be met says what there is") {
  CHECK(error_of({}, "cpu").find("pocl-opencl-icd") != std::string::npos);
  CHECK(error_of({}, "").find("ocl-icd-libopencl1") != std::string::npos);
  CHECK(error_of(kDevices, "9").find("there is no device 9; there is: 0 Simulator") == 0);
  CHECK(error_of(kDevices, "abacus").find("there is no device called 'abacus'") == 0);
  CHECK(error_of(kDevices, "gpu 7").find("there is no") == 0);
  CHECK(error_of(kDevices, "GPU").find("'GPU' fits several devices") == 0);
  CHECK(error_of(kDevices, "1") == "Small GPU: the device lacks double precision (fp64), which clray needs");
  CHECK(error_of({kDevices[2]}, "gpu") == "there is no GPU device; there is: 2 Processor (cpu, P)");
}

TEST_CASE(
    "a device that fails is left out and named: a default one gives way to the CPU, one that was asked for does not") {
  const auto open_but = [](const std::string& broken) {
    return [broken](const FoundDevice& found) {
      if (broken.find(found.info.name) != std::string::npos)
        throw Error(ErrorCode::device, "refused: the self-test", found.info.name);
      OpenedDevice opened;
      opened.info = found.info;
      return opened;
    };
  };
  std::vector<std::string> notes;
  const auto opened = [&](const std::string& choice, const std::string& broken) {
    notes.clear();
    std::vector<int> indices;
    for (const OpenedDevice& device : open_devices(kDevices, choice, {}, open_but(broken), &notes))
      indices.push_back(device.info.index);
    return indices;
  };
  CHECK(opened("", "") == std::vector<int>{3});
  CHECK(notes.empty());
  CHECK(opened("", "Big GPU") == std::vector<int>{2});
  REQUIRE(notes.size() == 1);
  CHECK(notes[0] == "Big GPU is left out: refused: the self-test; Processor (cpu) is taken");
  CHECK(opened("all", "Big GPU") == std::vector<int>{2});
  CHECK(notes.size() == 2);
  CHECK(opened("all", "Processor") == std::vector<int>{3, 4});
  CHECK(notes == std::vector<std::string>{"Processor is left out: refused: the self-test"});
  CHECK_THROWS_WITH_AS(opened("gpu", "Big GPU"), "Big GPU: refused: the self-test", Error);
  CHECK_THROWS_WITH_AS(opened("all", "Big GPU Processor"), "Processor: refused: the self-test", Error);
  CHECK_THROWS_AS(opened("", "Big GPU Processor"), Error);
}

TEST_CASE("an OpenCL error is named") {
  CHECK(cl_error_name(CL_OUT_OF_RESOURCES) == "CL_OUT_OF_RESOURCES");
  CHECK(cl_error_name(-31) == "CL_INVALID_DEVICE_TYPE");
  CHECK(cl_error_name(-9999) == "OpenCL error -9999");
  const auto found = choose_devices(find_devices(), "cpu").front();
  OpenedDevice opened = open_device(found);
  const cl::Buffer buffer = make_buffer<std::uint32_t>(opened, 4);
  std::string message;
  try {
    read_buffer<std::uint32_t>(opened, buffer, 1000000);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::device);
    message = error.what();
  }
  CHECK(message == found.info.name + ": clEnqueueReadBuffer failed with CL_INVALID_VALUE");
}

TEST_CASE("this machine's devices are listed, those of one platform together") {
  const auto list = list_devices();
  REQUIRE_FALSE(list.empty());
  for (std::size_t i = 0; i < list.size(); ++i) {
    CHECK(list[i].index == static_cast<int>(i));
    CHECK_FALSE(list[i].name.empty());
    CHECK_FALSE(list[i].driver.empty());
    CHECK(list[i].compute_units > 0);
    CHECK(list[i].memory_GiB > 0.0);
    if (i > 0) CHECK(list[i - 1].platform <= list[i].platform);
  }
}

TEST_CASE("buffers carry data there and back") {
  OpenedDevice opened = open_device(choose_devices(find_devices(), "cpu").front());
  const std::vector<std::uint64_t> values = {1, 0xffffffffffffffffu, 3};
  const cl::Buffer buffer = make_buffer(opened, values, CL_MEM_READ_WRITE);
  CHECK(read_buffer<std::uint64_t>(opened, buffer, 3) == values);
  CHECK(read_buffer<std::uint64_t>(opened, buffer, 2, 1) == std::vector<std::uint64_t>{0xffffffffffffffffu, 3});
  zero_buffer<std::uint64_t>(opened, buffer, 2);
  CHECK(read_buffer<std::uint64_t>(opened, buffer, 3) == std::vector<std::uint64_t>{0, 0, 3});
  CHECK(read_buffer<std::uint64_t>(opened, make_zero_buffer<std::uint64_t>(opened, 5), 5) ==
        std::vector<std::uint64_t>(5, 0));
  CHECK_NOTHROW(make_buffer(opened, std::vector<double>{}));
}
