#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/time.h"
#include "sim/gnss/satellites.h"

namespace locsim::scenarios {

/// Numbers in columns, aligned right, with a decimal point whatever the locale. A width of 0 takes
/// as many characters as it needs. They throw InputError where a number is not finite or too wide.
[[nodiscard]] std::string whole_column(std::int64_t value, int width, char fill = ' ');
/// Nothing that is rounded to zero keeps its sign.
[[nodiscard]] std::string fixed_column(double value, int width, int decimals);
/// With Fortran's exponent D and two digits of it; magnitudes below 1e-99 are written as 0.
[[nodiscard]] std::string exponent_column(double value, int width, int decimals);

/// An instant by the calendar of its own time scale.
struct CalendarTime {
  int year = 1980;
  int month = 1;
  int day = 6;
  int hour = 0;
  int minute = 0;
  /// Of the minute.
  Duration rest{0};
};
[[nodiscard]] CalendarTime calendar_time(sim::GpsTime time);

/// By how much GPS time is ahead of UTC: the simulator's leap seconds.
[[nodiscard]] Duration leap_seconds();
/// Rounded half up to whole multiples of `step`, from the start of the week.
[[nodiscard]] sim::GpsTime rounded(sim::GpsTime time, Duration step);

/// A line of a RINEX header: 60 columns and what they are. Content beyond its columns is cut.
[[nodiscard]] std::string rinex_header_line(std::string content, std::string_view label);
/// RINEX VERSION / TYPE for files of several systems, and PGM / RUN BY / DATE, dated `start`.
/// `kind` such as "OBSERVATION DATA".
[[nodiscard]] std::string rinex_first_lines(std::string_view kind, sim::GpsTime start);

}  // namespace locsim::scenarios
