// SPDX-License-Identifier: Apache-2.0
// See bytes.hpp.
#include "text/bytes.hpp"

#include <cstring>

#include "clray/error.hpp"

namespace clray::text {

void BytesWriter::real(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  number(bits);
}

void BytesWriter::text(std::string_view value) {
  number(value.size());
  out_.append(value);
}

void BytesWriter::reals(const std::vector<double>& values) {
  number(values.size());
  for (const double value : values) real(value);
}

void BytesReader::fail() const {
  throw Error(ErrorCode::input, "the file is damaged", name_);
}

std::string_view BytesReader::take(std::uint64_t bytes) {
  if (bytes > bytes_.size()) fail();
  const std::string_view taken = bytes_.substr(0, bytes);
  bytes_.remove_prefix(bytes);
  return taken;
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
  if (things > bytes_.size() / bytes_each) fail();
  return things;
}

std::vector<double> BytesReader::reals() {
  std::vector<double> values(count(sizeof(double)));
  for (double& value : values) value = real();
  return values;
}

}  // namespace clray::text
