#include "scenarios/gnss_text.h"

#include <array>
#include <charconv>
#include <chrono>
#include <cmath>

#include "core/error.h"

namespace locsim::scenarios {

namespace {

constexpr std::size_t kHeaderColumns = 60;

std::string aligned(std::string text, int width, char fill = ' ') {
  const auto columns = static_cast<std::size_t>(width);
  if (width > 0 && text.size() > columns) {
    throw InputError("number " + text + ": needs to fit a column of " + std::to_string(width) +
                     " characters");
  }
  if (text.size() < columns) text.insert(0, columns - text.size(), fill);
  return text;
}

std::string digits(double value, std::chars_format format, int decimals) {
  if (!std::isfinite(value))
    throw InputError("number " + std::to_string(value) + ": needs to be finite to be written");
  // The greatest double has 309 digits before the point.
  std::array<char, 400> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, format, decimals);
  return {text.data(), end};
}

}  // namespace

std::string whole_column(std::int64_t value, int width, char fill) {
  return aligned(std::to_string(value), width, fill);
}

std::string fixed_column(double value, int width, int decimals) {
  std::string text = digits(value, std::chars_format::fixed, decimals);
  if (text.front() == '-' && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return aligned(std::move(text), width);
}

std::string exponent_column(double value, int width, int decimals) {
  if (std::abs(value) < 1e-99) value = 0.0;
  std::string text = digits(value, std::chars_format::scientific, decimals);
  const std::size_t exponent = text.find('e');
  if (exponent != std::string::npos) text[exponent] = 'D';
  return aligned(std::move(text), width);
}

CalendarTime calendar_time(sim::GpsTime time) {
  using namespace std::chrono;
  constexpr sys_days kEpoch = year{1980} / January / day{6};
  const auto whole_days = floor<days>(time.of_week);
  const year_month_day date(kEpoch + weeks(time.week) + whole_days);
  const Duration of_day = time.of_week - whole_days;
  const auto whole_hours = floor<hours>(of_day);
  const auto whole_minutes = floor<minutes>(of_day - whole_hours);
  return {.year = static_cast<int>(date.year()),
          .month = static_cast<int>(static_cast<unsigned>(date.month())),
          .day = static_cast<int>(static_cast<unsigned>(date.day())),
          .hour = static_cast<int>(whole_hours.count()),
          .minute = static_cast<int>(whole_minutes.count()),
          .rest = of_day - whole_hours - whole_minutes};
}

Duration leap_seconds() {
  return sim::GpsTime::from_utc("1980-01-06T00:00:00Z") - sim::GpsTime{};
}

sim::GpsTime rounded(sim::GpsTime time, Duration step) {
  const sim::GpsTime raised = time + step / 2;
  return raised - raised.of_week % step;
}

std::string rinex_header_line(std::string content, std::string_view label) {
  content.resize(kHeaderColumns, ' ');
  return content.append(label) + "\n";
}

std::string rinex_first_lines(std::string_view kind, sim::GpsTime start) {
  std::string version = "     3.04           ";
  version.append(kind).resize(40, ' ');
  version += "M: MIXED";
  const CalendarTime utc = calendar_time(start - leap_seconds());
  std::string program = "locsim              locsim              ";
  program += whole_column(utc.year, 4) + whole_column(utc.month, 2, '0') +
             whole_column(utc.day, 2, '0') + " " + whole_column(utc.hour, 2, '0') +
             whole_column(utc.minute, 2, '0') +
             whole_column(utc.rest / std::chrono::seconds(1), 2, '0') + " UTC";
  return rinex_header_line(std::move(version), "RINEX VERSION / TYPE") +
         rinex_header_line(std::move(program), "PGM / RUN BY / DATE");
}

}  // namespace locsim::scenarios
