// SPDX-License-Identifier: Apache-2.0
// Hands bytes to a reader as a file. What a reader may do is fixed here: read them, or throw Error(input) in words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace clray_fuzz {

/// The names of all readers.
std::vector<std::string> reader_names();

/// Lets a reader read the bytes: what it complains of, or nothing. Throws std::logic_error where it does what no reader
/// may: another error, or none in words.
std::string read_bytes(const std::string& reader, const std::uint8_t* data, std::size_t size);

}  // namespace clray_fuzz
