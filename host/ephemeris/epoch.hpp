// SPDX-License-Identifier: Apache-2.0
// Epochs of UTC as whole days (MJD) and picoseconds, times of a motion as whole seconds and picoseconds: a day
// has 8.64e16 ps, which a double cannot count. Calendar dates (Fliegel & Van Flandern 1968), leap seconds (ERFA's
// table; before 1972 UTC counts as TAI - 10 s) and the time scales of orbit files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "clray/scene.hpp"

namespace clray::ephemeris {

inline constexpr std::int64_t kPicosecondsPerSecond = 1000000000000;
inline constexpr std::int64_t kSecondsPerDay = 86400;
inline constexpr std::int64_t kPicosecondsPerDay = kSecondsPerDay * kPicosecondsPerSecond;

using clray::Epoch;

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

/// TAI - UTC on a day, whole seconds.
std::int64_t leap_seconds(std::int64_t mjd);

/// The same epoch with ps in range, days counted as 86400 s each.
Epoch normalised(Epoch epoch);

/// A whole MJD and seconds, to the nearest ps.
Epoch epoch_of(std::int64_t mjd, double seconds);

/// The epoch of a time of a motion whose time 0 is at `zero`. Each day counts 86400 s, as in Unix and Julian seconds.
Epoch epoch_of(const Epoch& zero, const Instant& time);

/// Seconds from `a` to `b`, leap seconds included.
double seconds_between(const Epoch& a, const Epoch& b);

/// The epoch `seconds` (and `ps`) later, leap seconds included.
Epoch later(const Epoch& epoch, double seconds);
Epoch later(const Epoch& epoch, const Instant& time);

/// Time scales of orbit and attitude files.
enum class TimeScale { utc, tai, tt, tdb, gps };

/// The scale of a name such as "UTC" or "gps"; false where it is none of them.
bool time_scale_of(std::string_view name, TimeScale* scale);
inline constexpr const char* kTimeScales = "UTC, TAI, TT, TDB, GPS";

/// The epoch at which clocks of `scale` show this date and time of day.
Epoch utc_of(TimeScale scale, const Epoch& shown);

/// A day and a time of day in two parts, as ERFA takes them, in TT and in UTC's own days.
struct TwoPartDate {
  double day = 0.0, rest = 0.0;  ///< Julian Dates, their sum
};
TwoPartDate tt_of(const Epoch& epoch);

/// Reads "2026-11-25T18:02:00.5", "2026-330T18:02:00Z" (day of the year) or a date alone. A 61st second may stand where
/// UTC has one. False where it is no such date.
bool read_date(std::string_view text, Epoch* epoch);

/// Reads a decimal Modified Julian Date, exactly to the picosecond; false where it is none.
bool read_mjd(std::string_view text, Epoch* epoch);

struct Date {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
};

/// Calendar date, seconds cut.
Date date_of(const Epoch& epoch);

/// "2026-01-01 00:14:24 UTC".
std::string date_text(const Epoch& epoch);

/// "2026-01-01T00:14:24.500Z", to the nearest millisecond.
std::string iso_text(const Epoch& epoch);

/// The Modified Julian Date as a double: to 1 us.
double mjd_of(const Epoch& epoch);

/// MJD of a date of the Gregorian calendar; false where there is no such date.
bool mjd_of(int year, int month, int day, std::int64_t* mjd);

/// Now, or the environment's SOURCE_DATE_EPOCH, so that files can be made again byte for byte.
Epoch production_epoch();

}  // namespace clray::ephemeris
