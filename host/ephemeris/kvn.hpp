// SPDX-License-Identifier: Apache-2.0
// Lines of CCSDS messages in keyword = value notation (502.0-B, 504.0-B, section 7): keywords, blocks of rows,
// comments. And what orbit and attitude files have in common: time systems, frames, interpolation. Every complaint has
// file:line.
#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "ephemeris/epoch.hpp"

namespace clray::ephemeris {

/// One line at a time; blank lines and comments are passed over.
class KvnReader {
 public:
  /// Throws Error(input) where the file cannot be opened.
  explicit KvnReader(const std::string& path);

  bool next();

  /// The keyword of "KEY = value", or a line's only word; empty for a row of several words.
  const std::string& key() const { return key_; }
  const std::string& value() const { return value_; }
  bool has_value() const { return has_value_; }
  /// The words of a row.
  const std::vector<std::string>& words() const { return words_; }

  /// Words as numbers.
  double number(std::size_t word, const char* what) const;
  /// A word or value as a date of a time system.
  Epoch date(const std::string& text, TimeScale scale, const char* what) const;

  /// Reads the header up to the first META_START: the keyword of the version first ("CCSDS_OEM_VERS"), of a version up
  /// to `latest`. Returns the version's whole part.
  int header(const std::string& version_key, int latest, const std::vector<std::string>& keys);

  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_at(int line, const std::string& what) const;
  int line() const { return number_; }

 private:
  std::string path_;
  std::istringstream file_;
  std::string key_, value_;
  bool has_value_ = false;
  std::vector<std::string> words_;
  int number_ = 0;
};

/// The keywords of a META block, each with its line.
class KvnMeta {
 public:
  /// Reads from behind META_START to META_STOP. A keyword that is not in `known` is an error, and so is one given
  /// twice.
  KvnMeta(KvnReader& in, const std::vector<std::string>& known);

  bool has(const std::string& key) const { return values_.count(key) != 0; }
  /// The value, which must be there.
  const std::string& text(const std::string& key) const;
  std::string upper(const std::string& key) const;
  TimeScale scale() const;
  Epoch date(const std::string& key) const;
  long whole(const std::string& key, long low, long high) const;
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  struct Value {
    std::string text;
    int line = 0;
  };
  KvnReader& in_;
  std::map<std::string, Value> values_;
  int end_line_ = 0;
};

/// The frame of a CCSDS name about the Earth; false where it is none that clray knows.
bool frame_of(std::string name, Frame* frame);
inline constexpr const char* kFrames = "EME2000, ICRF, GCRF, ITRF (any year), TOD, TEME";

/// Start and stop of a block in s from `zero`: USEABLE times where given, within the times of its rows.
std::pair<double, double> usable_span(const KvnMeta& meta, const Epoch& zero, double first_s, double last_s);

}  // namespace clray::ephemeris
