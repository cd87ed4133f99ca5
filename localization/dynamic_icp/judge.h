#pragma once

#include <optional>

#include "core/geodesy.h"
#include "localization/dynamic_icp/registration.h"
#include "localization/localizer.h"

namespace locsim::localization {

struct JudgeConfig {
  /// A point's rms distance to the surfaces that it meets.
  double residual_max_m = 0.15;
  double overlap_min = 0.6;
  int inliers_min = 100;
  /// The overlap may fall by so much from that of the last scans (each half of what was before): a
  /// scan that is half of another place still overlaps. What lasts becomes usual.
  double overlap_drop_max = 0.15;
  /// Disagreement with the IMU: d² of registration and prediction, six degrees of freedom; 22.46 is
  /// χ² at 99.9 %. Beside both covariances these sigmas, for what they do not know.
  double imu_gate = 22.46;
  double imu_sigma_m = 0.05;
  double imu_sigma_rad = 0.003;
  /// … and these for each second without a good registration: scale errors of an IMU, which its
  /// noise densities do not tell.
  double imu_drift_m_s = 0.1;
  double imu_drift_rad_s = 0.002;
  /// Disagreement with GNSS: d² of the horizontal position, two degrees of freedom, with claimed
  /// sigmas times `gnss_scale` and a floor. 18.42 is χ² at 99.99 %.
  double gnss_gate = 18.42;
  double gnss_scale = 2.0;
  double gnss_floor_m = 2.0;
  /// So many fixes that disagree, net of those that agree, call for a look around
  /// (`Judge::doubts`).
  int gnss_fixes = 5;
  /// After a look around that found nothing better, GNSS is not heard for so long.
  double acquitted_s = 10.0;

  /// Registrations in a row: bad ones that end tracking, and make lost; good ones that make a pose
  /// found by a search trusted, and one in trouble again.
  int degraded_scans = 1;
  int lost_scans = 5;
  int confirm_scans = 5;
  int recover_scans = 3;
  /// Without any good one for so long: degraded.
  double degraded_after_s = 0.3;
  /// Horizontal standard deviation that makes degraded, and lost.
  double degraded_sigma_m = 0.5;
  double lost_sigma_m = 3.0;

  void describe(Parameters& p);
};

/// Why a registration is not believed.
struct Verdict {
  bool converged = false;
  bool overlaps = false;
  /// … nearly as much as the scans before.
  bool overlaps_as_usual = false;
  bool fits = false;
  bool agrees_with_imu = false;
  /// Of registration against prediction.
  double imu_d2 = 0.0;

  [[nodiscard]] bool good() const {
    return converged && overlaps && overlaps_as_usual && fits && agrees_with_imu;
  }
};

/// Is this registration wrong? Votes of what does not depend on each other: the share of the scan
/// that lies on the map, how well, whether the IMU had it there, whether GNSS has it there; and
/// what may be said of the pose after it, with hysteresis. Degenerate directions have no vote:
/// their variance in the registration's covariance is that of not knowing, and what follows from
/// it decides (`degraded_sigma_m`, `lost_sigma_m`).
class Judge {
 public:
  explicit Judge(const JudgeConfig& config) : config_(config) {}

  /// A registration beside the prediction that it began from, whose covariance is a right
  /// perturbation, `silent_s` after the last good one. Remembers the overlap.
  [[nodiscard]] Verdict examine(const Alignment& alignment, const Pose& prediction,
                                const Matrix6d& prediction_covariance, double silent_s = 0.0);

  /// A search has found a pose; it is not trusted yet.
  void on_found(Stamp time);
  void on_registration(bool good, Stamp time);
  /// A fix of an antenna that by the pose is at `antenna_in_map_m`, with the pose's horizontal
  /// covariance in the map frame. Height is not looked at: receivers err there most.
  void on_fix(const Vector3d& fix_in_map_m, const Matrix3d& fix_covariance_m2,
              const Vector3d& antenna_in_map_m, const Eigen::Matrix2d& covariance_m2, Stamp time);
  /// GNSS insists on another place: the scan should be looked for there. Until `acquit`, or until
  /// GNSS agrees again, the state is not `tracking`.
  [[nodiscard]] bool doubts() const { return doubts_; }
  /// Nothing better was found where GNSS has it.
  void acquit(Stamp time);
  /// Something better was: what was believed is lost.
  void convict();

  /// Moves the state on; true at the moment it becomes lost.
  bool step(Stamp now, double sigma_horizontal_m);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] Stamp last_good() const { return last_good_; }
  /// True until a search has found a pose, and again once that is lost.
  [[nodiscard]] bool needs_search() const { return !found_; }

 private:
  JudgeConfig config_;
  State state_ = State::initializing;
  bool found_ = false;
  bool doubts_ = false;
  int good_in_row_ = 0;
  int bad_in_row_ = 0;
  int fixes_off_ = 0;
  std::optional<double> usual_overlap_;
  Stamp last_good_;
  std::optional<Stamp> acquitted_;
};

}  // namespace locsim::localization
