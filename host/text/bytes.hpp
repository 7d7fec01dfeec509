// SPDX-License-Identifier: Apache-2.0
// Numbers and texts as bytes, little-endian whatever the machine, and back: all of them in memory, or a block at a time
// from and to a file. A reader believes nothing: every length is held against what is left.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clray::text {

/// Bytes that are held at a time on their way to or from a file; a multiple of eight, which checksum() asks for.
constexpr std::size_t kBlockOfBytes = std::size_t{1} << 20;

class BytesWriter {
 public:
  /// Keeps all bytes until they are taken.
  BytesWriter() = default;
  /// Gives bytes to `sink` in blocks of kBlockOfBytes; the last, shorter one by end().
  explicit BytesWriter(std::function<void(std::string_view)> sink) : sink_(std::move(sink)) {}

  void number(std::uint64_t value, int bytes = 8) {
    for (int k = 0; k < bytes; ++k) out_.push_back(static_cast<char>(value >> (8 * k) & 0xff));
    drain();
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
    drain();
  }
  /// Bytes without their count.
  void raw(std::string_view bytes) {
    out_.append(bytes);
    drain();
  }
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
  /// Gives the rest to the sink.
  void end() {
    sink_(out_);
    out_.clear();
  }

 private:
  void drain() {
    if (sink_ && out_.size() >= kBlockOfBytes) give_blocks();
  }
  void give_blocks();

  std::string out_;
  std::function<void(std::string_view)> sink_;
};

/// All members throw Error(input, name) where the bytes end too soon or a length cannot be.
class BytesReader {
 public:
  BytesReader(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  /// `total` bytes, of which `source(where, count)` puts the next `count` somewhere.
  BytesReader(std::uint64_t total, std::function<void(char*, std::size_t)> source, std::string name)
      : behind_(total), source_(std::move(source)), name_(std::move(name)) {}

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
  /// The next bytes, which stay until the next are asked for.
  std::string_view take(std::uint64_t bytes);
  std::uint64_t left() const { return bytes_.size() + behind_; }
  [[noreturn]] void fail() const;

 private:
  void refill(std::uint64_t bytes);

  std::string_view bytes_;    // that are here
  std::uint64_t behind_ = 0;  // that the source still has
  std::function<void(char*, std::size_t)> source_;
  std::string block_;
  std::string name_;
};

}  // namespace clray::text
