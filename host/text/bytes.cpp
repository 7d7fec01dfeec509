// SPDX-License-Identifier: Apache-2.0
// See bytes.hpp.
#include "text/bytes.hpp"

#include <algorithm>
#include <cstring>

#include "clray/error.hpp"

namespace clray::text {

void BytesWriter::give_blocks() {
  std::size_t given = 0;
  for (; out_.size() - given >= kBlockOfBytes; given += kBlockOfBytes)
    sink_(std::string_view(out_).substr(given, kBlockOfBytes));
  out_.erase(0, given);
}

void BytesWriter::real(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  number(bits);
}

void BytesWriter::text(std::string_view value) {
  number(value.size());
  raw(value);
}

void BytesWriter::reals(const std::vector<double>& values) {
  number(values.size());
  for (const double value : values) real(value);
}

void BytesReader::fail() const {
  throw Error(ErrorCode::input, "the file is damaged", name_);
}

std::string_view BytesReader::take(std::uint64_t bytes) {
  if (bytes > left()) fail();
  if (bytes > bytes_.size()) refill(bytes);
  const std::string_view taken = bytes_.substr(0, bytes);
  bytes_.remove_prefix(bytes);
  return taken;
}

/// Behind it, at least so many bytes are here. Blocks but the last have a multiple of eight bytes, as those written.
void BytesReader::refill(std::uint64_t bytes) {
  std::string block(bytes_);
  const std::uint64_t missing = bytes - bytes_.size();
  const std::uint64_t more = std::min(behind_, (missing + kBlockOfBytes - 1) / kBlockOfBytes * kBlockOfBytes);
  block.resize(bytes_.size() + more);
  source_(block.data() + bytes_.size(), more);
  behind_ -= more;
  block_ = std::move(block);
  bytes_ = block_;
}

std::uint64_t BytesReader::number(int bytes) {
  const std::string_view taken = take(static_cast<std::uint64_t>(bytes));
  std::uint64_t value = 0;
  for (int k = 0; k < bytes; ++k) value |= static_cast<std::uint64_t>(static_cast<unsigned char>(taken[k])) << (8 * k);
  return value;
}

double BytesReader::real() {
  const std::uint64_t bits = number();
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

std::string BytesReader::text() {
  return std::string(take(count(1)));
}

std::uint64_t BytesReader::count(std::uint64_t bytes_each) {
  const std::uint64_t things = number();
  if (things > left() / bytes_each) fail();
  return things;
}

std::vector<double> BytesReader::reals() {
  std::vector<double> values(count(sizeof(double)));
  for (double& value : values) value = real();
  return values;
}

}  // namespace clray::text
