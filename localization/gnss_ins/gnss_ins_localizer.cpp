#include "localization/gnss_ins/gnss_ins_localizer.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace locsim::localization {

namespace {

const GnssInsConfig& checked(const GnssInsConfig& config) {
  check_parameters(config, "gnss_ins");
  return config;
}

class GnssInsSettings final : public LocalizerSettings {
 public:
  void describe(Parameters& p) override { config_.describe(p); }
  [[nodiscard]] std::unique_ptr<Localizer> make(const LocalizerInputs& inputs) const override {
    return std::make_unique<GnssInsLocalizer>(inputs, config_);
  }

 private:
  GnssInsConfig config_;
};

/// Along the worst horizontal axis.
double sigma_horizontal_m(const Estimate& estimate) {
  const Matrix3d R = estimate.T_map_vehicle.rotation.toRotationMatrix();
  const Matrix3d in_map = R * estimate.covariance.topLeftCorner<3, 3>() * R.transpose();
  const Eigen::Matrix2d horizontal = in_map.topLeftCorner<2, 2>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(horizontal, Eigen::EigenvaluesOnly);
  return std::sqrt(solver.eigenvalues()(1));
}

double sigma_yaw_rad(const Estimate& estimate) {
  const Vector3d up = estimate.T_map_vehicle.rotation.conjugate() * Vector3d::UnitZ();
  return std::sqrt(up.dot(estimate.covariance.bottomRightCorner<3, 3>() * up));
}

}  // namespace

void GnssInsHealthConfig::describe(Parameters& p) {
  p.number("tracking_sigma_m", tracking_sigma_m, kPositive);
  p.degrees("tracking_sigma_yaw_deg", tracking_sigma_yaw_rad, {0.01, 180.0});
  p.number("degraded_after_s", degraded_after_s, kPositive);
  p.number("lost_sigma_m", lost_sigma_m, kPositive);
  p.degrees("lost_sigma_yaw_deg", lost_sigma_yaw_rad, {0.01, 180.0});
  p.number("lost_after_s", lost_after_s, kPositive);
  p.number("imu_silent_s", imu_silent_s, kPositive);
  p.integer("confirm_fixes", confirm_fixes, {1, 10000});
  p.integer("recover_fixes", recover_fixes, {1, 10000});
}

void GnssInsConfig::describe(Parameters& p) {
  odometry.describe(p);
  p.group("health", health);
}

std::unique_ptr<LocalizerSettings> make_gnss_ins_settings() {
  return std::make_unique<GnssInsSettings>();
}

GnssInsLocalizer::GnssInsLocalizer(const LocalizerInputs& inputs, const GnssInsConfig& config)
    : health_(checked(config).health), odometry_(inputs.rig, inputs.origin, config.odometry) {}

void GnssInsLocalizer::add(const ImuSample& sample) {
  odometry_.add(sample);
  step_health();
}

void GnssInsLocalizer::add(const GnssFix& fix) {
  static_cast<void>(odometry_.add(fix));
  step_health();
}

void GnssInsLocalizer::add(const MagneticHeading& heading) {
  static_cast<void>(odometry_.add(heading));
  step_health();
}

void GnssInsLocalizer::step_health() {
  const std::optional<Estimate> estimate = odometry_.estimate();
  if (!estimate) {
    state_ = State::initializing;
    return;
  }
  const GnssFilter& filter = odometry_.filter();
  const auto last = filter.last_position_accepted();
  const double age_s = last ? to_seconds(odometry_.now() - *last) : health_.lost_after_s + 1.0;
  const double silent_s = to_seconds(odometry_.now() - estimate->time);
  const double sigma_m = sigma_horizontal_m(*estimate);
  const double sigma_rad = sigma_yaw_rad(*estimate);
  const int in_row = filter.positions_in_row();

  // Written so that NaN is not small.
  const bool known = sigma_m <= health_.lost_sigma_m && sigma_rad <= health_.lost_sigma_yaw_rad &&
                     age_s <= health_.lost_after_s && silent_s <= health_.imu_silent_s;
  const bool well_known = known && sigma_m <= health_.tracking_sigma_m &&
                          sigma_rad <= health_.tracking_sigma_yaw_rad &&
                          age_s <= health_.degraded_after_s;
  const bool may_begin = known && in_row >= health_.confirm_fixes;
  switch (state_) {
    case State::initializing:
    case State::lost:
      if (may_begin) state_ = well_known ? State::tracking : State::degraded;
      return;
    case State::tracking:
    case State::degraded:
      if (!known) {
        state_ = State::lost;
      } else if (!well_known) {
        state_ = State::degraded;
      } else if (in_row >= health_.recover_fixes) {
        state_ = State::tracking;
      }
      return;
  }
}

std::optional<Estimate> GnssInsLocalizer::estimate() const {
  std::optional<Estimate> estimate = odometry_.estimate();
  if (estimate) estimate->state = state_;
  return estimate;
}

}  // namespace locsim::localization
