// SPDX-License-Identifier: Apache-2.0
// A libFuzzer target: one program a reader (CLRAY_READER). scripts/fuzz builds and runs them.
#include "readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  clray_fuzz::read_bytes(CLRAY_READER, data, size);
  return 0;
}
