#include "scenarios/imu_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "scenarios/text_io.h"

namespace locsim::scenarios {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const std::string kHeader =
    "t_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n";
const std::string kRows = "0.00,1,2,3,4,5,6\n0.01,1,2,3,4,5,6\n0.02,1.5,2.5,9.8,-0.1,-0.2,1e-3\n";

class ImuLogFile : public testing::Test {
 protected:
  ImuLogFile() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / ("locsim_imu_log_" + std::string(info->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ImuLogFile() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path file() const { return folder_ / "imu.csv"; }
  [[nodiscard]] ImuLog read(const std::string& text) const {
    std::ofstream(file(), std::ios::binary) << text;
    return read_imu_log(file());
  }
  [[nodiscard]] std::string refusal(const std::string& text) const {
    try {
      static_cast<void>(read(text));
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "was accepted";
    return {};
  }
  [[nodiscard]] std::string at(int line) const {
    return file().string() + ":" + std::to_string(line) + ": ";
  }

  fs::path folder_;
};

TEST_F(ImuLogFile, ColumnsAreFoundByTheirNames) {
  const ImuLog log = read(
      "gyro_z_rad_s, gyro_y_rad_s ,gyro_x_rad_s,temperature_c,accel_z_m_s2,accel_x_m_s2,"
      "accel_y_m_s2,t_gps_s\r\n"
      "# a comment\n\n"
      "6,5,4,20,3,1,2,1752003261.729\r\n"
      "6,5,4,20,3,1,2,1752003261.739\n"
      "-6,5e-1,4,20,3,1,2,1752003261.749");
  ASSERT_EQ(log.samples.size(), 3U);
  EXPECT_EQ(log.time_column, "t_gps_s");
  EXPECT_EQ(log.samples[0].specific_force_m_s2, Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(log.samples[0].angular_rate_rad_s, Vector3d(4.0, 5.0, 6.0));
  EXPECT_EQ(log.samples[2].angular_rate_rad_s, Vector3d(4.0, 0.5, -6.0));
  // To the nanosecond, which a double of this size could not tell.
  EXPECT_EQ(log.samples[0].time.time_since_epoch().count(), 1752003261729000000);
  EXPECT_NEAR(log.rate_hz, 100.0, 1e-9);
  EXPECT_NEAR(log.duration_s(), 0.02, 1e-12);
}

TEST_F(ImuLogFile, GapsAreReportedAndSplitTheLog) {
  // 100 Hz with 1 ms of jitter; 0.1 s are missing after the sixth sample.
  std::string text = kHeader;
  for (const char* t :
       {"0.000", "0.010", "0.021", "0.030", "0.041", "0.050", "0.150", "0.160", "0.169", "0.180"}) {
    text += std::string(t) + ",0,0,9.8,0,0,0\n";
  }
  const ImuLog log = read(text);
  ASSERT_EQ(log.gaps.size(), 1U);
  EXPECT_EQ(log.gaps[0].after, 5U);
  EXPECT_NEAR(log.gaps[0].length_s, 0.1, 1e-9);
  const std::vector<sim::Stretch> parts = log.without_gaps();
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].begin, 0U);
  EXPECT_EQ(parts[0].end, 6U);
  EXPECT_EQ(parts[1].begin, 6U);
  EXPECT_EQ(parts[1].end, 10U);
  // Eight intervals of together 80 ms.
  EXPECT_NEAR(log.rate_hz, 100.0, 1e-9);
  EXPECT_NEAR(log.shortest_interval_s, 0.009, 1e-9);
  EXPECT_NEAR(log.longest_interval_s, 0.011, 1e-9);
}

TEST_F(ImuLogFile, WhatIsWrittenIsReadAgainToTheBit) {
  std::vector<ImuSample> samples(4);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto k = static_cast<double>(i);
    samples[i].time = Stamp{Duration{1752003261000000001 + static_cast<std::int64_t>(i) * 2500000}};
    samples[i].specific_force_m_s2 = Vector3d(0.1 + k, -1.0 / 3.0, 9.80665);
    samples[i].angular_rate_rad_s = Vector3d(1e-9, -2e-17 * k, 3.0);
  }
  write_imu_log(samples, file(), kImuTimeGps);
  EXPECT_FALSE(fs::exists(file().string() + ".partial"));
  const ImuLog log = read_imu_log(file());
  ASSERT_EQ(log.samples.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(log.samples[i].time, samples[i].time);
    EXPECT_EQ(log.samples[i].specific_force_m_s2, samples[i].specific_force_m_s2);
    EXPECT_EQ(log.samples[i].angular_rate_rad_s, samples[i].angular_rate_rad_s);
  }
  EXPECT_EQ(imu_log_csv(log.samples, log.time_column), imu_log_csv(samples, kImuTimeGps));
}

TEST_F(ImuLogFile, MissingColumnsAreNamed) {
  EXPECT_THAT(refusal("t_s,accel_x_m_s2,accel_y_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n"),
              AllOf(HasSubstr(at(1)), HasSubstr("lacks accel_z_m_s2;")));
  EXPECT_THAT(refusal(kHeader.substr(4) + kRows),
              AllOf(HasSubstr(at(1)), HasSubstr("lacks t_gps_s or t_s")));
  EXPECT_THAT(refusal("t_s,t_gps_s" + kHeader.substr(3)), HasSubstr("both t_gps_s and t_s"));
  EXPECT_THAT(refusal("gyro_x_rad_s," + kHeader + kRows), HasSubstr("gyro_x_rad_s: stands twice"));
}

TEST_F(ImuLogFile, WrongValuesAreNamedWithLineAndColumn) {
  EXPECT_THAT(refusal(kHeader + kRows + "0.03,1,2,3,4,5.x,6\n"),
              AllOf(HasSubstr(at(5)), HasSubstr("gyro_y_rad_s"), HasSubstr("'5.x'")));
  EXPECT_THAT(refusal(kHeader + "0.00,1,nan,3,4,5,6\n"),
              AllOf(HasSubstr(at(2)), HasSubstr("accel_y_m_s2"), HasSubstr("'nan'")));
  EXPECT_THAT(refusal(kHeader + "0.00,1,,3,4,5,6\n"),
              AllOf(HasSubstr(at(2)), HasSubstr("accel_y_m_s2"), HasSubstr("''")));
  EXPECT_THAT(refusal(kHeader + "noon,1,2,3,4,5,6\n"),
              AllOf(HasSubstr(at(2)), HasSubstr("t_s"), HasSubstr("'noon'")));
  EXPECT_THAT(refusal(kHeader + kRows + "0.03,1,2\n"),
              AllOf(HasSubstr(at(5)), HasSubstr("3 fields where the header has 7")));
}

TEST_F(ImuLogFile, TimesThatDoNotRiseAreRefused) {
  EXPECT_THAT(refusal(kHeader + kRows + "0.02,1,2,3,4,5,6\n"),
              AllOf(HasSubstr(at(5)), HasSubstr("0.02"), HasSubstr("0.020000000")));
  EXPECT_THAT(refusal(kHeader + kRows + "0.019,1,2,3,4,5,6\n"), HasSubstr("sort the log"));
}

TEST_F(ImuLogFile, FilesWithoutSamplesAreRefused) {
  EXPECT_THAT(refusal(""), HasSubstr("empty"));
  EXPECT_THAT(refusal(kHeader), HasSubstr("0 samples"));
  EXPECT_THAT(refusal(kHeader + "0.00,1,2,3,4,5,6\n0.01,1,2,3,4,5,6\n"), HasSubstr("2 samples"));
  EXPECT_THROW(static_cast<void>(read_imu_log(folder_ / "none.csv")), InputError);
  EXPECT_THROW(static_cast<void>(read_imu_log(folder_)), InputError);
  EXPECT_THROW(write_imu_log({}, folder_ / "no" / "such" / "imu.csv"), InputError);
}

TEST(ParseSeconds, KeepsNanoseconds) {
  const auto ns = [](std::string_view text) {
    const auto stamp = parse_seconds(text);
    return stamp ? stamp->time_since_epoch().count() : -1;
  };
  EXPECT_EQ(ns("1752003261.123456789"), 1752003261123456789);
  EXPECT_EQ(ns("0.0000000015"), 2);
  EXPECT_EQ(ns("7"), 7'000'000'000);
  EXPECT_EQ(ns("7."), 7'000'000'000);
  EXPECT_EQ(ns(".5"), 500'000'000);
  EXPECT_EQ(ns("-1.5"), -1'500'000'000);
  EXPECT_EQ(ns("1e3"), 1'000'000'000'000);
  for (const char* wrong : {"", "x", "1.5s", "1.2.3", "inf", "nan", "1e12", "--1"}) {
    EXPECT_FALSE(parse_seconds(wrong).has_value()) << wrong;
  }
  EXPECT_EQ(exact_seconds(Stamp{Duration{-1'500'000'000}}), "-1.500000000");
  EXPECT_EQ(exact_seconds(Stamp{Duration{1752003261123456789}}), "1752003261.123456789");
}

}  // namespace
}  // namespace locsim::scenarios
