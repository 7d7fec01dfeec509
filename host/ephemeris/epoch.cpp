// SPDX-License-Identifier: Apache-2.0
// Epochs and calendar dates; see epoch.hpp.
#include "ephemeris/epoch.hpp"

#include <erfa.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <ctime>

namespace clray::ephemeris {

namespace {

constexpr std::int64_t kUnixEpochMjd = 40587;

std::int64_t julian_day(int year, int month, int day) {
  const int shift = (month - 14) / 12;
  return static_cast<std::int64_t>(1461) * (year + 4800 + shift) / 4 + 367 * (month - 2 - shift * 12) / 12 -
         3 * ((year + 4900 + shift) / 100) / 4 + day - 32075;
}

constexpr double kTtMinusTai_s = 32.184;
constexpr std::int64_t kTaiMinusGps_s = 19;

/// Picoseconds since MJD 0 in TAI, counted from the midnight of a day: (days, ps), not normalised.
Epoch tai_of(const Epoch& utc) {
  return {utc.mjd, utc.ps + leap_seconds(utc.mjd) * kPicosecondsPerSecond};
}

/// The epoch of UTC at a date of TAI.
Epoch utc_of_tai(const Epoch& tai) {
  Epoch day = normalised({tai.mjd, tai.ps});
  const auto since = [&](std::int64_t mjd) {  // ps from UTC's midnight of that day, if it is within a few days
    return (day.mjd - mjd) * kPicosecondsPerDay + day.ps - leap_seconds(mjd) * kPicosecondsPerSecond;
  };
  std::int64_t mjd = day.mjd;
  while (since(mjd) < 0) --mjd;
  while (since(mjd + 1) >= 0) ++mjd;
  return {mjd, since(mjd)};
}

/// A whole number of exactly `digits` digits at the text's start, which is then cut off.
bool take_digits(std::string_view* text, std::size_t digits, int* value) {
  if (text->size() < digits) return false;
  *value = 0;
  for (std::size_t i = 0; i < digits; ++i) {
    const char c = (*text)[i];
    if (c < '0' || c > '9') return false;
    *value = 10 * *value + (c - '0');
  }
  text->remove_prefix(digits);
  return true;
}

bool take(std::string_view* text, char c) {
  if (text->empty() || text->front() != c) return false;
  text->remove_prefix(1);
  return true;
}

/// Digits after a decimal point as a fraction of `whole`, to the nearest.
bool read_fraction(std::string_view digits, std::int64_t whole, std::int64_t* part) {
  long double share = 0.0L, place = 0.1L;
  for (const char c : digits) {
    if (c < '0' || c > '9') return false;
    share += static_cast<long double>(c - '0') * place;
    place /= 10.0L;
  }
  *part = static_cast<std::int64_t>(share * static_cast<long double>(whole) + 0.5L);
  return true;
}

bool take_day(std::string_view* text, std::int64_t* mjd) {
  int year = 0, month = 1, day = 0;
  if (!take_digits(text, 4, &year) || !take(text, '-')) return false;
  std::string_view rest = *text;
  int first = 0;
  if (take_digits(&rest, 3, &first) && (rest.empty() || rest.front() < '0' || rest.front() > '9')) {
    *text = rest;
    if (first < 1 || !mjd_of(year, 1, 1, mjd)) return false;
    *mjd += first - 1;
    return date_of({*mjd, 0}).year == year;
  }
  return take_digits(text, 2, &month) && take(text, '-') && take_digits(text, 2, &day) && mjd_of(year, month, day, mjd);
}

}  // namespace

std::int64_t leap_seconds(std::int64_t mjd) {
  constexpr std::int64_t kFirstMjd = 41317;  // 1972-01-01
  if (mjd < kFirstMjd) return 10;
  const Date date = date_of({mjd, 0});
  double seconds = 0.0;
  eraDat(date.year, date.month, date.day, 0.0, &seconds);  // a year beyond its table has that of the last entry
  return std::llround(seconds);
}

Epoch normalised(Epoch epoch) {
  std::int64_t days = epoch.ps / kPicosecondsPerDay;
  if (epoch.ps % kPicosecondsPerDay < 0) --days;
  return {epoch.mjd + days, epoch.ps - days * kPicosecondsPerDay};
}

Instant instant_of(double seconds) {
  const double whole = std::floor(seconds);
  return later({static_cast<std::int64_t>(whole), 0}, 0,
               static_cast<std::int64_t>(std::llround((seconds - whole) * 1e12)));
}

Instant later(const Instant& instant, std::int64_t s, std::int64_t ps) {
  const std::int64_t sum = instant.ps + ps;
  std::int64_t carry = sum / kPicosecondsPerSecond;
  if (sum % kPicosecondsPerSecond < 0) --carry;
  return {instant.s + s + carry, sum - carry * kPicosecondsPerSecond};
}

double seconds_between(const Instant& a, const Instant& b) {
  return static_cast<double>(b.s - a.s) + static_cast<double>(b.ps - a.ps) * 1e-12;
}

Epoch epoch_of(const Epoch& zero, const Instant& time) {
  std::int64_t days = time.s / kSecondsPerDay;
  if (time.s % kSecondsPerDay < 0) --days;
  return normalised({zero.mjd + days, zero.ps + (time.s - days * kSecondsPerDay) * kPicosecondsPerSecond + time.ps});
}

Epoch epoch_of(std::int64_t mjd, double seconds) {
  const double whole = std::floor(seconds);
  const double days = std::floor(whole / kSecondsPerDay);
  const auto second_of_day = static_cast<std::int64_t>(whole - days * kSecondsPerDay);
  const auto ps = static_cast<std::int64_t>(std::llround((seconds - whole) * 1e12));
  return normalised({mjd + static_cast<std::int64_t>(days), second_of_day * kPicosecondsPerSecond + ps});
}

double seconds_between(const Epoch& a, const Epoch& b) {
  const std::int64_t whole = (b.mjd - a.mjd) * kSecondsPerDay + leap_seconds(b.mjd) - leap_seconds(a.mjd);
  return static_cast<double>(whole) + static_cast<double>(b.ps - a.ps) * 1e-12;
}

Epoch later(const Epoch& epoch, const Instant& time) {
  const Epoch tai = tai_of(epoch);
  return utc_of_tai(epoch_of(normalised(tai), time));
}

Epoch later(const Epoch& epoch, double seconds) {
  return later(epoch, instant_of(seconds));
}

bool time_scale_of(std::string_view name, TimeScale* scale) {
  static constexpr std::pair<const char*, TimeScale> kNames[] = {{"UTC", TimeScale::utc},
                                                                 {"TAI", TimeScale::tai},
                                                                 {"TT", TimeScale::tt},
                                                                 {"TDB", TimeScale::tdb},
                                                                 {"GPS", TimeScale::gps}};
  std::string upper;
  for (const char c : name) upper += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  for (const auto& [known, value] : kNames) {
    if (upper != known) continue;
    *scale = value;
    return true;
  }
  return false;
}

Epoch utc_of(TimeScale scale, const Epoch& shown) {
  if (scale == TimeScale::utc) return shown;
  double ahead_s = 0.0;  // of TAI
  if (scale == TimeScale::gps) ahead_s = -static_cast<double>(kTaiMinusGps_s);
  if (scale == TimeScale::tt || scale == TimeScale::tdb) ahead_s = kTtMinusTai_s;
  if (scale == TimeScale::tdb) {
    const double day = 2400000.5 + static_cast<double>(shown.mjd);
    ahead_s +=
        eraDtdb(day, static_cast<double>(shown.ps) / static_cast<double>(kPicosecondsPerDay), 0.0, 0.0, 0.0, 0.0);
  }
  return utc_of_tai({shown.mjd, shown.ps - static_cast<std::int64_t>(std::llround(ahead_s * 1e12))});
}

TwoPartDate tt_of(const Epoch& epoch) {
  const Epoch tai = tai_of(epoch);
  return {2400000.5 + static_cast<double>(tai.mjd),
          (static_cast<double>(tai.ps) * 1e-12 + kTtMinusTai_s) / static_cast<double>(kSecondsPerDay)};
}

bool read_date(std::string_view text, Epoch* epoch) {
  std::int64_t mjd = 0;
  if (!take_day(&text, &mjd)) return false;
  int hour = 0, minute = 0, second = 0;
  std::int64_t part = 0;
  if (take(&text, 'T') || take(&text, ' ')) {
    if (!take_digits(&text, 2, &hour) || !take(&text, ':') || !take_digits(&text, 2, &minute)) return false;
    if (take(&text, ':')) {
      if (!take_digits(&text, 2, &second)) return false;
      if (take(&text, '.')) {
        const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
        if (!read_fraction(text.substr(0, end), kPicosecondsPerSecond, &part)) return false;
        text.remove_prefix(end);
      }
    }
  }
  take(&text, 'Z');
  const bool leap = hour == 23 && minute == 59 && leap_seconds(mjd + 1) > leap_seconds(mjd);
  if (!text.empty() || hour > 23 || minute > 59 || second > (leap ? 60 : 59)) return false;
  const std::int64_t seconds = (hour * 60 + minute) * 60 + second;
  *epoch = {mjd, seconds * kPicosecondsPerSecond + part};
  return true;
}

bool read_mjd(std::string_view text, Epoch* epoch) {
  const std::size_t point = std::min(text.find('.'), text.size());
  std::int64_t mjd = 0, part = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + point, mjd);
  if (code != std::errc() || end != text.data() + point || mjd < 0 || mjd > 1000000) return false;
  const std::string_view digits = point < text.size() ? text.substr(point + 1) : std::string_view();
  if (!read_fraction(digits, kPicosecondsPerDay, &part)) return false;
  *epoch = normalised({mjd, part});
  return true;
}

Date date_of(const Epoch& epoch) {
  std::int64_t l = epoch.mjd + 2400001 + 68569;
  const std::int64_t n = 4 * l / 146097;
  l -= (146097 * n + 3) / 4;
  const std::int64_t i = 4000 * (l + 1) / 1461001;
  l -= 1461 * i / 4 - 31;
  const std::int64_t j = 80 * l / 2447;
  Date date;
  date.day = static_cast<int>(l - 2447 * j / 80);
  date.month = static_cast<int>(j + 2 - 12 * (j / 11));
  date.year = static_cast<int>(100 * (n - 49) + i + j / 11);
  const auto seconds = static_cast<int>(epoch.ps / kPicosecondsPerSecond);
  const int minutes = std::min(seconds / 60, 1439);  // a leap second is the 61st of the last minute
  date.hour = minutes / 60;
  date.minute = minutes % 60;
  date.second = seconds - 60 * minutes;
  return date;
}

std::string date_text(const Epoch& epoch) {
  const Date d = date_of(epoch);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02} UTC", d.year, d.month, d.day, d.hour, d.minute, d.second);
}

std::string iso_text(const Epoch& epoch) {
  constexpr std::int64_t kMillisecond = kPicosecondsPerSecond / 1000;
  const Epoch rounded = later(epoch, Instant{0, kMillisecond / 2});
  const Date d = date_of(rounded);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", d.year, d.month, d.day, d.hour, d.minute, d.second,
                     rounded.ps / kMillisecond % 1000);
}

double mjd_of(const Epoch& epoch) {
  return static_cast<double>(epoch.mjd) + static_cast<double>(epoch.ps) / static_cast<double>(kPicosecondsPerDay);
}

bool mjd_of(int year, int month, int day, std::int64_t* mjd) {
  if (year < 1858 || year > 9999 || month < 1 || month > 12 || day < 1 || day > 31) return false;
  *mjd = julian_day(year, month, day) - 2400001;
  const Date back = date_of({*mjd, 0});
  return back.year == year && back.month == month && back.day == day;
}

Epoch production_epoch() {
  std::int64_t seconds = static_cast<std::int64_t>(std::time(nullptr));
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH")) {
    char* end = nullptr;
    const long long value = std::strtoll(fixed, &end, 10);
    if (end != fixed && *end == '\0' && value >= 0 && value < 250000000000) seconds = value;
  }
  return {kUnixEpochMjd + seconds / kSecondsPerDay, seconds % kSecondsPerDay * kPicosecondsPerSecond};
}

}  // namespace clray::ephemeris
