#include "tests/localization/gnss_ins/recorded_drive.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace locsim::localization {
namespace {

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.at(values.size() / 2);
}

TEST(RecordedDrive, ConsumerImuBridgesOutages) {
  if (!std::filesystem::exists(recorded_drive_folder() / "imu.csv")) {
    GTEST_SKIP() << recorded_drive_folder() << " is absent; LOCSIM_DATA_DIR names its parent";
  }
  const RecordedDrive drive = read_recorded_drive();
  ASSERT_EQ(drive.samples.size(), 54858U);
  GnssOdometryConfig config;
  config.gnss_time_offset_s = -0.055;
  const RecordedRun run = run_recorded(drive, config, 10.0, 15.0);
  ASSERT_GE(run.outages.size(), 10U);
  std::vector<double> drift;
  for (const OutageDrift& outage : run.outages) drift.push_back(outage.drift_m);
  std::vector<double> heading;
  for (const double error : run.heading_error_rad) heading.push_back(std::abs(error));
  ASSERT_GT(heading.size(), 500U);
  // Bounds of sanity, twice what was measured; the figures are in the documentation.
  EXPECT_LT(median(drift), 4.0);
  EXPECT_LT(median(heading), 2.0 * std::numbers::pi / 180.0);
  EXPECT_GT(median(drift), 0.05);
}

}  // namespace
}  // namespace locsim::localization
