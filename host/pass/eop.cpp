// SPDX-License-Identifier: Apache-2.0
// Files of Earth orientation; see eop.hpp. Columns of finals2000A: readme.finals2000A of the IERS.
#include "pass/eop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>

#include "clray/constants.hpp"
#include "clray/error.hpp"
#include "text/input_file.hpp"
#include "text/text.hpp"

namespace clray::pass {

namespace {

constexpr double kArcsec = constants::kPi / 648000.0;

[[noreturn]] void fail(const std::string& path, std::size_t line, const std::string& what) {
  throw Error(ErrorCode::input, what, line > 0 ? fmt::format("{}:{}", path, line) : path);
}

std::string trimmed(const std::string& text) {
  return text::trimmed(text, " \t\r\"");
}

bool number_of(const std::string& text, double* value) {
  const std::size_t sign = text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + sign, end, *value);
  return read.ec == std::errc() && read.ptr == end && std::isfinite(*value);
}

std::vector<std::string> split(const std::string& line, char by) {
  std::vector<std::string> fields;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(by, at), line.size());
    fields.push_back(trimmed(line.substr(at, end - at)));
    at = end + 1;
  }
  return fields;
}

/// "UT1-UTC" and "ut1_utc_s" become "ut1utc".
std::string folded(const std::string& name) {
  std::string text;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

/// Whether a line is one of finals2000A: flags I or P at their places.
bool is_finals(const std::string& line) {
  return line.size() >= 68 && (line[16] == 'I' || line[16] == 'P') && (line[57] == 'I' || line[57] == 'P');
}

}  // namespace

EarthOrientation::EarthOrientation(const std::string& path) : path_(path) {
  std::istringstream file(text::read_input_file(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  if (lines.empty()) fail(path, 0, "is empty");
  if (is_finals(lines.front())) {
    read_columns(lines);
  } else {
    read_names(lines);
  }
  if (days_.empty()) fail(path, 0, "holds no day with UT1 - UTC and both coordinates of the pole");
}

void EarthOrientation::add(int line, double mjd, double ut1_utc_s, double x_arcsec, double y_arcsec) {
  if (!(std::fabs(ut1_utc_s) <= 1.0))
    fail(path_, line, fmt::format("UT1 - UTC is {} s; expected at most 1 s", ut1_utc_s));
  if (!(std::fabs(x_arcsec) <= 5.0 && std::fabs(y_arcsec) <= 5.0)) {
    fail(path_, line, fmt::format("the pole is at {}, {} arcsec; expected at most 5 arcsec", x_arcsec, y_arcsec));
  }
  if (!days_.empty() && !(mjd > days_.back().mjd)) fail(path_, line, "days must increase from row to row");
  const auto leap = static_cast<double>(ephemeris::leap_seconds(static_cast<std::int64_t>(std::floor(mjd))));
  days_.push_back({mjd, ut1_utc_s - leap, x_arcsec, y_arcsec});
}

void EarthOrientation::read_columns(const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!is_finals(lines[i])) continue;  // predictions end before the file does
    double v[4];
    const std::pair<int, int> kColumns[] = {{7, 8}, {58, 10}, {18, 9}, {37, 9}};
    for (int k = 0; k < 4; ++k) {
      if (!number_of(trimmed(lines[i].substr(static_cast<std::size_t>(kColumns[k].first),
                                             static_cast<std::size_t>(kColumns[k].second))),
                     &v[k])) {
        fail(path_, i + 1, fmt::format("no number in column {}", kColumns[k].first + 1));
      }
    }
    add(static_cast<int>(i + 1), v[0], v[1], v[2], v[3]);
  }
}

void EarthOrientation::read_names(const std::vector<std::string>& lines) {
  static const std::vector<std::string> kNames[] = {
      {"mjd", "mjdd", "mjdutc"}, {"ut1utc", "ut1utcs"}, {"xpole", "xpolearcsec"}, {"ypole", "ypolearcsec"}};
  std::size_t places[4];
  bool head = false;
  char by = ',';
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string line = trimmed(lines[i]);
    if (line.empty() || line[0] == '#') continue;
    if (!head) by = line.find(';') != std::string::npos ? ';' : ',';
    const std::vector<std::string> fields = split(line, by);
    if (!head) {
      for (int k = 0; k < 4; ++k) {
        const auto place = std::find_if(fields.begin(), fields.end(), [&](const std::string& field) {
          return std::find(kNames[k].begin(), kNames[k].end(), folded(field)) != kNames[k].end();
        });
        places[k] = static_cast<std::size_t>(place - fields.begin());
        if (place == fields.end())
          fail(path_, i + 1,
               "expected the names mjd, ut1_utc_s, x_pole_arcsec, y_pole_arcsec, or a file finals of the IERS");
      }
      head = true;
      continue;
    }
    double v[4];
    bool complete = true;
    for (int k = 0; k < 4; ++k) {
      const std::string field = places[k] < fields.size() ? fields[places[k]] : "";
      if (!field.empty() && !number_of(field, &v[k])) fail(path_, i + 1, fmt::format("'{}'; expected a number", field));
      complete = complete && !field.empty();
    }
    if (complete) add(static_cast<int>(i + 1), v[0], v[1], v[2], v[3]);
  }
}

EarthAngles EarthOrientation::at(const ephemeris::Epoch& epoch) const {
  if (days_.empty()) return {};
  const double mjd = ephemeris::mjd_of(epoch);
  const auto after =
      std::upper_bound(days_.begin(), days_.end(), mjd, [](double t, const Day& day) { return t < day.mjd; });
  if (after == days_.begin() || mjd > days_.back().mjd) {
    fail(path_, 0,
         fmt::format("{} is outside its days (MJD {} to {})", ephemeris::date_text(epoch), days_.front().mjd,
                     days_.back().mjd));
  }
  const Day& low = *(after - 1);
  const Day& high = after == days_.end() ? low : *after;
  const double share = high.mjd > low.mjd ? (mjd - low.mjd) / (high.mjd - low.mjd) : 0.0;
  const auto between = [&](double Day::*member) { return low.*member + share * (high.*member - low.*member); };
  const auto leap = static_cast<double>(ephemeris::leap_seconds(epoch.mjd));
  return {between(&Day::ut1_tai_s) + leap, between(&Day::x_arcsec) * kArcsec, between(&Day::y_arcsec) * kArcsec};
}

}  // namespace clray::pass
