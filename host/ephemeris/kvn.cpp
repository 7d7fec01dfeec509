// SPDX-License-Identifier: Apache-2.0
// CCSDS keyword = value notation; see kvn.hpp.
#include "ephemeris/kvn.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>

#include "clray/error.hpp"
#include "text/input_file.hpp"
#include "text/text.hpp"

namespace clray::ephemeris {

namespace {

// All white space parts words below, so all of it is trimmed: every line that is not empty has a word.
std::string trimmed(const std::string& text) {
  return text::trimmed(text, " \t\r\v\f");
}

std::string upper_of(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

bool number_of(const std::string& text, double* value) {
  const std::size_t sign = text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + sign, end, *value);
  return read.ec == std::errc() && read.ptr == end && std::isfinite(*value);
}

}  // namespace

KvnReader::KvnReader(const std::string& path) : path_(path), file_(text::read_input_file(path)) {}

bool KvnReader::next() {
  std::string line;
  while (std::getline(file_, line)) {
    ++number_;
    if (number_ == 1 && line.compare(0, 3, "\xEF\xBB\xBF") == 0) line.erase(0, 3);
    line = trimmed(line);
    const std::string first = line.substr(0, line.find_first_of(" \t="));
    if (line.empty() || first == "COMMENT") continue;
    const std::size_t equals = line.find('=');
    has_value_ = equals != std::string::npos;
    words_.clear();
    std::istringstream all(line);
    for (std::string word; all >> word;) words_.push_back(word);
    key_ = has_value_ ? trimmed(line.substr(0, equals)) : words_.size() == 1 ? line : "";
    value_ = has_value_ ? trimmed(line.substr(equals + 1)) : "";
    return true;
  }
  return false;
}

double KvnReader::number(std::size_t word, const char* what) const {
  double value = 0.0;
  if (!number_of(words_[word], &value)) fail(fmt::format("{} is \"{}\"; expected a number", what, words_[word]));
  return value;
}

Epoch KvnReader::date(const std::string& text, TimeScale scale, const char* what) const {
  Epoch shown;
  if (!read_date(text, &shown)) {
    fail(fmt::format("{} is \"{}\"; expected a date such as 2026-11-25T18:02:00.5 or 2026-329T18:02:00.5", what, text));
  }
  return utc_of(scale, shown);
}

int KvnReader::header(const std::string& version_key, int latest, const std::vector<std::string>& keys) {
  if (!next()) fail("the file is empty; expected " + version_key);
  if (key_ != version_key) fail(fmt::format("\"{}\"; expected {} first", words_.front(), version_key));
  double version = 0.0;
  if (!number_of(value_, &version) || version < 1.0 || version >= latest + 1.0) {
    fail(fmt::format("{} is \"{}\"; expected 1.0 to {}.0", version_key, value_, latest));
  }
  while (next()) {
    if (key_ == "META_START") return static_cast<int>(version);
    const bool known = has_value_ && std::find(keys.begin(), keys.end(), key_) != keys.end();
    if (!known) fail(fmt::format("\"{}\"; expected one of {}, or META_START", words_.front(), fmt::join(keys, ", ")));
  }
  fail("the file ends; expected META_START");
}

void KvnReader::fail(const std::string& what) const {
  fail_at(number_, what);
}

void KvnReader::fail_at(int line, const std::string& what) const {
  throw Error(ErrorCode::input, what, fmt::format("{}:{}", path_, line));
}

KvnMeta::KvnMeta(KvnReader& in, const std::vector<std::string>& known) : in_(in) {
  while (in.next()) {
    if (in.key() == "META_STOP" && !in.has_value()) {
      end_line_ = in.line();
      return;
    }
    if (!in.has_value() || std::find(known.begin(), known.end(), in.key()) == known.end()) {
      in.fail(fmt::format("\"{}\"; expected META_STOP or one of {}", in.key().empty() ? in.words().front() : in.key(),
                          fmt::join(known, ", ")));
    }
    if (!values_.emplace(in.key(), Value{in.value(), in.line()}).second) in.fail(in.key() + " is given twice");
  }
  in.fail("the file ends; expected META_STOP");
}

const std::string& KvnMeta::text(const std::string& key) const {
  const auto found = values_.find(key);
  if (found == values_.end()) in_.fail_at(end_line_, "the metadata lack " + key);
  if (found->second.text.empty()) fail(key, "has no value");
  return found->second.text;
}

std::string KvnMeta::upper(const std::string& key) const {
  return upper_of(text(key));
}

void KvnMeta::fail(const std::string& key, const std::string& what) const {
  const auto found = values_.find(key);
  in_.fail_at(found == values_.end() ? end_line_ : found->second.line, key + " " + what);
}

TimeScale KvnMeta::scale() const {
  TimeScale scale{};
  if (!time_scale_of(text("TIME_SYSTEM"), &scale)) {
    const bool ut1 = upper("TIME_SYSTEM") == "UT1";
    fail("TIME_SYSTEM", fmt::format("is {}{}; expected one of {}", text("TIME_SYSTEM"),
                                    ut1 ? ", which needs the Earth's rotation to be known" : "", kTimeScales));
  }
  return scale;
}

Epoch KvnMeta::date(const std::string& key) const {
  Epoch shown;
  if (!read_date(text(key), &shown)) {
    fail(key, fmt::format("is \"{}\"; expected a date such as 2026-11-25T18:02:00.5", text(key)));
  }
  return utc_of(scale(), shown);
}

long KvnMeta::whole(const std::string& key, long low, long high) const {
  const std::string& all = text(key);
  long value = 0;
  const auto [end, code] = std::from_chars(all.data(), all.data() + all.size(), value);
  if (code != std::errc() || end != all.data() + all.size() || value < low || value > high) {
    fail(key, fmt::format("is \"{}\"; expected a whole number from {} to {}", all, low, high));
  }
  return value;
}

bool frame_of(std::string name, Frame* frame) {
  name = upper_of(std::move(name));
  static const std::pair<const char*, Frame> kNames[] = {
      {"EME2000", Frame::eme2000}, {"J2000", Frame::eme2000}, {"ICRF", Frame::gcrf},       {"GCRF", Frame::gcrf},
      {"ICRF1", Frame::gcrf},      {"ICRF2", Frame::gcrf},    {"ICRF3", Frame::gcrf},      {"TOD", Frame::tod},
      {"TOD_EARTH", Frame::tod},   {"TEME", Frame::teme},     {"TEMEOFDATE", Frame::teme}, {"WGS84", Frame::itrf},
      {"WGS-84", Frame::itrf}};
  for (const auto& [known, value] : kNames) {
    if (name != known) continue;
    *frame = value;
    return true;
  }
  if (name.compare(0, 4, "ITRF") != 0 || name.find_first_not_of("0123456789-_", 4) != std::string::npos) return false;
  *frame = Frame::itrf;
  return true;
}

std::pair<double, double> usable_span(const KvnMeta& meta, const Epoch& zero, double first_s, double last_s) {
  constexpr double kSame_s = 1e-6;
  double start = first_s, stop = last_s;
  const auto since = [&](const char* key) { return seconds_between(zero, meta.date(key)); };
  if (!(since("STOP_TIME") >= since("START_TIME"))) meta.fail("STOP_TIME", "lies before START_TIME");
  if (meta.has("USEABLE_START_TIME")) start = since("USEABLE_START_TIME");
  if (meta.has("USEABLE_STOP_TIME")) stop = since("USEABLE_STOP_TIME");
  if (start < first_s - kSame_s) meta.fail("USEABLE_START_TIME", "lies before the first row");
  if (stop > last_s + kSame_s) meta.fail("USEABLE_STOP_TIME", "lies behind the last row");
  if (!(start <= stop)) meta.fail("USEABLE_STOP_TIME", "lies before USEABLE_START_TIME");
  return {std::max(start, first_s), std::min(stop, last_s)};
}

}  // namespace clray::ephemeris
