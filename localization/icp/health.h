#pragma once

#include "core/parameters.h"
#include "localization/localizer.h"

namespace locsim::localization {

struct HealthConfig {
  /// A registration is good with at least this share and number of points on the map…
  double overlap_min = 0.6;
  int inliers_min = 100;
  /// … no more than this rms distance of theirs.
  double residual_max_m = 0.25;
  /// Good registrations in a row that make a pose trusted after a search, and again after trouble.
  int confirm_scans = 5;
  int recover_scans = 3;
  /// Without a good registration for this long, or with so many bad ones in a row: degraded.
  double degraded_after_s = 0.3;
  int degraded_scans = 3;
  /// Bad registrations in a row, or a horizontal standard deviation: lost.
  int lost_scans = 10;
  double lost_sigma_m = 1.0;

  void describe(Parameters& p);
};

/// Decides what the localizer may say of itself.
class Health {
 public:
  explicit Health(const HealthConfig& config) : config_(config) {}

  [[nodiscard]] State state() const { return state_; }
  /// True until a search has found a pose, and again once that is lost.
  [[nodiscard]] bool needs_search() const { return !found_; }
  [[nodiscard]] bool has_recent_registration(Stamp now) const;

  void on_found(Stamp time);
  void on_registration(bool good, Stamp time);
  /// Moves the state on; true at the moment it becomes lost.
  bool step(Stamp now, double sigma_horizontal_m);

 private:
  HealthConfig config_;
  State state_ = State::initializing;
  bool found_ = false;
  int good_in_row_ = 0;
  int bad_in_row_ = 0;
  Stamp last_good_;
};

}  // namespace locsim::localization
