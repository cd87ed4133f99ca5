#include "localization/dynamic_icp/judge.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace locsim::localization {

void JudgeConfig::describe(Parameters& p) {
  p.number("residual_max_m", residual_max_m, kPositive);
  p.number("overlap_min", overlap_min, kShare);
  p.integer("inliers_min", inliers_min, {1, 100000});
  p.number("overlap_drop_max", overlap_drop_max, kShare);
  p.number("imu_gate", imu_gate, kPositive);
  p.number("imu_sigma_m", imu_sigma_m, {0.0, 10.0});
  p.degrees("imu_sigma_deg", imu_sigma_rad, {0.0, 45.0});
  p.number("imu_drift_m_s", imu_drift_m_s, {0.0, 100.0});
  p.degrees("imu_drift_deg_s", imu_drift_rad_s, {0.0, 45.0});
  p.number("gnss_gate", gnss_gate, kPositive);
  p.number("gnss_scale", gnss_scale, {0.1, 100.0});
  p.number("gnss_floor_m", gnss_floor_m, {0.01, 100.0});
  p.integer("gnss_fixes", gnss_fixes, {1, 10000});
  p.number("acquitted_s", acquitted_s, kNotNegative);
  p.integer("degraded_scans", degraded_scans, {1, 10000});
  p.integer("lost_scans", lost_scans, {1, 10000});
  p.integer("confirm_scans", confirm_scans, {1, 10000});
  p.integer("recover_scans", recover_scans, {1, 10000});
  p.number("degraded_after_s", degraded_after_s, kPositive);
  p.number("degraded_sigma_m", degraded_sigma_m, kPositive);
  p.number("lost_sigma_m", lost_sigma_m, kPositive);
}

Verdict Judge::examine(const Alignment& alignment, const Pose& prediction,
                       const Matrix6d& prediction_covariance, double silent_s) {
  Verdict verdict;
  verdict.converged = alignment.status == AlignmentStatus::converged;
  verdict.overlaps =
      alignment.overlap >= config_.overlap_min && alignment.inliers >= config_.inliers_min;
  verdict.overlaps_as_usual =
      !usual_overlap_ || alignment.overlap >= *usual_overlap_ - config_.overlap_drop_max;
  usual_overlap_ = usual_overlap_ ? 0.5 * (*usual_overlap_ + alignment.overlap) : alignment.overlap;
  // Written so that NaN does not fit.
  verdict.fits = alignment.residual_m <= config_.residual_max_m;

  const Vector6d off = se3::log(prediction.inverse() * alignment.T_map_vehicle);
  Matrix6d S = prediction_covariance + alignment.covariance;
  const double sigma_m = config_.imu_sigma_m + config_.imu_drift_m_s * silent_s;
  const double sigma_rad = config_.imu_sigma_rad + config_.imu_drift_rad_s * silent_s;
  S.diagonal().head<3>().array() += sigma_m * sigma_m;
  S.diagonal().tail<3>().array() += sigma_rad * sigma_rad;
  // LLT, not LDLT, which takes a pivot that is not a number for one of zero.
  const Eigen::LLT<Matrix6d> factor(S);
  verdict.imu_d2 = off.dot(factor.solve(off));
  verdict.agrees_with_imu = factor.info() == Eigen::Success && verdict.imu_d2 <= config_.imu_gate;
  return verdict;
}

void Judge::on_found(Stamp time) {
  usual_overlap_.reset();
  found_ = true;
  good_in_row_ = 1;
  bad_in_row_ = 0;
  fixes_off_ = 0;
  doubts_ = false;
  last_good_ = time;
}

void Judge::on_registration(bool good, Stamp time) {
  if (good) {
    ++good_in_row_;
    bad_in_row_ = 0;
    last_good_ = time;
  } else {
    good_in_row_ = 0;
    ++bad_in_row_;
  }
}

void Judge::on_fix(const Vector3d& fix_in_map_m, const Matrix3d& fix_covariance_m2,
                   const Vector3d& antenna_in_map_m, const Eigen::Matrix2d& covariance_m2,
                   Stamp time) {
  if (!found_) return;
  const Eigen::Vector2d off = (fix_in_map_m - antenna_in_map_m).head<2>();
  Eigen::Matrix2d S =
      config_.gnss_scale * config_.gnss_scale * fix_covariance_m2.topLeftCorner<2, 2>() +
      covariance_m2;
  S.diagonal().array() += config_.gnss_floor_m * config_.gnss_floor_m;
  const Eigen::LLT<Eigen::Matrix2d> factor(S);
  if (factor.info() != Eigen::Success) return;
  const bool agrees = off.dot(factor.solve(off)) <= config_.gnss_gate;
  fixes_off_ = std::clamp(fixes_off_ + (agrees ? -1 : 1), 0, config_.gnss_fixes);
  if (fixes_off_ == 0) doubts_ = false;
  const bool deaf = acquitted_ && to_seconds(time - *acquitted_) < config_.acquitted_s;
  if (fixes_off_ == config_.gnss_fixes && !deaf) doubts_ = true;
}

void Judge::acquit(Stamp time) {
  doubts_ = false;
  fixes_off_ = 0;
  acquitted_ = time;
}

void Judge::convict() {
  found_ = false;
  doubts_ = false;
  fixes_off_ = 0;
  state_ = State::lost;
}

bool Judge::step(Stamp now, double sigma_horizontal_m) {
  // Written so that NaN is not small.
  const bool known = sigma_horizontal_m <= config_.lost_sigma_m;
  const bool well_known = sigma_horizontal_m <= config_.degraded_sigma_m && !doubts_;
  const bool in_touch = to_seconds(now - last_good_) <= config_.degraded_after_s &&
                        bad_in_row_ < config_.degraded_scans;
  if (!found_) return false;
  switch (state_) {
    case State::initializing:
    case State::lost:
      // What a search found has to stand the test of the scans after it.
      if (bad_in_row_ >= config_.degraded_scans || !known) {
        found_ = false;
      } else if (good_in_row_ >= config_.confirm_scans && well_known && in_touch) {
        state_ = State::tracking;
      }
      return false;
    case State::tracking:
    case State::degraded:
      if (bad_in_row_ >= config_.lost_scans || !known) {
        state_ = State::lost;
        found_ = false;
        return true;
      }
      if (!in_touch || !well_known) {
        // The good ones from before the trouble do not speak for what comes after it.
        if (state_ == State::tracking) good_in_row_ = 0;
        state_ = State::degraded;
      } else if (good_in_row_ >= config_.recover_scans) {
        state_ = State::tracking;
      }
      return false;
  }
  return false;
}

}  // namespace locsim::localization
