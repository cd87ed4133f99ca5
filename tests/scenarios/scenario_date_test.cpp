#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenarios/scenario.h"

namespace locsim::scenarios {
namespace {

using testing::HasSubstr;

Scenario with_date(const std::string& date) {
  return parse_scenario("seed: 1\ndate: " + date + "\n", "drive.yaml");
}

std::string error_of(const std::string& date) {
  try {
    (void)with_date(date);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ScenarioDate, IsWhereGpsTimeStarts) {
  // 1 March 2026, 08:30:15 UTC: day 16 856 after 6 January 1980, a Sunday as that was; 18 leap
  // seconds.
  const sim::GpsTime start = with_date("2026-03-01T08:30:15Z").gps_start();
  EXPECT_EQ(start.week, 16856 / 7);
  EXPECT_EQ(start.of_week,
            std::chrono::hours(8) + std::chrono::minutes(30) + std::chrono::seconds(15 + 18));
  EXPECT_EQ(with_date("\"2026-03-01T08:30:15Z\"").gps_start(), start);
}

TEST(ScenarioDate, HasADefaultAndIsWritten) {
  const Scenario plain = parse_scenario("seed: 1", "drive.yaml");
  EXPECT_EQ(plain.date, "2026-06-01T04:00:00Z");
  const Scenario dated = with_date("2027-12-31T23:59:59Z");
  EXPECT_THAT(to_yaml(dated), HasSubstr("2027-12-31T23:59:59Z"));
  EXPECT_EQ(parse_scenario(to_yaml(dated), "again.yaml").date, dated.date);
  const std::vector<std::string> overrides = {"date=2026-06-02T04:00:00Z"};
  const Scenario set = parse_scenario("seed: 1", "drive.yaml", ".", overrides);
  EXPECT_EQ(set.gps_start() - plain.gps_start(), std::chrono::hours(24));
}

TEST(ScenarioDate, GoesFromTheFirstToTheLastDayOfTheMagneticModel) {
  for (const char* date : {"2025-01-01T00:00:00Z", "2029-12-31T23:59:59Z"})
    EXPECT_EQ(error_of(date), "no error") << date;
  for (const char* date : {"2019-06-01T00:00:00Z", "2024-12-30T00:00:00Z", "2030-01-02T00:00:00Z",
                           "2035-06-01T00:00:00Z"}) {
    EXPECT_EQ(error_of(date), "drive.yaml:2: date is '" + std::string(date) +
                                  "', needs a date from 2025 to 2029: the model of the earth's "
                                  "magnetic field covers no other");
  }
}

TEST(ScenarioDate, MistakesNamePlaceValueAndRemedy) {
  for (const char* date :
       {"2026-13-01T00:00:00Z", "2026-02-29T00:00:00Z", "2026-00-10T00:00:00Z"}) {
    EXPECT_EQ(error_of(date),
              "drive.yaml:2: date is '" + std::string(date) + "', the calendar has no such day");
  }
  for (const char* date : {"2026-06-01T24:00:00Z", "2026-06-01T12:60:00Z"}) {
    EXPECT_EQ(error_of(date), "drive.yaml:2: date is '" + std::string(date) +
                                  "', the time of day needs to be from 00:00:00 to 23:59:59");
  }
  for (const char* date : {"tomorrow", "2026-06-01", "01.06.2026", "2026-06-01T04:00:00",
                           "2026-06-01 04:00:00Z", "2026-06-01T04:00:00+08:00"}) {
    EXPECT_EQ(error_of(date), "drive.yaml:2: date is '" + std::string(date) +
                                  "', needs the form YYYY-MM-DDThh:mm:ssZ (UTC), such as "
                                  "2024-01-31T08:30:00Z");
  }
  EXPECT_THAT(error_of("'noon: soon'"),
              HasSubstr("date is 'noon: soon', needs the form YYYY-MM-DDThh:mm:ssZ"));
  EXPECT_EQ(error_of("[2026, 6, 1]"), "drive.yaml:2: date is a list, needs a text");
  const std::vector<std::string> overrides = {"date=yesterday"};
  EXPECT_THROW((void)parse_scenario("seed: 1", "drive.yaml", ".", overrides), InputError);
}

}  // namespace
}  // namespace locsim::scenarios
