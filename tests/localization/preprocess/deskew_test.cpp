#include "localization/preprocess/deskew.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/random.h"

namespace locsim::localization {
namespace {

/// Vehicle with constant twist.
Pose pose_at(double t) {
  Vector6d twist;
  twist << 15.0, 0.0, 0.2, 0.02, -0.03, 0.5;
  return Pose{rotation_from_rpy(0.01, 0.02, 1.0), {5.0, 6.0, 7.0}} * se3::exp(twist * t);
}

TEST(Deskew, BringsAConstantTwistToOneTime) {
  Rig rig;
  rig.T_vehicle_lidar = {{rotation_from_rpy(0.0, 0.02, -0.1), {0.3, 0.1, 1.9}},
                         {rotation_from_rpy(0.3, 0.0, 1.5), {-1.0, 0.5, 1.5}}};
  MotionHistory motion(std::chrono::seconds(1));
  for (int k = 0; k <= 20; ++k) motion.push(stamp_from_seconds(0.005 * k), pose_at(0.005 * k));

  LidarScan scan;
  scan.end = stamp_from_seconds(0.1);
  RandomSequence random(2, "test/deskew");
  std::vector<Vector3d> fixed;
  double skew_m = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Vector3d p_map(random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(0, 20));
    const double t = 0.1 * i / 500;
    const auto sensor = static_cast<std::uint16_t>(i % 2);
    const Vector3f p = ((pose_at(t) * rig.T_vehicle_lidar[sensor]).inverse() * p_map).cast<float>();
    scan.points.push_back(
        {p.x(), p.y(), p.z(), 0.0F, static_cast<std::uint32_t>(t * 1e9), 0, sensor});
    fixed.push_back(pose_at(0.1).inverse() * p_map);
    skew_m =
        std::max(skew_m, (rig.T_vehicle_lidar[sensor] * p.cast<double>() - fixed.back()).norm());
  }
  std::vector<std::uint32_t> all(scan.points.size());
  std::iota(all.begin(), all.end(), 0U);
  const std::vector<Vector3f> points = deskew(scan, all, motion, scan.end, rig);
  ASSERT_EQ(points.size(), fixed.size());
  EXPECT_GT(skew_m, 1.0);
  // The path between poses 5 ms apart is taken straight: v·ω·dt²/8 = 15·0.5·2.5e-5/8 = 2.4e-5 m;
  // times are whole nanoseconds (2e-8 m); coordinates are floats below 128 m (7.6e-6 m, twice).
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((points[i].cast<double>() - fixed[i]).norm(), 5e-5) << i;
  }
}

}  // namespace
}  // namespace locsim::localization
