#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "core/geodesy.h"
#include "localization/localizer.h"
#include "scenarios/replay.h"

namespace locsim::scenarios {

// A made-up drive: GNSS at 4 Hz, the IMU at 100 Hz, times as large as those of GPS.
struct MadeUpDrive {
  static constexpr double kSpeed_m_s = 10.0;
  static inline const Stamp kStart{Duration{1'752'003'260'000'000'000}};
  static inline const GeodeticPoint kOrigin{
      .latitude_rad = 0.7, .longitude_rad = -1.8, .height_m = 1600.0};

  // Due east, 10 m/s, the antenna on the vehicle's origin.
  [[nodiscard]] static Pose pose(Stamp time) {
    return {.translation = {kSpeed_m_s * to_seconds(time - kStart), 0.0, 0.0}};
  }
  [[nodiscard]] static DriveLog log(int seconds) {
    const LocalFrame frame(kOrigin);
    DriveLog log;
    log.imu.source = "imu.csv";
    log.imu.rate_hz = 100.0;
    log.gnss.source = "gnss.csv";
    for (int i = 0; i <= 100 * seconds; ++i) {
      log.imu.samples.push_back(
          {.time = kStart + i * Duration{10'000'000}, .specific_force_m_s2 = {0.0, 0.0, 9.81}});
    }
    for (int i = 0; i <= 4 * seconds; ++i) {
      GnssLog::Entry entry{.reference = true};
      entry.fix.time = kStart + i * Duration{250'000'000};
      entry.fix.position = frame.to_geodetic(pose(entry.fix.time).translation);
      entry.fix.velocity_enu_m_s = {kSpeed_m_s, 0.0, 0.0};
      entry.fix.position_covariance_m2 = 1e-4 * Matrix3d::Identity();
      entry.fix.velocity_covariance_m2_s2 = 1e-3 * Matrix3d::Identity();
      entry.fix.state = FixState::three_dimensional;
      entry.fix.valid = true;
      log.gnss.entries.push_back(entry);
    }
    return log;
  }
};

// Says what a function says; knows how long it got no fix.
class ToldLocalizer final : public localization::Localizer {
 public:
  using Tell =
      std::function<std::optional<localization::Estimate>(Stamp now, double without_fix_s)>;
  explicit ToldLocalizer(Tell tell) : tell_(std::move(tell)) {}

  using Localizer::add;
  void add(const ImuSample& sample) override { now_ = sample.time; }
  void add(const GnssFix& fix) override { fix_ = fix.time; }
  void add(const MagneticHeading&) override {}
  void add(const LidarScan&) override {}
  [[nodiscard]] std::optional<localization::Estimate> estimate() const override {
    return tell_(now_, fix_ ? to_seconds(now_ - *fix_) : 0.0);
  }

 private:
  Tell tell_;
  Stamp now_;
  std::optional<Stamp> fix_;
};

[[nodiscard]] inline MakeLocalizer told(ToldLocalizer::Tell tell) {
  return [tell = std::move(tell)] { return std::make_unique<ToldLocalizer>(tell); };
}

// The truth, `offset_m` beside it, turned by `yaw_deg`.
[[nodiscard]] inline localization::Estimate beside_truth(Stamp now, const Vector3d& offset_m,
                                                         double yaw_deg = 0.0) {
  localization::Estimate estimate{
      .time = now, .T_map_vehicle = MadeUpDrive::pose(now), .state = localization::State::tracking};
  estimate.T_map_vehicle.translation += offset_m;
  estimate.T_map_vehicle.rotation = rotation_from_rpy(0.0, 0.0, yaw_deg * std::numbers::pi / 180.0);
  estimate.covariance = Matrix6d::Identity();
  return estimate;
}

}  // namespace locsim::scenarios
