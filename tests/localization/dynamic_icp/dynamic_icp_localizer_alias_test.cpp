#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "tests/localization/dynamic_icp/simulated_messages.h"

namespace locsim::localization {
namespace {

using namespace testing;

/// Six times the same 60 m of houses.
Street blocks() {
  Street street;
  std::vector<Box> one;
  std::ranges::copy_if(street.boxes, std::back_inserter(one),
                       [](const Box& box) { return box.low.x() >= -30.0 && box.high.x() <= 30.0; });
  street.boxes.clear();
  street.parked.clear();
  for (int block = -2; block < 4; ++block) {
    const Vector3d shift(60.0 * block, 0.0, 0.0);
    for (const Box& box : one) street.boxes.push_back({box.low + shift, box.high + shift});
  }
  street.length_m = 420.0;
  return street;
}

/// Error of the worst pose called `tracking`, and how many there were, at rest with fixes `off_m`
/// east that claim 15 m.
struct Tracked {
  double worst_m = 0.0;
  int count = 0;
};
Tracked track(const Street& street, const std::shared_ptr<const maps::PriorMap>& map,
              double start_x_m, double off_m) {
  const Drive drive{.start_x_m = start_x_m, .standing_s = 2.0};
  Noise noise;
  noise.gnss_error_m = {off_m, 0.0, 2.0};
  std::vector<Message> messages = record(Sensors(street, drive, make_rig(), noise), 1.1);
  change<GnssFix>(messages, [](GnssFix& fix, double) {
    fix.position_covariance_m2 = 15.0 * 15.0 * Matrix3d::Identity();
  });
  DynamicIcpLocalizerConfig config;
  // So that both ends are out of sight.
  config.points.range_max_m = 50.0;
  const auto localizer = make_dynamic_icp(config, map);
  Tracked tracked;
  play(*localizer, messages, [&](const Estimate& estimate, double t) {
    if (estimate.state != State::tracking) return;
    ++tracked.count;
    tracked.worst_m = std::max(tracked.worst_m, error_m(estimate, drive.pose(t)));
  });
  return tracked;
}

TEST(DynamicIcpLocalizerAlias, OfBlocksThatLookAlikeTheWrongOneIsNeverTracked) {
  const Street street = blocks();
  const auto map = map_of(street);
  // Nearer to the next block, in between, and near the right one.
  for (const double start_x_m : {10.0, 4.0, 16.0}) {
    EXPECT_LT(track(street, map, start_x_m, 40.0).worst_m, 2.0) << start_x_m;
  }
  EXPECT_LT(track(street, map, 10.0, -28.0).worst_m, 2.0);
  EXPECT_LT(track(street, map, 10.0, 10.0).worst_m, 2.0);
}

TEST(DynamicIcpLocalizerAlias, TheSameFixesDoWhereTheStreetLooksLikeNothingElse) {
  const Tracked tracked = track(the_street(), the_map(), 10.0, 40.0);
  EXPECT_GT(tracked.count, 50);
  EXPECT_LT(tracked.worst_m, 0.3);
}

}  // namespace
}  // namespace locsim::localization
