#pragma once

#include <memory>
#include <numbers>
#include <optional>

#include "localization/fusion/error_state_filter.h"
#include "localization/icp/health.h"
#include "localization/icp/initial_guess.h"
#include "localization/icp/map_registration.h"
#include "localization/icp/pose_search.h"
#include "localization/localizer.h"
#include "localization/preprocess/motion_history.h"
#include "localization/preprocess/point_picker.h"
#include "localization/registry.h"

namespace locsim::localization {

/// What is known of errors that no single measurement shows.
struct IcpNoiseConfig {
  /// Of one registration, where its gain is full.
  double registration_sigma_m = 0.03;
  double registration_sigma_rad = 0.1 * std::numbers::pi / 180.0;
  /// Of what many registrations have in common (map, calibration): no filtering takes it off, so
  /// the reported covariance holds it always.
  double common_sigma_m = 0.02;
  double common_sigma_rad = 0.05 * std::numbers::pi / 180.0;
  /// GNSS errors are larger than claimed, and correlated in time: claimed sigmas times this, and
  /// positions only while the pose is known worse than the floor.
  double gnss_scale = 2.0;
  double gnss_position_floor_m = 1.5;

  void describe(Parameters& p);
};

struct IcpConfig {
  PointPickerConfig points;
  MapRegistrationConfig registration;
  PoseSearchConfig search;
  HealthConfig health;
  IcpNoiseConfig noise;

  void describe(Parameters& p);
};

/// `icp`: starts from GNSS and compass by a search on the prior map, then joins IMU propagation
/// and PCL's point-to-point ICP of each deskewed, thinned scan in an error-state filter. GNSS helps
/// only while registrations fail.
class IcpLocalizer final : public Localizer {
 public:
  /// Throws InputError without a map or a LIDAR, or with a value out of its limits.
  IcpLocalizer(const LocalizerInputs& inputs, const IcpConfig& config);

  using Localizer::add;
  void add(const ImuSample& sample) override;
  void add(const GnssFix& fix) override;
  void add(const MagneticHeading& heading) override;
  void add(const LidarScan& scan) override;
  [[nodiscard]] std::optional<Estimate> estimate() const override;

 private:
  void start();
  void step_health();
  [[nodiscard]] bool can_place(const LidarScan& scan) const;
  void search(std::span<const Vector3f> points, const Pose& predicted, Stamp time);
  void track(std::span<const Vector3f> points, const Pose& predicted, Stamp time);
  [[nodiscard]] bool looks_good(const Registration& registration) const;
  [[nodiscard]] Eigen::Matrix2d covariance_xy_m2() const;
  [[nodiscard]] double sigma_horizontal_m() const;
  /// The filter's pose from one at `predicted`'s time.
  [[nodiscard]] Pose carried_on(const Pose& T_map_vehicle, const Pose& predicted) const;

  Rig rig_;
  IcpConfig config_;
  MapRegistration registration_;
  InitialGuess guess_;
  Health health_;
  MotionHistory motion_;
  std::optional<ErrorStateFilter> filter_;
  std::optional<Stamp> last_scan_;
  std::optional<Stamp> last_search_;
};

/// For the registry.
[[nodiscard]] std::unique_ptr<LocalizerSettings> make_icp_settings();

}  // namespace locsim::localization
