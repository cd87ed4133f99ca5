#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "localization/dynamic_icp/dynamic_icp.h"
#include "localization/dynamic_icp/gnss_blend.h"
#include "localization/dynamic_icp/inertial_odometry.h"
#include "localization/dynamic_icp/judge.h"
#include "localization/dynamic_icp/quadratic_join.h"
#include "localization/gnss_ins/gnss_odometry.h"
#include "localization/localizer.h"
#include "localization/preprocess/point_picker.h"
#include "localization/registry.h"

namespace locsim::localization {

/// The paper's last section: Q^l by the quadratic join, Q̂ by eq. (18).
struct FusionConfig {
  /// False: the inertial filter's belief is the output.
  bool enabled = true;
  QuadraticJoinConfig join;
  GnssBlendConfig blend;
  /// What many registrations have in common (map, calibration): no filtering takes it off, so the
  /// reported covariance holds it always.
  double common_sigma_m = 0.02;
  double common_sigma_rad = 0.0009;

  void describe(Parameters& p);
};

struct DynamicIcpLocalizerConfig {
  PointPickerConfig points{
      .range_min_m = 2.0, .range_max_m = 75.0, .voxel_m = 0.8, .points_max = 2500};
  GnssOdometryConfig gnss_odometry;
  InertialOdometryConfig inertial_odometry;
  DynamicIcpConfig lidar_odometry;
  FusionConfig fusion;
  JudgeConfig judge;
  /// False: whatever converged is believed, and `tracking` from the first pose on.
  bool judging = true;
  /// Between two searches.
  double search_interval_s = 0.5;

  void describe(Parameters& p);
};

/// `dynamic_icp`: the framework of Cheng et al. GNSS-based odometry Q^g (`GnssOdometry`) tells
/// Algorithm 1 where to look; once found, IMU preintegration (`InertialOdometry`) predicts each
/// scan's pose for it; the quadratic join of both, Q^l, and Q^g are blended to Q̂ at the IMU's rate;
/// a judge says what may be believed of it.
class DynamicIcpLocalizer final : public Localizer {
 public:
  /// Throws InputError without a map or a LIDAR, or with a value out of its limits.
  DynamicIcpLocalizer(const LocalizerInputs& inputs, const DynamicIcpLocalizerConfig& config);

  using Localizer::add;
  void add(const ImuSample& sample) override;
  void add(const GnssFix& fix) override;
  void add(const MagneticHeading& heading) override;
  void add(const LidarScan& scan) override;
  [[nodiscard]] std::optional<Estimate> estimate() const override;

  /// For measuring: called at the end of each stage with its name: imu, gnss, pick, deskew, align,
  /// search, judge, fuse.
  void on_stage(std::function<void(std::string_view)> observer) { observer_ = std::move(observer); }
  /// Of the last scan.
  [[nodiscard]] const DynamicIcpResult& last_result() const { return last_result_; }

 private:
  void start();
  /// False for a sample that is not newer, or newer by more than clocks may; a second's worth of
  /// such in a row is a clock that was set, and all begins anew.
  [[nodiscard]] bool belongs(const ImuSample& sample);
  void restart();
  void step_judge();
  [[nodiscard]] bool can_place(const LidarScan& scan) const;
  [[nodiscard]] std::optional<GnssGuess> guess(Stamp time) const;
  void search(std::span<const Vector3f> points, Stamp time);
  void track(std::span<const Vector3f> points, Stamp time);
  void look_around(std::span<const Vector3f> points, const Alignment& alignment, Stamp time);
  void take(const Alignment& found, Stamp time);
  /// `prediction` is where the IMU had the vehicle.
  void join(const Pose& T_map_vehicle, const Pose& prediction, Stamp time);
  [[nodiscard]] std::optional<Pose> fused(Stamp time) const;
  void done(std::string_view stage) const {
    if (observer_) observer_(stage);
  }

  Rig rig_;
  DynamicIcpLocalizerConfig config_;
  LocalFrame frame_;
  GnssOdometry gnss_odometry_;
  InitialGuess guess_;
  std::optional<InertialOdometry> inertial_;
  DynamicIcp lidar_odometry_;
  Judge judge_;
  QuadraticJoin join_;
  GnssVelocityTrack gnss_velocities_;
  std::function<void(std::string_view)> observer_;

  std::optional<Stamp> newest_sample_;
  int strange_in_row_ = 0;
  std::optional<GnssFix> last_fix_;
  std::optional<Stamp> last_scan_;
  std::optional<Stamp> last_search_;
  int searches_ = 0;
  /// The newest LIDAR pose in the join, and what the inertial odometry believed after it.
  std::optional<StampedPose> joined_;
  Pose inertial_at_join_;
  DynamicIcpResult last_result_;
};

/// For the registry.
[[nodiscard]] std::unique_ptr<LocalizerSettings> make_dynamic_icp_settings();

}  // namespace locsim::localization
