#include "sim/gnss/satellites.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace locsim::sim {

namespace {

constexpr std::chrono::sys_days kGpsEpoch =
    std::chrono::year{1980} / std::chrono::January / std::chrono::day{6};
constexpr std::chrono::seconds kLeapSeconds{18};

[[noreturn]] void refuse(std::string_view text, const std::string& problem) {
  throw InputError("date \"" + std::string(text) + "\": " + problem);
}

bool has_form(std::string_view text, std::string_view form) {
  return std::ranges::equal(text, form, [](char found, char wanted) {
    return wanted == '0' ? found >= '0' && found <= '9' : found == wanted;
  });
}

int number(std::string_view digits) {
  int value = 0;
  for (const char digit : digits) value = 10 * value + (digit - '0');
  return value;
}

}  // namespace

GpsTime GpsTime::operator+(Duration later) const {
  const Duration sum = of_week + later;
  Duration rest = sum % kGpsWeek;
  if (rest < Duration::zero()) rest += kGpsWeek;
  return {.week = week + static_cast<int>((sum - rest) / kGpsWeek), .of_week = rest};
}

Duration GpsTime::operator-(GpsTime other) const {
  return (week - other.week) * kGpsWeek + (of_week - other.of_week);
}

GpsTime GpsTime::from_utc(std::string_view text) {
  using namespace std::chrono;
  if (!has_form(text, "0000-00-00T00:00:00Z"))
    refuse(text, "needs the form YYYY-MM-DDThh:mm:ssZ (UTC), such as 2024-01-31T08:30:00Z");
  const year_month_day date(year{number(text.substr(0, 4))},
                            month{static_cast<unsigned>(number(text.substr(5, 2)))},
                            day{static_cast<unsigned>(number(text.substr(8, 2)))});
  if (!date.ok()) refuse(text, "the calendar has no such day");
  const int hour = number(text.substr(11, 2));
  const int minute = number(text.substr(14, 2));
  const int second = number(text.substr(17, 2));
  if (hour > 23 || minute > 59 || second > 59)
    refuse(text, "the time of day needs to be from 00:00:00 to 23:59:59");
  if (sys_days(date) < kGpsEpoch || date.year() >= year{2100})
    refuse(text, "needs to be from 1980-01-06 on, where GPS time begins, and before 2100");
  const std::chrono::seconds since_epoch = sys_days(date) - kGpsEpoch + hours(hour) +
                                           minutes(minute) + std::chrono::seconds(second) +
                                           kLeapSeconds;
  return GpsTime{} + since_epoch;
}

double GpsTime::decimal_year() const {
  using namespace std::chrono;
  const auto utc = kGpsEpoch + (*this - GpsTime{}) - kLeapSeconds;
  const year_month_day date(floor<days>(utc));
  const sys_days begin = date.year() / January / 1;
  const sys_days end = (date.year() + years(1)) / January / 1;
  return static_cast<int>(date.year()) + to_seconds(utc - begin) / to_seconds(end - begin);
}

double GpsTime::seconds() const {
  return week * to_seconds(kGpsWeek) + to_seconds(of_week);
}

double SatelliteSight::elevation_rad() const {
  return std::atan2(direction.z(), std::hypot(direction.x(), direction.y()));
}

double SatelliteSight::azimuth_rad() const {
  const double azimuth_rad = std::atan2(direction.x(), direction.y());
  return azimuth_rad < 0.0 ? azimuth_rad + 2.0 * std::numbers::pi : azimuth_rad;
}

}  // namespace locsim::sim
