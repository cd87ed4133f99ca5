#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geodesy.h"
#include "localization/localizer.h"
#include "scenarios/replay_log.h"
#include "scenarios/replay_windows.h"

namespace locsim::scenarios {

/// Of many values, by magnitude. What is missing counts as larger than everything: no figure comes
/// from the values that happen to be there.
struct ErrorSummary {
  std::size_t count = 0;
  std::size_t missing = 0;
  /// With their signs.
  std::optional<double> mean;
  std::optional<double> rms;
  std::optional<double> median;
  std::optional<double> p95;
  std::optional<double> worst;
};
/// The share p is the smallest value that at least the share p of all values does not exceed.
[[nodiscard]] ErrorSummary summarize(std::span<const std::optional<double>> values);

/// What a localizer said during one replay, at any time of it.
class EstimateTrack {
 public:
  /// Keeps the span; times ascend.
  explicit EstimateTrack(std::span<const localization::Estimate> estimates)
      : estimates_(estimates) {}

  /// Between the last estimate before `time` and the next one: as nobody knew of a fix at `time`.
  /// Nothing where they are more than 0.2 s apart, or where either is initializing, not finite or,
  /// unless `lost_too`, lost.
  [[nodiscard]] std::optional<localization::Estimate> before_fix(Stamp time,
                                                                 bool lost_too = false) const;
  /// At `time`, from the first two estimates after it: as a fix at `time` left it.
  [[nodiscard]] std::optional<localization::Estimate> after_fix(Stamp time) const;
  /// Of the first estimate that claims anything.
  [[nodiscard]] std::optional<Stamp> first_claim() const;

 private:
  [[nodiscard]] std::optional<localization::Estimate> from_pair(std::size_t first, Stamp time,
                                                                bool lost_too) const;

  std::span<const localization::Estimate> estimates_;
};

/// What a drive is scored against: the fixes, in a map frame.
struct ReplayTruth {
  const GnssLog& gnss;
  LocalFrame frame;
  Vector3d antenna_in_vehicle_m = Vector3d::Zero();
  /// The heading is scored against the course of fixes faster than this.
  double heading_speed_m_s = 5.0;

  /// Position of the estimate's antenna less the fix's, map frame [m].
  [[nodiscard]] Vector3d position_error_m(const localization::Estimate& estimate,
                                          const GnssFix& fix) const;
  /// Yaw less the course of the fix, at the time that the course is true of, in (−180, 180] [deg];
  /// nothing without an estimate. Includes what the car truly slips at the antenna.
  [[nodiscard]] std::optional<double> heading_error_deg(const EstimateTrack& track,
                                                        const GnssFix& fix,
                                                        bool lost_too = false) const;
  [[nodiscard]] bool has_course(const GnssLog::Entry& entry) const;
};

/// A window without fixes.
struct WindowScore {
  WithheldWindow window;
  double distance_m = 0.0;
  /// How far the horizontal error of the antenna moved since the window's begin, as a vector: at
  /// its end, and the most of all withheld fixes. Nothing where any estimate is missing; one that
  /// calls itself lost counts, as it is where the localizer would go on from.
  std::optional<double> drift_m;
  std::optional<double> drift_max_m;
  /// Of the distance.
  std::optional<double> drift_percent;
  /// Horizontal error at the end over the sigma that the localizer claims for it, √(σx² + σy²).
  std::optional<double> error_over_sigma;
  /// Of withheld fixes above the least speed; empty where the car was slower all along.
  std::vector<std::optional<double>> heading_errors_deg;
  /// Since the begin [s], and the drift by then [m]; ends where an estimate is missing.
  struct Point {
    double after_s = 0.0;
    double drift_m = 0.0;
  };
  std::vector<Point> course_of_drift;
  /// At the end; nothing where there is no estimate at all.
  std::optional<localization::State> state;
};
[[nodiscard]] WindowScore score_window(const ReplayTruth& truth, const EstimateTrack& track,
                                       const WithheldWindow& window);

/// Windows of one length together.
struct WindowSetScore {
  double length_s = 0.0;
  std::size_t passes = 0;
  std::vector<WindowScore> windows;
  /// Windows at whose end the localizer called itself lost.
  std::size_t lost = 0;
  ErrorSummary drift_m;
  ErrorSummary drift_max_m;
  ErrorSummary drift_percent;
  ErrorSummary error_over_sigma;
  /// Of all fixes in all windows, and of all fixes that were given to the localizer.
  ErrorSummary heading_inside_deg;
  ErrorSummary heading_outside_deg;

  [[nodiscard]] bool all_scored() const { return drift_m.missing == 0 && !windows.empty(); }
};
/// `outside` are heading errors of fixes outside of the windows.
[[nodiscard]] WindowSetScore summarize_windows(double length_s, std::size_t passes,
                                               std::vector<WindowScore> windows,
                                               std::span<const std::optional<double>> outside);

/// Heading errors at the fixes that are `given`, from the localizer's first claim on; all of them
/// missing where it claims nothing.
[[nodiscard]] std::vector<std::optional<double>> heading_errors_deg(const ReplayTruth& truth,
                                                                    const EstimateTrack& track,
                                                                    const std::vector<bool>& given);

/// A whole drive, scored at the fixes that were held out.
struct HeldOutScore {
  /// From the first IMU sample to the first claim [s].
  std::optional<double> first_claim_s;
  ErrorSummary horizontal_m;
  ErrorSummary vertical_m;
  ErrorSummary error_over_sigma;
  ErrorSummary heading_deg;
};
/// Scores at the fixes that are not `given`, from the localizer's first claim on.
[[nodiscard]] HeldOutScore score_held_out(const ReplayTruth& truth, const EstimateTrack& track,
                                          const std::vector<bool>& given, Stamp start);

}  // namespace locsim::scenarios
