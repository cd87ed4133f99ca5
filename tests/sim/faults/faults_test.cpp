#include "sim/faults/faults.h"

#include <gtest/gtest.h>

#include <string>

#include "core/error.h"

namespace locsim::sim {
namespace {

TEST(Faults, AreOnFromTheirStartUpToTheirEnd) {
  const Faults faults({{.at_s = 10.0, .for_s = 5.0, .kind = "gnss_outage"},
                       {.at_s = 12.0, .for_s = 1.0, .kind = "lidar_blackout"},
                       {.at_s = 14.0, .for_s = 4.0, .kind = "gnss_outage"}});
  const auto gnss = [&](double t_s) {
    return faults.active("gnss_outage", stamp_from_seconds(t_s));
  };
  EXPECT_FALSE(gnss(0.0));
  EXPECT_FALSE(gnss(9.999999999));
  EXPECT_TRUE(gnss(10.0));
  EXPECT_TRUE(gnss(14.5));
  EXPECT_TRUE(gnss(17.999999999));
  EXPECT_FALSE(gnss(18.0));
  EXPECT_FALSE(faults.active("lidar_blackout", stamp_from_seconds(11.0)));
  EXPECT_TRUE(faults.active("lidar_blackout", stamp_from_seconds(12.0)));
  EXPECT_FALSE(faults.active("lidar_blackout", stamp_from_seconds(13.0)));
}

TEST(Faults, CountFromTheScenariosStart) {
  const Stamp start = stamp_from_seconds(1000.0);
  const Faults faults({{.at_s = 10.0, .for_s = 5.0, .kind = "lidar_blackout"}}, start);
  EXPECT_FALSE(faults.active("lidar_blackout", stamp_from_seconds(12.0)));
  EXPECT_TRUE(faults.active("lidar_blackout", stamp_from_seconds(1012.0)));
  const auto intervals = faults.intervals("lidar_blackout");
  ASSERT_EQ(intervals.size(), 1u);
  EXPECT_EQ(intervals[0].begin, stamp_from_seconds(1010.0));
  EXPECT_EQ(intervals[0].end, stamp_from_seconds(1015.0));
  EXPECT_TRUE(faults.intervals("gnss_outage").empty());
}

TEST(Faults, NoneMeansNothingIsBroken) {
  EXPECT_FALSE(Faults().active("gnss_outage", Stamp{}));
}

TEST(Faults, UnknownKindIsRefusedWithTheKindsThereAre) {
  try {
    const Faults faults({{.at_s = 1.0, .for_s = 1.0, .kind = "gnss_outage"},
                         {.at_s = 1.0, .for_s = 1.0, .kind = "meteor"}});
    FAIL();
  } catch (const InputError& error) {
    const std::string message = error.what();
    for (const char* part : {"faults[1]", "kind", "meteor", "gnss_outage", "lidar_blackout"}) {
      EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
    }
  }
}

TEST(Faults, NegativeTimesAreRefused) {
  EXPECT_THROW(Faults({{.at_s = -1.0, .for_s = 1.0, .kind = "gnss_outage"}}), InputError);
  EXPECT_THROW(Faults({{.at_s = 1.0, .for_s = 0.0, .kind = "gnss_outage"}}), InputError);
}

}  // namespace
}  // namespace locsim::sim
