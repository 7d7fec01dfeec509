// SPDX-License-Identifier: Apache-2.0
// Epochs as whole days (MJD, UTC) and picoseconds, times of a motion as whole seconds and picoseconds: a day
// has 8.64e16 ps, which a double cannot count. And calendar dates (Fliegel & Van Flandern 1968). Leap seconds are not
// known here.
#pragma once

#include <cstdint>
#include <string>

namespace clray::ephemeris {

inline constexpr std::int64_t kPicosecondsPerSecond = 1000000000000;
inline constexpr std::int64_t kSecondsPerDay = 86400;
inline constexpr std::int64_t kPicosecondsPerDay = kSecondsPerDay * kPicosecondsPerSecond;

/// An instant; ps in [0, one day).
struct Epoch {
  std::int64_t mjd = 0;
  std::int64_t ps = 0;
};

/// A time of a motion, counted from its time 0, which may be 1e9 s and more away (Unix, GPS or Julian seconds); ps in
/// [0, one second).
struct Instant {
  std::int64_t s = 0;
  std::int64_t ps = 0;
};

/// To the nearest picosecond; |seconds| up to kLatest_s.
Instant instant_of(double seconds);
inline constexpr double kLatest_s = 1e12;

/// The time `s` seconds and `ps` picoseconds later; both may have any sign.
Instant later(const Instant& instant, std::int64_t s, std::int64_t ps);

/// Seconds from `a` to `b`.
double seconds_between(const Instant& a, const Instant& b);

/// The same instant with ps in range.
Epoch normalised(Epoch epoch);

/// A whole MJD and seconds, to the nearest ps.
Epoch epoch_of(std::int64_t mjd, double seconds);

/// The epoch of a time of a motion whose time 0 is at `zero`.
Epoch epoch_of(const Epoch& zero, const Instant& time);

/// Seconds from `a` to `b`.
double seconds_between(const Epoch& a, const Epoch& b);

struct Date {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
};

/// Calendar date, seconds cut.
Date date_of(const Epoch& epoch);

/// "2026-01-01 00:14:24 UTC".
std::string date_text(const Epoch& epoch);

/// MJD of a date of the Gregorian calendar; false where there is no such date.
bool mjd_of(int year, int month, int day, std::int64_t* mjd);

/// Now, or the environment's SOURCE_DATE_EPOCH, so that files can be made again byte for byte.
Epoch production_epoch();

}  // namespace clray::ephemeris
