#include "localization/gnss_ins/gnss_odometry.h"

#include <algorithm>
#include <cmath>

namespace locsim::localization {

namespace {

/// Between beliefs that are kept: what a late message costs beyond its age.
constexpr Duration kMemoryInterval = std::chrono::milliseconds(100);
constexpr Duration kGapMax = std::chrono::seconds(10);
constexpr Duration kFixFresh = std::chrono::milliseconds(1500);
constexpr double kRestSpeed_m_s = 0.3;
/// Of the gyro's bias after a rest [rad/s].
constexpr double kRestBiasSigma_rad_s = 1e-3;

/// In order of time, and of kind where times are the same, so that order of arrival is nothing.
bool comes_before(const GnssAid& a, const GnssAid& b) {
  return time_of(a) != time_of(b) ? time_of(a) < time_of(b) : a.index() < b.index();
}

const GnssOdometryConfig& checked(const GnssOdometryConfig& config) {
  check_parameters(config, "gnss_ins");
  return config;
}

}  // namespace

GnssOdometry::GnssOdometry(const Rig& rig, const GeodeticPoint& map_origin,
                           const GnssOdometryConfig& config)
    : rig_(rig),
      frame_(map_origin),
      config_(checked(config)),
      late_max_(duration_from_seconds(config.late_max_s)),
      guess_(rig, map_origin) {}

void GnssOdometry::add(const ImuSample& sample) {
  if (!is_usable(sample)) return;
  if (newest_sample_ && sample.time <= *newest_sample_) {
    if (++behind_in_row_ >= rig_.imu_rate_hz) restart();
    return;
  }
  behind_in_row_ = 0;
  if (newest_sample_ && sample.time - *newest_sample_ > kGapMax) restart();
  newest_sample_ = sample.time;
  now_ = std::max(now_, sample.time);
  guess_.add(sample);
  if (!filter_) {
    watch_rest(sample);
    align();
    return;
  }
  samples_.push_back(sample);
  step(sample);
  if (filter_->hopeless()) {
    restart();
    return;
  }
  forget_old();
}

void GnssOdometry::step(const ImuSample& sample) {
  filter_->advance(sample, aids_between(filter_->inertial().state().time, sample.time));
  if (sample.time - memories_.back().belief.state.time >= kMemoryInterval) {
    memories_.push_back(filter_->memory());
  }
}

std::vector<GnssAid> GnssOdometry::aids_between(Stamp from, Stamp to) const {
  const auto first = std::ranges::upper_bound(aids_, from, {}, time_of);
  const auto last = std::ranges::upper_bound(aids_, to, {}, time_of);
  return {first, last};
}

AidStatus GnssOdometry::add(const GnssFix& fix) {
  if (!is_usable(fix)) return AidStatus::unusable;
  GnssFix by_imu = fix;
  by_imu.time += duration_from_seconds(config_.gnss_time_offset_s);
  const GnssVelocity velocity{
      .time = by_imu.time - duration_from_seconds(config_.gnss.velocity_delay_s),
      .velocity_enu_m_s = fix.velocity_enu_m_s,
      .covariance_m2_s2 = fix.velocity_covariance_m2_s2};
  const AidStatus status = take(by_imu, velocity);
  if (status != AidStatus::taken || filter_) return status;
  guess_.add(by_imu);
  if (!last_fix_ || by_imu.time > last_fix_->time) last_fix_ = by_imu;
  align();
  return status;
}

AidStatus GnssOdometry::add(const MagneticHeading& heading) {
  if (!config_.magnetic_heading || !std::isfinite(heading.yaw_rad) ||
      !std::isfinite(heading.sigma_rad) || heading.sigma_rad < 0.0) {
    return AidStatus::unusable;
  }
  const AidStatus status = take(heading);
  if (status != AidStatus::taken || filter_) return status;
  guess_.add(heading);
  align();
  return status;
}

AidStatus GnssOdometry::take(const GnssAid& aid, const std::optional<GnssVelocity>& earlier) {
  const Stamp time = time_of(aid);
  // A wrong time must not wait for its day.
  if (newest_sample_ && time > *newest_sample_ + late_max_) return AidStatus::too_new;
  if (!filter_) {
    if (newest_sample_ && time < *newest_sample_ - late_max_) return AidStatus::too_old;
    now_ = newest_sample_ ? std::max(now_, time) : now_;
    return AidStatus::taken;
  }
  const Stamp reached = filter_->inertial().state().time;
  const auto place = std::ranges::lower_bound(aids_, aid, comes_before);
  if (place != aids_.end() && time_of(*place) == time && place->index() == aid.index()) {
    return AidStatus::duplicate;
  }
  if (time <= memories_.front().belief.state.time) return AidStatus::too_old;
  now_ = std::max(now_, time);
  aids_.insert(place, aid);
  Stamp from = time;
  if (earlier && earlier->time > memories_.front().belief.state.time) {
    aids_.insert(std::ranges::lower_bound(aids_, GnssAid(*earlier), comes_before), *earlier);
    from = earlier->time;
  }
  if (from > reached) return AidStatus::taken;

  while (memories_.back().belief.state.time >= from) memories_.pop_back();
  filter_->restore(memories_.back());
  const auto since =
      std::ranges::upper_bound(samples_, memories_.back().belief.state.time, {}, &ImuSample::time);
  for (auto sample = since; sample != samples_.end() && !filter_->hopeless(); ++sample) {
    step(*sample);
  }
  if (filter_->hopeless()) restart();
  return AidStatus::taken;
}

void GnssOdometry::forget_old() {
  // The oldest belief must be from before the oldest message that may still come.
  const Stamp keep = *newest_sample_ - late_max_;
  while (memories_.size() > 1 && memories_[1].belief.state.time < keep) memories_.pop_front();
  const Stamp oldest = memories_.front().belief.state.time;
  while (!samples_.empty() && samples_.front().time <= oldest) samples_.pop_front();
  while (!aids_.empty() && time_of(aids_.front()) <= oldest) aids_.pop_front();
}

void GnssOdometry::watch_rest(const ImuSample& sample) {
  rest_window_.add(sample);
  if (to_seconds(sample.time - rest_window_.start) < config_.standstill.window_s) return;
  const bool stands = last_fix_ && sample.time - last_fix_->time < kFixFresh &&
                      last_fix_->velocity_enu_m_s.norm() < kRestSpeed_m_s;
  if (stands && rest_window_.is_still(config_.standstill)) {
    rest_rate_rad_s_ = rest_window_.mean_rate_rad_s();
  }
  rest_window_ = {};
}

void GnssOdometry::align() {
  std::optional<Guess> guess = guess_.make();
  if (!guess) return;
  if (rest_rate_rad_s_) {
    guess->state.gyro_bias_rad_s = *rest_rate_rad_s_;
    guess->sigmas.gyro_bias_rad_s = kRestBiasSigma_rad_s;
  } else if (guess->state.gyro_bias_rad_s.isZero()) {
    guess->sigmas.gyro_bias_rad_s = config_.start_gyro_bias_sigma_rad_s;
  }
  guess->sigmas.accel_bias_m_s2 = config_.start_accel_bias_sigma_m_s2;
  filter_.emplace(rig_, frame_, config_, *guess);
  memories_.push_back(filter_->memory());
}

void GnssOdometry::restart() {
  filter_.reset();
  guess_ = InitialGuess(rig_, frame_.origin());
  newest_sample_.reset();
  behind_in_row_ = 0;
  rest_window_ = {};
  last_fix_.reset();
  now_ = {};
  samples_.clear();
  aids_.clear();
  memories_.clear();
  ++restarts_;
}

std::optional<Estimate> GnssOdometry::estimate() const {
  if (!filter_) return std::nullopt;
  Estimate estimate = filter_->inertial().vehicle_estimate();
  const Matrix3d R = estimate.T_map_vehicle.rotation.toRotationMatrix();
  estimate.covariance.topLeftCorner<3, 3>() += config_.gnss.common_share *
                                               config_.gnss.common_share * R.transpose() *
                                               filter_->position_covariance_m2() * R;
  return estimate;
}

}  // namespace locsim::localization
