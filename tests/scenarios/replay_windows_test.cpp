#include "scenarios/replay_windows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "tests/scenarios/replay_drive.h"

namespace locsim::scenarios {
namespace {

double seconds(Stamp time) {
  return to_seconds(time - MadeUpDrive::kStart);
}

TEST(ReplayWindows, TheyAreSpreadEvenlyAndKeptApartWithinAPass) {
  const DriveLog log = MadeUpDrive::log(549);
  for (const double length_s : {10.0, 30.0, 60.0}) {
    const WindowSet set = choose_windows(log, length_s, 12);
    ASSERT_EQ(set.windows.size(), 12U);
    // Starts from 30 s on to the last that fits, a fix every 0.25 s.
    const double step_s = (549.0 - length_s - 30.0) / 12.0;
    for (std::size_t i = 0; i < 12; ++i) {
      const WithheldWindow& window = set.windows[i];
      EXPECT_NEAR(seconds(window.from), 30.0 + (static_cast<double>(i) + 0.5) * step_s, 0.51);
      EXPECT_DOUBLE_EQ(to_seconds(window.until - window.from), length_s);
      EXPECT_LT(window.pass, set.passes);
      for (std::size_t k = 0; k < i; ++k) {
        if (set.windows[k].pass != window.pass) continue;
        EXPECT_GE(to_seconds(window.from - set.windows[k].until), 20.0);
      }
    }
    // A pass is free again after the window and 20 s.
    EXPECT_EQ(set.passes, static_cast<std::size_t>(std::ceil((length_s + 20.0) / step_s)));
  }
}

TEST(ReplayWindows, TheyLieWhereTheCarDrives) {
  DriveLog log = MadeUpDrive::log(400);
  for (GnssLog::Entry& entry : log.gnss.entries) {
    const double t = seconds(entry.fix.time);
    if (t < 50.0 || (t > 150.0 && t < 250.0)) entry.fix.velocity_enu_m_s.setZero();
  }
  for (const WithheldWindow& window : choose_windows(log, 20.0, 10).windows) {
    EXPECT_GE(seconds(window.from), 80.0);
    // At least 3 m/s over 20 s: 6 s of driving at 10 m/s.
    const double from_s = seconds(window.from);
    EXPECT_TRUE(from_s < 150.0 - 5.5 || from_s > 250.0 - 14.5) << from_s;
    EXPECT_GE(driven_m(log.gnss, window.from, window.until), 60.0);
  }
}

TEST(ReplayWindows, TheyBeginAndEndAtFixesToScoreAgainst) {
  DriveLog log = MadeUpDrive::log(200);
  for (std::size_t i = 0; i < log.gnss.entries.size(); ++i) {
    if (i % 4 == 3) log.gnss.entries[i].reference = false;
  }
  for (const WithheldWindow& window : choose_windows(log, 10.25, 10).windows) {
    for (const Stamp time : {window.from, window.until}) {
      const auto entry =
          std::ranges::find(log.gnss.entries, time, [](const auto& e) { return e.fix.time; });
      ASSERT_NE(entry, log.gnss.entries.end());
      EXPECT_TRUE(entry->reference);
    }
  }
}

TEST(ReplayWindows, TooShortADriveIsRefusedWithWhatThereIs) {
  try {
    static_cast<void>(choose_windows(MadeUpDrive::log(60), 60.0, 10));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("gnss.csv"), testing::HasSubstr("has 0 places"),
                               testing::HasSubstr("60 s"), testing::HasSubstr("fewer windows")));
  }
}

}  // namespace
}  // namespace locsim::scenarios
