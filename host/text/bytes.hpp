// SPDX-License-Identifier: Apache-2.0
// Numbers and texts as bytes of a file, little-endian whatever the machine, and back. A reader believes nothing: every
// length is held against what is left.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clray::text {

class BytesWriter {
 public:
  void number(std::uint64_t value, int bytes = 8) {
    for (int k = 0; k < bytes; ++k) out_.push_back(static_cast<char>(value >> (8 * k) & 0xff));
  }
  /// value(0) … value(count - 1), without their count; faster than one by one.
  template <int kBytes, class Value>
  void many(std::uint64_t count, Value value) {
    const std::size_t begin = out_.size();
    out_.resize(begin + count * kBytes);
    char* at = out_.data() + begin;
    for (std::uint64_t k = 0; k < count; ++k, at += kBytes) {
      const std::uint64_t number = value(k);
      for (int b = 0; b < kBytes; ++b) at[b] = static_cast<char>(number >> (8 * b) & 0xff);
    }
  }
  /// Bytes without their count.
  void raw(std::string_view bytes) { out_.append(bytes); }
  void real(double value);
  void text(std::string_view value);
  template <class T>
  void numbers(const std::vector<T>& values) {
    number(values.size());
    for (const T value : values) number(static_cast<std::uint64_t>(value), sizeof(T));
  }
  void reals(const std::vector<double>& values);

  const std::string& bytes() const { return out_; }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

/// All members throw Error(input, name) where the bytes end too soon or a length cannot be.
class BytesReader {
 public:
  BytesReader(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  std::uint64_t number(int bytes = 8);
  /// Calls take(k, number) with as many numbers as are said; faster than one by one.
  template <int kBytes, class Take>
  void many(std::uint64_t count, Take take) {
    const char* at = this->take(count * kBytes).data();
    for (std::uint64_t k = 0; k < count; ++k, at += kBytes) {
      std::uint64_t number = 0;
      for (int b = 0; b < kBytes; ++b)
        number |= static_cast<std::uint64_t>(static_cast<unsigned char>(at[b])) << (8 * b);
      take(k, number);
    }
  }
  double real();
  std::string text();
  /// A count of things that have at least so many bytes each.
  std::uint64_t count(std::uint64_t bytes_each);
  template <class T>
  std::vector<T> numbers() {
    std::vector<T> values(count(sizeof(T)));
    for (T& value : values) value = static_cast<T>(number(sizeof(T)));
    return values;
  }
  std::vector<double> reals();
  std::string_view take(std::uint64_t bytes);
  std::uint64_t left() const { return bytes_.size(); }
  [[noreturn]] void fail() const;

 private:
  std::string_view bytes_;
  std::string name_;
};

}  // namespace clray::text
