#include "localization/icp/icp_localizer.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "localization/preprocess/deskew.h"

namespace locsim::localization {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Duration kMotionKept = std::chrono::seconds(1);
/// How far a scan may end past the newest IMU sample before the filter goes on without.
constexpr Duration kImuLate = std::chrono::milliseconds(100);
constexpr Duration kSearchAgain = std::chrono::milliseconds(500);
/// A pose known worse than this is registered from farther away first.
constexpr double kWideSigma_m = 0.3;

const maps::PriorMap& checked_map(const LocalizerInputs& inputs) {
  if (!inputs.map) throw InputError("icp: needs a prior map");
  if (inputs.rig.T_vehicle_lidar.empty()) throw InputError("icp: needs a LIDAR on the vehicle");
  return *inputs.map;
}

const IcpConfig& checked(const IcpConfig& config) {
  check_parameters(config, "icp");
  return config;
}

class IcpSettings final : public LocalizerSettings {
 public:
  void describe(Parameters& p) override { config_.describe(p); }
  [[nodiscard]] std::unique_ptr<Localizer> make(const LocalizerInputs& inputs) const override {
    return std::make_unique<IcpLocalizer>(inputs, config_);
  }

 private:
  IcpConfig config_;
};

}  // namespace

void IcpNoiseConfig::describe(Parameters& p) {
  p.number("registration_sigma_m", registration_sigma_m, {1e-4, 10.0});
  p.degrees("registration_sigma_deg", registration_sigma_rad, {1e-4, 45.0});
  p.number("common_sigma_m", common_sigma_m, {0.0, 10.0});
  p.degrees("common_sigma_deg", common_sigma_rad, {0.0, 45.0});
  p.number("gnss_scale", gnss_scale, {0.1, 100.0});
  p.number("gnss_position_floor_m", gnss_position_floor_m, {0.01, 100.0});
}

void IcpConfig::describe(Parameters& p) {
  p.group("points", points);
  p.group("registration", registration);
  p.group("search", search);
  p.group("health", health);
  p.group("noise", noise);
}

std::unique_ptr<LocalizerSettings> make_icp_settings() {
  return std::make_unique<IcpSettings>();
}

IcpLocalizer::IcpLocalizer(const LocalizerInputs& inputs, const IcpConfig& config)
    : rig_(inputs.rig),
      config_(checked(config)),
      registration_(checked_map(inputs), config.registration),
      guess_(inputs.rig, inputs.map->geodetic_origin()),
      health_(config.health),
      motion_(kMotionKept) {}

void IcpLocalizer::add(const ImuSample& sample) {
  if (!is_usable(sample)) return;
  guess_.add(sample);
  if (!filter_ || sample.time <= filter_->state().time) return;
  filter_->predict(sample);
  motion_.push(sample.time, filter_->T_map_vehicle());
  step_health();
}

void IcpLocalizer::add(const MagneticHeading& heading) {
  guess_.add(heading);
}

void IcpLocalizer::add(const GnssFix& fix) {
  if (!is_usable(fix)) return;
  guess_.add(fix);
  if (!filter_) {
    start();
    return;
  }
  if (health_.has_recent_registration(filter_->state().time)) return;
  const Duration age = filter_->state().time - fix.time;
  if (age < Duration::zero() - kImuLate || age > kMotionKept) return;

  const double scale2 = config_.noise.gnss_scale * config_.noise.gnss_scale;
  const double floor_m = config_.noise.gnss_position_floor_m;
  const Matrix3d identity = Matrix3d::Identity();
  static_cast<void>(filter_->update_velocity(
      fix.velocity_enu_m_s, scale2 * fix.velocity_covariance_m2_s2 + 0.01 * identity));
  if (sigma_horizontal_m() > floor_m) {
    const Vector3d now =
        guess_.frame().to_map(fix.position) + fix.velocity_enu_m_s * to_seconds(age);
    const Matrix3d covariance = scale2 * fix.position_covariance_m2 + floor_m * floor_m * identity;
    // Far off and far from known: then it is the belief that is too sure of itself.
    if (!filter_->update_position(now, covariance).accepted) {
      filter_->inflate_pose(3.0, 1.0 * kDegree);
    }
  }
  motion_.move_newest_to(filter_->T_map_vehicle());
  step_health();
}

void IcpLocalizer::start() {
  const std::optional<Guess> guess = guess_.make();
  if (!guess) return;
  filter_.emplace(rig_, guess->state, guess->pose_covariance_imu, guess->sigmas);
  motion_.clear();
  motion_.push(guess->state.time, filter_->T_map_vehicle());
}

void IcpLocalizer::step_health() {
  if (health_.step(filter_->state().time, sigma_horizontal_m())) {
    // Whatever the filter believed, it was wrong.
    filter_->inflate_pose(2.0, 3.0 * kDegree);
  }
}

Eigen::Matrix2d IcpLocalizer::covariance_xy_m2() const {
  const Matrix3d R = filter_->state().T_map_imu.rotation.toRotationMatrix();
  const Matrix3d in_map = R * filter_->covariance().topLeftCorner<3, 3>() * R.transpose();
  return in_map.topLeftCorner<2, 2>();
}

double IcpLocalizer::sigma_horizontal_m() const {
  const Eigen::Matrix2d c = covariance_xy_m2();
  const double mean = 0.5 * c.trace();
  const double half_difference = 0.5 * (c(0, 0) - c(1, 1));
  return std::sqrt(mean + std::hypot(half_difference, c(0, 1)));
}

bool IcpLocalizer::can_place(const LidarScan& scan) const {
  return motion_.covers(scan.start, Duration::zero()) && motion_.covers(scan.end, kImuLate);
}

void IcpLocalizer::add(const LidarScan& scan) {
  if (!filter_ || scan.end <= scan.start || (last_scan_ && scan.end <= *last_scan_)) return;
  if (scan.end - scan.start > kMotionKept) return;
  if (scan.end > filter_->state().time + kImuLate &&
      scan.end < filter_->state().time + 10 * kMotionKept) {
    filter_->coast(scan.end);
    motion_.push(scan.end, filter_->T_map_vehicle());
  }
  if (!can_place(scan)) return;
  last_scan_ = scan.end;

  const std::vector<std::uint32_t> picked = pick_points(scan, rig_, config_.points);
  if (static_cast<int>(picked.size()) >= config_.health.inliers_min) {
    const std::vector<Vector3f> points = deskew(scan, picked, motion_, scan.end, rig_);
    const Pose predicted = motion_.at(scan.end);
    if (!registration_.move_to(predicted.translation)) {
      health_.on_registration(false, scan.end);
    } else if (health_.needs_search()) {
      search(points, predicted, scan.end);
    } else {
      track(points, predicted, scan.end);
    }
    motion_.move_newest_to(filter_->T_map_vehicle());
  }
  step_health();
}

bool IcpLocalizer::looks_good(const Registration& registration) const {
  return registration.iterations > 0 && registration.inliers >= config_.health.inliers_min &&
         registration.overlap >= config_.health.overlap_min &&
         registration.residual_m <= config_.health.residual_max_m;
}

Pose IcpLocalizer::carried_on(const Pose& T_map_vehicle, const Pose& predicted) const {
  return T_map_vehicle * (predicted.inverse() * filter_->T_map_vehicle());
}

void IcpLocalizer::search(std::span<const Vector3f> points, const Pose& predicted, Stamp time) {
  if (last_search_ && time - *last_search_ < kSearchAgain) return;
  last_search_ = time;
  const PoseSearchResult found =
      search_pose(registration_, points, predicted, covariance_xy_m2(), config_.search);
  if (found.ambiguous || !looks_good(found.best)) return;

  // The pose is taken from the search alone; velocity and biases are kept.
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(0.2 * 0.2);
  covariance.diagonal().tail<3>().setConstant(kDegree * kDegree);
  filter_->reset_pose(carried_on(found.best.T_map_vehicle, predicted), covariance);
  health_.on_found(time);
}

void IcpLocalizer::track(std::span<const Vector3f> points, const Pose& predicted, Stamp time) {
  const MapRegistrationConfig& limits = config_.registration;
  Pose guess = predicted;
  const double sigma = sigma_horizontal_m();
  if (sigma > kWideSigma_m) {
    guess =
        registration_
            .align(points, guess, 3.0 * limits.max_correspondence_m, limits.iterations_max, false)
            .T_map_vehicle;
  }
  const Registration result =
      registration_.align(points, guess, limits.max_correspondence_m, limits.iterations_max, true);
  const double jump_m = (result.T_map_vehicle.translation - predicted.translation).norm();
  bool good = looks_good(result) && jump_m < 0.5 + 4.0 * sigma;
  if (good) {
    // The usual residual comes from the spacing of the map's points.
    const double by_residual = std::max(1.0, result.residual_m / (0.45 * limits.map_voxel_m));
    const double by_overlap = std::max(1.0, 0.8 / result.overlap);
    const double scale2 = std::pow(by_residual * by_overlap, 2);
    Vector6d variances;
    variances.head<3>().setConstant(scale2 * std::pow(config_.noise.registration_sigma_m, 2));
    variances.tail<3>().setConstant(scale2 * std::pow(config_.noise.registration_sigma_rad, 2));
    good = filter_
               ->update_pose(carried_on(result.T_map_vehicle, predicted), result.gain,
                             variances.asDiagonal())
               .accepted;
    if (!good) filter_->inflate_pose(0.1, 0.3 * kDegree);
  }
  health_.on_registration(good, time);
}

std::optional<Estimate> IcpLocalizer::estimate() const {
  if (!filter_) return std::nullopt;
  Estimate estimate = filter_->vehicle_estimate();
  estimate.covariance.diagonal().head<3>().array() += std::pow(config_.noise.common_sigma_m, 2);
  estimate.covariance.diagonal().tail<3>().array() += std::pow(config_.noise.common_sigma_rad, 2);
  estimate.state = health_.state();
  return estimate;
}

}  // namespace locsim::localization
