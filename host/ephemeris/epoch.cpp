// SPDX-License-Identifier: Apache-2.0
// Epochs and calendar dates; see epoch.hpp.
#include "ephemeris/epoch.hpp"

#include <fmt/format.h>

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

}  // namespace

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
  return static_cast<double>(b.mjd - a.mjd) * kSecondsPerDay + static_cast<double>(b.ps - a.ps) * 1e-12;
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
  date.hour = seconds / 3600;
  date.minute = seconds / 60 % 60;
  date.second = seconds % 60;
  return date;
}

std::string date_text(const Epoch& epoch) {
  const Date d = date_of(epoch);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02} UTC", d.year, d.month, d.day, d.hour, d.minute, d.second);
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
