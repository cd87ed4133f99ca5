#include "localization/icp/health.h"

namespace locsim::localization {

void HealthConfig::describe(Parameters& p) {
  p.number("overlap_min", overlap_min, kShare);
  p.integer("inliers_min", inliers_min, {10, 100000});
  p.number("residual_max_m", residual_max_m, kPositive);
  p.integer("confirm_scans", confirm_scans, {1, 1000});
  p.integer("recover_scans", recover_scans, {1, 1000});
  p.number("degraded_after_s", degraded_after_s, kPositive);
  p.integer("degraded_scans", degraded_scans, {1, 1000});
  p.integer("lost_scans", lost_scans, {1, 1000});
  p.number("lost_sigma_m", lost_sigma_m, kPositive);
}

bool Health::has_recent_registration(Stamp now) const {
  return found_ && now - last_good_ <= duration_from_seconds(config_.degraded_after_s);
}

void Health::on_found(Stamp time) {
  found_ = true;
  good_in_row_ = 0;
  bad_in_row_ = 0;
  last_good_ = time;
}

void Health::on_registration(bool good, Stamp time) {
  good_in_row_ = good ? good_in_row_ + 1 : 0;
  bad_in_row_ = good ? 0 : bad_in_row_ + 1;
  if (good) last_good_ = time;
}

bool Health::step(Stamp now, double sigma_horizontal_m) {
  const bool recent = has_recent_registration(now);
  // Written so that NaN is not small.
  const bool small = sigma_horizontal_m <= config_.lost_sigma_m;
  switch (state_) {
    case State::initializing:
    case State::lost:
      if (found_ && (bad_in_row_ >= config_.degraded_scans || !recent)) found_ = false;
      if (found_ && small && good_in_row_ >= config_.confirm_scans) state_ = State::tracking;
      return false;
    case State::tracking:
      if (!recent || bad_in_row_ >= config_.degraded_scans) state_ = State::degraded;
      break;
    case State::degraded:
      if (recent && good_in_row_ >= config_.recover_scans) state_ = State::tracking;
      break;
  }
  if (small && bad_in_row_ < config_.lost_scans) return false;
  state_ = State::lost;
  found_ = false;
  return true;
}

}  // namespace locsim::localization
