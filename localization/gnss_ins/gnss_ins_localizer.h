#pragma once

#include <memory>
#include <numbers>
#include <optional>

#include "localization/gnss_ins/gnss_odometry.h"
#include "localization/localizer.h"
#include "localization/registry.h"

namespace locsim::localization {

/// What the states mean. Sigmas are those of the reported covariance, which after the last fix grow
/// as the IMU's errors let them.
struct GnssInsHealthConfig {
  /// Tracking promises a horizontal error below 2 m: its sigma, along the worst axis …
  double tracking_sigma_m = 1.0;
  double tracking_sigma_yaw_rad = 3.0 * std::numbers::pi / 180.0;
  /// … and a position accepted within this time.
  double degraded_after_s = 3.0;
  double lost_sigma_m = 20.0;
  double lost_sigma_yaw_rad = 20.0 * std::numbers::pi / 180.0;
  double lost_after_s = 120.0;
  /// Without IMU samples, while fixes come: lost.
  double imu_silent_s = 0.5;
  /// Positions accepted in a row that end initializing and lost, and that end degraded.
  int confirm_fixes = 5;
  int recover_fixes = 3;

  void describe(Parameters& p);
};

struct GnssInsConfig {
  GnssOdometryConfig odometry;
  GnssInsHealthConfig health;

  /// The odometry's keys, and the group `health`.
  void describe(Parameters& p);
};

/// `gnss_ins`: the paper's GNSS-based odometry alone. Needs no map and takes no notice of scans.
class GnssInsLocalizer final : public Localizer {
 public:
  /// Throws InputError for a value out of its limits.
  GnssInsLocalizer(const LocalizerInputs& inputs, const GnssInsConfig& config);

  using Localizer::add;
  void add(const ImuSample& sample) override;
  void add(const GnssFix& fix) override;
  void add(const MagneticHeading& heading) override;
  void add(const LidarScan&) override {}
  [[nodiscard]] std::optional<Estimate> estimate() const override;

  [[nodiscard]] const GnssOdometry& odometry() const { return odometry_; }

 private:
  void step_health();

  GnssInsHealthConfig health_;
  GnssOdometry odometry_;
  State state_ = State::initializing;
};

/// For the registry.
[[nodiscard]] std::unique_ptr<LocalizerSettings> make_gnss_ins_settings();

}  // namespace locsim::localization
