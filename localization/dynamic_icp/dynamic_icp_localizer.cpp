#include "localization/dynamic_icp/dynamic_icp_localizer.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "localization/preprocess/deskew.h"

namespace locsim::localization {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Duration kScanMax = std::chrono::seconds(1);
/// How far a scan may end past the newest IMU sample before the odometry goes on without.
constexpr Duration kImuLate = std::chrono::milliseconds(100);
constexpr Duration kClockBroken = std::chrono::seconds(10);
constexpr Duration kFixFresh = std::chrono::milliseconds(1500);
/// Points of a scan without firing times are off by as much as the vehicle moves within it.
constexpr double kUntimedShift_m = 0.05;
constexpr double kUntimedTurn_rad = 0.2 * kDegree;
/// Of a pose that a search found [m], [rad].
constexpr double kFoundSigma_m = 0.2;
constexpr double kFoundSigma_rad = 1.0 * kDegree;
/// A heading by GNSS or compass is off by more than its sigma: iron, slip.
constexpr double kHeadingSigmaMin_rad = 5.0 * kDegree;

const maps::PriorMap& checked_map(const LocalizerInputs& inputs) {
  if (!inputs.map) throw InputError("dynamic_icp: needs a prior map");
  if (inputs.rig.T_vehicle_lidar.empty()) {
    throw InputError("dynamic_icp: needs a LIDAR on the vehicle");
  }
  return *inputs.map;
}

const DynamicIcpLocalizerConfig& checked(const DynamicIcpLocalizerConfig& config) {
  check_parameters(config, "dynamic_icp");
  return config;
}

class DynamicIcpSettings final : public LocalizerSettings {
 public:
  void describe(Parameters& p) override { config_.describe(p); }
  [[nodiscard]] std::unique_ptr<Localizer> make(const LocalizerInputs& inputs) const override {
    return std::make_unique<DynamicIcpLocalizer>(inputs, config_);
  }

 private:
  DynamicIcpLocalizerConfig config_;
};

bool is_untimed(const LidarScan& scan) {
  return std::ranges::all_of(scan.points, [&](const LidarPoint& point) {
    return point.time_ns == scan.points.front().time_ns;
  });
}

Eigen::Matrix2d horizontal(const Estimate& estimate) {
  const Matrix3d R = estimate.T_map_vehicle.rotation.toRotationMatrix();
  const Matrix3d in_map = R * estimate.covariance.topLeftCorner<3, 3>() * R.transpose();
  return in_map.topLeftCorner<2, 2>();
}

double yaw_sigma_rad(const Estimate& estimate) {
  const Vector3d up = estimate.T_map_vehicle.rotation.conjugate() * Vector3d::UnitZ();
  return std::sqrt(up.dot(estimate.covariance.bottomRightCorner<3, 3>() * up));
}

}  // namespace

void FusionConfig::describe(Parameters& p) {
  p.flag("enabled", enabled);
  p.group("join", join);
  p.group("blend", blend);
  p.number("common_sigma_m", common_sigma_m, {0.0, 10.0});
  p.degrees("common_sigma_deg", common_sigma_rad, {0.0, 45.0});
}

void DynamicIcpLocalizerConfig::describe(Parameters& p) {
  p.group("points", points);
  p.group("gnss_odometry", gnss_odometry);
  p.group("inertial_odometry", inertial_odometry);
  p.group("lidar_odometry", lidar_odometry);
  p.group("fusion", fusion);
  p.group("judge", judge);
  p.flag("judging", judging);
  p.number("search_interval_s", search_interval_s, {0.0, 60.0});
}

std::unique_ptr<LocalizerSettings> make_dynamic_icp_settings() {
  return std::make_unique<DynamicIcpSettings>();
}

DynamicIcpLocalizer::DynamicIcpLocalizer(const LocalizerInputs& inputs,
                                         const DynamicIcpLocalizerConfig& config)
    : rig_(inputs.rig),
      config_(checked(config)),
      frame_(checked_map(inputs).geodetic_origin()),
      gnss_odometry_(inputs.rig, frame_.origin(), config.gnss_odometry),
      guess_(inputs.rig, frame_.origin()),
      lidar_odometry_(*inputs.map, config.lidar_odometry),
      judge_(config.judge),
      join_(config.fusion.join),
      gnss_velocities_(duration_from_seconds(config.fusion.blend.velocity_hold_s),
                       std::chrono::seconds(60)) {}

bool DynamicIcpLocalizer::belongs(const ImuSample& sample) {
  const bool fits = !newest_sample_ || (sample.time > *newest_sample_ &&
                                        sample.time - *newest_sample_ <= kClockBroken);
  if (!fits && ++strange_in_row_ < rig_.imu_rate_hz) return false;
  if (!fits) restart();
  strange_in_row_ = 0;
  newest_sample_ = sample.time;
  return true;
}

void DynamicIcpLocalizer::restart() {
  gnss_odometry_ = GnssOdometry(rig_, frame_.origin(), config_.gnss_odometry);
  guess_ = InitialGuess(rig_, frame_.origin());
  inertial_.reset();
  judge_ = Judge(config_.judge);
  join_.clear();
  joined_.reset();
  gnss_velocities_.clear();
  last_fix_.reset();
  last_scan_.reset();
  last_search_.reset();
  searches_ = 0;
}

void DynamicIcpLocalizer::add(const ImuSample& sample) {
  if (!is_usable(sample) || !belongs(sample)) return;
  gnss_odometry_.add(sample);
  guess_.add(sample);
  if (!inertial_) {
    start();
    return;
  }
  inertial_->add(sample);
  step_judge();
  done("imu");
}

void DynamicIcpLocalizer::add(const MagneticHeading& heading) {
  static_cast<void>(gnss_odometry_.add(heading));
  if (config_.gnss_odometry.magnetic_heading) guess_.add(heading);
}

void DynamicIcpLocalizer::add(const GnssFix& fix) {
  if (!is_usable(fix)) return;
  const AidStatus status = gnss_odometry_.add(fix);
  if (status == AidStatus::duplicate || status == AidStatus::too_new) return;
  GnssFix by_imu = fix;
  by_imu.time += duration_from_seconds(config_.gnss_odometry.gnss_time_offset_s);
  guess_.add(by_imu);
  if (!last_fix_ || by_imu.time > last_fix_->time) last_fix_ = by_imu;
  if (!inertial_) {
    start();
    return;
  }
  const MotionHistory& motion = inertial_->motion();
  if (motion.covers(by_imu.time, kImuLate)) {
    const Pose then = motion.at(by_imu.time);
    const Vector3d arm = then.rotation * rig_.antenna_in_vehicle_m;
    const Vector3d turning =
        then.rotation * (rig_.T_vehicle_imu.rotation * inertial_->filter().angular_rate_rad_s())
                            .cross(rig_.antenna_in_vehicle_m);
    gnss_velocities_.add(by_imu.time, by_imu.velocity_enu_m_s - turning);
    judge_.on_fix(frame_.to_map(by_imu.position), by_imu.position_covariance_m2,
                  then.translation + arm, horizontal(inertial_->filter().vehicle_estimate()),
                  by_imu.time);
  }
  inertial_->add(by_imu);
  step_judge();
  done("gnss");
}

void DynamicIcpLocalizer::start() {
  // Heading may stay unknown while the vehicle stands: Algorithm 1 finds it.
  std::optional<Guess> guess = guess_.make();
  if (!guess) guess = guess_.make_at_rest();
  if (guess) inertial_.emplace(rig_, frame_, config_.inertial_odometry, *guess);
}

void DynamicIcpLocalizer::step_judge() {
  if (!config_.judging) return;
  if (judge_.step(inertial_->time(), inertial_->sigma_horizontal_m())) {
    // The belief stays as it is: it may be right after all, and a search does not ask it.
    join_.clear();
    joined_.reset();
    searches_ = 0;
  }
}

bool DynamicIcpLocalizer::can_place(const LidarScan& scan) const {
  const MotionHistory& motion = inertial_->motion();
  if (!motion.covers(scan.start, Duration::zero()) || !motion.covers(scan.end, kImuLate)) {
    return false;
  }
  if (!is_untimed(scan)) return true;
  const Pose moved = motion.at(scan.start).inverse() * motion.at(scan.end);
  return moved.translation.norm() < kUntimedShift_m &&
         so3::log(moved.rotation).norm() < kUntimedTurn_rad;
}

void DynamicIcpLocalizer::add(const LidarScan& scan) {
  if (!inertial_ || scan.end <= scan.start || (last_scan_ && scan.end <= *last_scan_)) return;
  if (scan.points.empty() || scan.end - scan.start > kScanMax) return;
  if (scan.end > inertial_->time() + kImuLate && scan.end < inertial_->time() + kClockBroken) {
    inertial_->coast(scan.end);
    // Before the scan makes it sure again: what it may be sure of must have been found.
    step_judge();
  }
  if (!can_place(scan)) return;
  last_scan_ = scan.end;

  const std::vector<std::uint32_t> picked = pick_points(scan, rig_, config_.points);
  done("pick");
  const std::vector<Vector3f> points = deskew(scan, picked, inertial_->motion(), scan.end, rig_);
  done("deskew");
  if (judge_.needs_search()) {
    search(points, scan.end);
  } else {
    track(points, scan.end);
  }
  step_judge();
  done("judge");
}

std::optional<GnssGuess> DynamicIcpLocalizer::guess(Stamp time) const {
  GnssGuess out;
  const std::optional<Estimate> gnss = gnss_odometry_.estimate();
  const bool aligned = gnss && time - gnss->time < kFixFresh;
  const double scale2 = std::pow(config_.judge.gnss_scale, 2);
  if (aligned) {
    out.T_map_vehicle = gnss->T_map_vehicle;
    out.covariance_xy_m2 = horizontal(*gnss);
    out.yaw_sigma_rad = std::max(yaw_sigma_rad(*gnss), kHeadingSigmaMin_rad);
  } else {
    // Roll and pitch by the inertial odometry, which began with gravity.
    out.T_map_vehicle = inertial_->motion().at(time);
  }
  if (!last_fix_ || time - last_fix_->time > kFixFresh) {
    return aligned ? std::optional(out) : std::nullopt;
  }
  const Vector3d by_fix = frame_.to_map(last_fix_->position) +
                          last_fix_->velocity_enu_m_s * to_seconds(time - last_fix_->time) -
                          out.T_map_vehicle.rotation * rig_.antenna_in_vehicle_m;
  Eigen::Matrix2d covariance = scale2 * last_fix_->position_covariance_m2.topLeftCorner<2, 2>();
  covariance.diagonal().array() += std::pow(config_.judge.gnss_floor_m, 2);
  const Eigen::Vector2d off = (by_fix - out.T_map_vehicle.translation).head<2>();
  const Eigen::Matrix2d S = covariance + out.covariance_xy_m2;
  // A filter that refuses its fixes and the fixes cannot both be right: each gets its turn.
  const bool disagree = off.dot(S.ldlt().solve(off)) > config_.judge.gnss_gate;
  if (!aligned || (disagree && searches_ % 2 == 0)) {
    out.T_map_vehicle.translation = by_fix;
    out.covariance_xy_m2 = covariance;
  }
  return out;
}

// Paper Algorithm 1 from GNSS.
void DynamicIcpLocalizer::search(std::span<const Vector3f> points, Stamp time) {
  if (last_search_ && to_seconds(time - *last_search_) < config_.search_interval_s) return;
  const std::optional<GnssGuess> from = guess(time);
  if (!from) return;
  last_search_ = time;
  ++searches_;
  last_result_ = lidar_odometry_.relocalize(points, *from);
  done("search");
  if (last_result_.status == DynamicIcpStatus::converged) take(last_result_.alignment, time);
}

void DynamicIcpLocalizer::take(const Alignment& found, Stamp time) {
  Matrix6d covariance = found.covariance;
  covariance.diagonal().head<3>().array() += kFoundSigma_m * kFoundSigma_m;
  covariance.diagonal().tail<3>().array() += kFoundSigma_rad * kFoundSigma_rad;
  inertial_->place(found.T_map_vehicle, time, covariance);
  join_.clear();
  joined_.reset();
  join(found.T_map_vehicle, found.T_map_vehicle, time);
  judge_.on_found(time);
}

// Paper Algorithm 1 from the IMU's prediction.
void DynamicIcpLocalizer::track(std::span<const Vector3f> points, Stamp time) {
  const Pose prediction = inertial_->motion().at(time);
  last_result_ = lidar_odometry_.track(points, prediction, inertial_->sigma_horizontal_m());
  done("align");
  const Alignment& alignment = last_result_.alignment;
  const Matrix6d known = inertial_->filter().vehicle_estimate().covariance;
  Verdict verdict =
      judge_.examine(alignment, prediction, known, to_seconds(time - judge_.last_good()));
  verdict.converged &= last_result_.status == DynamicIcpStatus::converged;
  const bool believed =
      config_.judging ? verdict.good() : alignment.status == AlignmentStatus::converged;
  if (believed) {
    inertial_->correct(alignment.T_map_vehicle, time, alignment.covariance, !alignment.degenerate);
    join(alignment.T_map_vehicle, prediction, time);
  }
  judge_.on_registration(believed || !config_.judging, time);
  done("fuse");
  if (judge_.doubts() && config_.judging) look_around(points, alignment, time);
}

// GNSS has the vehicle elsewhere. Either it is wrong, or the pose is an alias: the scan decides.
void DynamicIcpLocalizer::look_around(std::span<const Vector3f> points, const Alignment& alignment,
                                      Stamp time) {
  if (last_search_ && to_seconds(time - *last_search_) < 2.0 * config_.search_interval_s) return;
  std::optional<GnssGuess> from = guess(time);
  if (!from) return;
  last_search_ = time;
  ++searches_;
  const DynamicIcpResult there = lidar_odometry_.relocalize(points, *from);
  done("search");
  const bool found = there.status == DynamicIcpStatus::converged;
  if (found && is_same_place(there.alignment.T_map_vehicle, alignment.T_map_vehicle)) {
    judge_.acquit(time);
    return;
  }
  const double ratio = cost_ratio(there.alignment, alignment, config_.lidar_odometry.alignment);
  if (ratio > config_.lidar_odometry.rival_cost_ratio) {
    judge_.acquit(time);
  } else if (found && ratio < 1.0) {
    judge_.convict();
    take(there.alignment, time);
  }
}

void DynamicIcpLocalizer::join(const Pose& T_map_vehicle, const Pose& prediction, Stamp time) {
  Pose T_last_this;
  if (joined_) T_last_this = inertial_at_join_.inverse() * prediction;
  if (!join_.add({time, T_map_vehicle}, T_last_this)) return;
  joined_ = StampedPose{time, T_map_vehicle};
  inertial_at_join_ = inertial_->motion().at(time);
}

std::optional<Pose> DynamicIcpLocalizer::fused(Stamp time) const {
  if (!joined_ || !config_.fusion.enabled) return std::nullopt;
  // Q^l at t − 1, the newest LIDAR pose, and now.
  const std::optional<Pose> before = join_.at(joined_->time, Pose{});
  const std::optional<Pose> now =
      join_.at(time, inertial_at_join_.inverse() * inertial_->T_map_vehicle());
  if (!before || !now) return std::nullopt;
  BlendInput input{.T_map_vehicle_before = *before, .T_map_vehicle_now = *now};
  const std::optional<Estimate> gnss = gnss_odometry_.estimate();
  if (gnss && gnss->time == time) {
    const Matrix3d R = gnss->T_map_vehicle.rotation.toRotationMatrix();
    input.gnss_T_map_vehicle = gnss->T_map_vehicle;
    input.gnss_position_covariance_m2 = R * gnss->covariance.topLeftCorner<3, 3>() * R.transpose();
  } else {
    input.gnss_position_covariance_m2.setConstant(std::numeric_limits<double>::infinity());
  }
  input.gnss_displacement_m = gnss_velocities_.displacement(joined_->time, time);
  return blend(input, config_.fusion.blend).T_map_vehicle;
}

std::optional<Estimate> DynamicIcpLocalizer::estimate() const {
  if (!inertial_) return std::nullopt;
  Estimate estimate = inertial_->filter().vehicle_estimate();
  if (const std::optional<Pose> fused_pose = fused(estimate.time)) {
    estimate.T_map_vehicle = *fused_pose;
  }
  const FusionConfig& fusion = config_.fusion;
  estimate.covariance.diagonal().head<3>().array() += fusion.common_sigma_m * fusion.common_sigma_m;
  estimate.covariance.diagonal().tail<3>().array() +=
      fusion.common_sigma_rad * fusion.common_sigma_rad;
  estimate.state = judge_.state();
  if (!config_.judging && !judge_.needs_search()) estimate.state = State::tracking;
  return estimate;
}

}  // namespace locsim::localization
