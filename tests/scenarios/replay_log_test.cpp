#include "scenarios/replay_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenarios/replay_clock.h"
#include "scenarios/replay_rig.h"
#include "scenarios/run_files.h"

namespace locsim::scenarios {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;
const std::string kReceiver =
    "t_gps_s,latitude_deg,longitude_deg,height_m,quality,satellites,sigma_north_m,sigma_east_m,"
    "sigma_up_m,velocity_north_m_s,velocity_east_m_s,velocity_up_m_s,sigma_vn_m_s,sigma_ve_m_s,"
    "sigma_vu_m_s\n";
const std::string kFixed = ",40.0966268,-105.1474483,1601.474,1,21,1,2,3,4,5,6,7,8,9\n";

class ReplayLog : public testing::Test {
 protected:
  ReplayLog()
      : folder_(fs::path(testing::TempDir()) /
                ("replay_log_" +
                 std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    fs::create_directories(folder_);
  }
  ~ReplayLog() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  template <typename Call>
  static std::string refusal(Call call) {
    try {
      static_cast<void>(call());
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "not refused";
    return {};
  }

  fs::path folder_;
};

TEST_F(ReplayLog, ReceiversColumnsBecomeEastNorthUpAndExactTimes) {
  const GnssLog log =
      read_gnss_log(write("gnss.csv", kReceiver + "1752003258.499" + kFixed +
                                          "1752003258.749,40,-105,1600,2,7,1,1,1,0,0,0,1,1,1\n"
                                          "1752003258.999000001,0,0,0,0,3,0,0,0,0,0,0,0,0,0\n"));
  ASSERT_EQ(log.entries.size(), 3U);
  const GnssFix& fix = log.entries[0].fix;
  // A double's next neighbours of this time are 238 ns away.
  EXPECT_EQ(fix.time.time_since_epoch().count(), 1'752'003'258'499'000'000);
  EXPECT_EQ(log.entries[2].fix.time.time_since_epoch().count(), 1'752'003'258'999'000'001);
  EXPECT_DOUBLE_EQ(fix.position.latitude_rad, 40.0966268 * kDegree);
  EXPECT_DOUBLE_EQ(fix.position.longitude_rad, -105.1474483 * kDegree);
  EXPECT_EQ(fix.position.height_m, 1601.474);
  EXPECT_EQ(fix.velocity_enu_m_s, Vector3d(5.0, 4.0, 6.0));
  EXPECT_EQ(fix.position_covariance_m2.diagonal(), Vector3d(4.0, 1.0, 9.0));
  EXPECT_EQ(fix.velocity_covariance_m2_s2.diagonal(), Vector3d(64.0, 49.0, 81.0));
  EXPECT_EQ(fix.satellites, 21);
  EXPECT_TRUE(fix.valid && log.entries[0].reference);
  // A float solution is a fix, but no reference; quality 0 is no fix.
  EXPECT_TRUE(log.entries[1].fix.valid && !log.entries[1].reference);
  EXPECT_TRUE(!log.entries[2].fix.valid && !log.entries[2].reference);
}

TEST_F(ReplayLog, RunsOwnColumnsAreRead) {
  const GnssLog log = read_gnss_log(
      write("gnss.csv", std::string(kGnssHeader) +
                            "\n0.100000000,0,3,,,,,,,,,,,,,,,,,,none\n"
                            "0.200000000,1,9,22.3,114.2,5,0,0,0,1,2,3,4,5,6,7,8,9,0.8,1.2,3d\n"));
  ASSERT_EQ(log.entries.size(), 2U);
  EXPECT_FALSE(log.entries[0].fix.valid || log.entries[0].reference);
  EXPECT_TRUE(log.entries[1].reference);
  EXPECT_EQ(log.entries[1].fix.velocity_enu_m_s, Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(log.entries[1].fix.position_covariance_m2.diagonal(), Vector3d(16.0, 25.0, 36.0));
}

TEST_F(ReplayLog, MistakesAreNamedWithFileLineColumnAndValue) {
  const std::string first = kReceiver + "10.0" + kFixed;
  struct Case {
    std::string text;
    std::vector<std::string> said;
  };
  const std::vector<Case> cases = {
      {"", {"empty"}},
      {"t_gps_s,quality,satellites\n", {":1: ", "latitude_deg", "sigma_vu_m_s", "in any order"}},
      {"t_s," + kReceiver, {":1: ", "both t_gps_s and t_s"}},
      {"height_m," + kReceiver, {":1: ", "height_m", "twice"}},
      {kReceiver, {"nothing to score against"}},
      {kReceiver + "10.0,40,-105,1600,5,7,1,1,1,0,0,0,1,1,1\n", {"quality 1"}},
      {first + "10.x" + kFixed, {":3: ", "t_gps_s", "'10.x'", "time in seconds"}},
      {first + "10.0" + kFixed, {":3: ", "t_gps_s", "'10.0'", "sort"}},
      {first + "11,40,-105\n", {":3: ", "3 fields", "15", "cut short"}},
      {first + "11,91,-105,1600,1,7,1,1,1,0,0,0,1,1,1\n", {":3: ", "latitude_deg", "'91'", "90"}},
      {first + "11,40,-181,1600,1,7,1,1,1,0,0,0,1,1,1\n", {":3: ", "longitude_deg", "180"}},
      {first + "11,40,-105,high,1,7,1,1,1,0,0,0,1,1,1\n", {":3: ", "height_m", "'high'"}},
      {first + "11,40,-105,1600,7,7,1,1,1,0,0,0,1,1,1\n", {":3: ", "quality", "'7'", "(fixed)"}},
      {first + "11,40,-105,1600,1,2.5,1,1,1,0,0,0,1,1,1\n", {":3: ", "satellites", "'2.5'"}},
      {first + "11,40,-105,1600,1,7,1,0,1,0,0,0,1,1,1\n",
       {":3: ", "sigma_east_m", "'0'", "above 0"}},
      {first + "11,40,-105,1600,1,7,1,1,1,nan,0,0,1,1,1\n",
       {":3: ", "velocity_north_m_s", "'nan'"}},
      {first + "11,40,-105,1600,1,7,1,1,1,0,0,0,1,1,-1\n", {":3: ", "sigma_vu_m_s", "'-1'"}}};
  for (const Case& c : cases) {
    const fs::path file = write("gnss.csv", c.text);
    const std::string message = refusal([&] { return read_gnss_log(file); });
    EXPECT_THAT(message, HasSubstr(file.string()));
    for (const std::string& part : c.said) EXPECT_THAT(message, HasSubstr(part)) << c.text;
  }
}

TEST_F(ReplayLog, FolderNeedsBothFilesOfOneTime) {
  const auto read = [&] { return read_drive_log(folder_); };
  EXPECT_THAT(refusal([&] { return read_drive_log(folder_ / "none"); }), HasSubstr("imu.csv"));
  EXPECT_THAT(refusal(read), HasSubstr("imu.csv"));
  std::string imu =
      "t_gps_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,"
      "gyro_z_rad_s\n";
  write("imu.csv", imu + "1,0,0,9,0,0,0\n2,0,0,9,0,0,0\n3,0,0,9,0,0,0\n");
  EXPECT_THAT(refusal(read), HasSubstr("gnss.csv"));
  write("gnss.csv", kReceiver + "10.0" + kFixed);
  EXPECT_THAT(refusal(read), AllOf(HasSubstr("10.0"), HasSubstr("3.0"), HasSubstr("same time")));
  write("gnss.csv", kReceiver + "2.0" + kFixed);
  DriveLog log = read();
  EXPECT_THAT(refusal([&] {
                log.shift_gnss(std::chrono::seconds(5));
                return 0;
              }),
              HasSubstr("offset"));
  imu.replace(0, 7, "t_s");
  write("imu.csv", imu + "1,0,0,9,0,0,0\n2,0,0,9,0,0,0\n3,0,0,9,0,0,0\n");
  EXPECT_THAT(refusal(read), AllOf(HasSubstr("t_gps_s"), HasSubstr("clock")));
}

// A course that swings by ±0.5 rad with 0.3 and 0.47 rad/s; GNSS stamps are `ahead_s` too late.
DriveLog swinging_drive(double ahead_s, double swing_rad) {
  const auto rate = [&](double t) {
    return swing_rad * (0.3 * std::cos(0.3 * t) + 0.47 * std::cos(0.47 * t));
  };
  const auto course = [&](double t) {
    return swing_rad * (std::sin(0.3 * t) + std::sin(0.47 * t));
  };
  DriveLog log;
  log.gnss.source = "gnss.csv";
  for (int i = 0; i <= 10'000; ++i) {
    // The mean over the interval that ends here is the rate at its middle.
    log.imu.samples.push_back({.time = stamp_from_seconds(0.01 * i),
                               .angular_rate_rad_s = {0.0, 0.0, rate(0.01 * i - 0.005)}});
  }
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.25 * i;
    GnssLog::Entry entry{.reference = true};
    entry.fix.time = stamp_from_seconds(t + ahead_s);
    entry.fix.velocity_enu_m_s = {8.0 * std::cos(course(t)), 8.0 * std::sin(course(t)), 0.0};
    log.gnss.entries.push_back(entry);
  }
  return log;
}

TEST(ReplayClock, OffsetIsFoundFromTheTurns) {
  for (const double ahead_s : {0.0, 0.0952, -0.4321}) {
    const ClockOffset found = estimate_clock_offset(swinging_drive(ahead_s, 0.5), {});
    // No noise: what is left is the parabola through steps of 5 ms and the gyro's linear
    // interpolation over 10 ms, both far below a millisecond.
    EXPECT_NEAR(to_seconds(found.offset), -ahead_s, 2e-4);
    EXPECT_GT(found.correlation, 0.9999);
    EXPECT_NEAR(found.slope, 1.0, 1e-3);
    EXPECT_GT(found.intervals, 390U);
  }
}

TEST(ReplayClock, MountOfTheImuIsTakenOff) {
  const Pose upside_down{.rotation = rotation_from_rpy(std::numbers::pi, 0.0, 0.0)};
  EXPECT_THROW(static_cast<void>(estimate_clock_offset(swinging_drive(0.1, 0.5), upside_down)),
               InputError);
  DriveLog log = swinging_drive(0.1, 0.5);
  for (ImuSample& sample : log.imu.samples) sample.angular_rate_rad_s *= -1.0;
  EXPECT_NEAR(to_seconds(estimate_clock_offset(log, upside_down).offset), -0.1, 2e-4);
}

// Speed swings between 5 and 11 m/s; velocities are those of `late_s` before their stamps.
GnssLog hurrying_drive(double late_s, double jump_m = 0.0) {
  const auto speed = [](double t) { return 8.0 + 3.0 * std::sin(0.7 * t); };
  const auto way = [](double t) { return 8.0 * t - 3.0 / 0.7 * std::cos(0.7 * t); };
  const LocalFrame frame({.latitude_rad = 0.7, .longitude_rad = -1.8, .height_m = 1600.0});
  GnssLog log;
  for (int i = 0; i <= 800; ++i) {
    const double t = 0.25 * i;
    GnssLog::Entry entry{.reference = true};
    entry.fix.time = stamp_from_seconds(t);
    entry.fix.position = frame.to_geodetic({way(t), i % 2 == 0 ? jump_m : -jump_m, 0.0});
    entry.fix.velocity_enu_m_s = {speed(t - late_s), 0.0, 0.0};
    log.entries.push_back(entry);
  }
  return log;
}

TEST(ReplayClock, DelayOfVelocitiesIsFoundFromThePositions) {
  for (const double late_s : {0.025, 0.127, 0.4}) {
    const VelocityDelay found = estimate_velocity_delay(hurrying_drive(late_s));
    // Speeds between fixes are taken as straight lines: curvature costs 2 mm of a way of 2 m and
    // is the same on both sides of the best.
    EXPECT_NEAR(to_seconds(found.delay), late_s, 5e-3);
    EXPECT_LT(found.rms_m, 0.5 * found.rms_without_m);
    EXPECT_GT(found.intervals, 700U);
  }
  EXPECT_EQ(estimate_velocity_delay(hurrying_drive(0.0)).delay, Duration{0});
  // Positions that jump by 10 m from fix to fix explain nothing.
  EXPECT_EQ(estimate_velocity_delay(hurrying_drive(0.127, 5.0)).delay, Duration{0});
  EXPECT_EQ(estimate_velocity_delay({}).delay, Duration{0});
}

TEST(ReplayClock, StraightDriveIsRefused) {
  try {
    static_cast<void>(estimate_clock_offset(swinging_drive(0.1, 0.0), {}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("turns too little"), HasSubstr("--gnss-offset")));
  }
}

TEST_F(ReplayLog, RigFileReadsBackAndItsMistakesAreNamed) {
  const fs::path file = write("rig.yaml",
                              "imu: {preset: mti10, mount: {x_m: 1, z_m: 0.5, yaw_deg: 90}}\n"
                              "gnss: {mount: {x_m: 0.3, y_m: -0.2, z_m: 1.5}, latency_s: 0.1}\n");
  const ReplayRig rig = load_replay_rig(file, folder_);
  EXPECT_EQ(rig.localizer.kind, "gnss_ins");
  const localization::Rig told = rig.rig(100.0);
  EXPECT_EQ(told.imu_rate_hz, 100.0);
  EXPECT_EQ(told.antenna_in_vehicle_m, Vector3d(0.3, -0.2, 1.5));
  EXPECT_NEAR(told.T_vehicle_imu.yaw(), 90.0 * kDegree, 1e-12);
  // 1.76 deg/sqrt(h), of the MTi-10's preset.
  EXPECT_NEAR(told.gyro_noise_rad_s_sqrthz, 1.76 * kDegree / 60.0, 1e-9);
  EXPECT_EQ(rig.gnss_latency_s, 0.1);
  EXPECT_EQ(to_yaml(load_replay_rig(write("again.yaml", to_yaml(rig)), folder_)), to_yaml(rig));

  const ReplayRig defaults = load_replay_rig({}, folder_);
  EXPECT_EQ(defaults.imu.preset, "mpu6000");
  EXPECT_EQ(defaults.gnss_mount.position_m, Vector3d(0.0, 0.05, 0.65));

  const auto said = [&](const std::string& text, const std::vector<std::string>& overrides = {}) {
    const fs::path bad = write("bad.yaml", text);
    return refusal([&] { return load_replay_rig(bad, folder_, {}, overrides); });
  };
  EXPECT_THAT(said("imu:\n  presset: mti10\n"),
              AllOf(HasSubstr("bad.yaml:2"), HasSubstr("preset")));
  EXPECT_THAT(said("imu: {preset: mti11}\n"), AllOf(HasSubstr("mti11"), HasSubstr("mti10")));
  EXPECT_THAT(said("gnss: {latency_s: -1}\n"), HasSubstr("latency_s"));
  EXPECT_THAT(said("gnss: {mount: {x_m: 100}}\n"), HasSubstr("20"));
  EXPECT_THAT(said("{}", {"localizer.kind=nothing"}), HasSubstr("gnss_ins"));
  EXPECT_THAT(said("{}", {"localizer.nothing=1"}), HasSubstr("nothing"));
}

}  // namespace
}  // namespace locsim::scenarios
