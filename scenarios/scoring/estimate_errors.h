#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/pose.h"
#include "core/time.h"
#include "scenarios/scoring/score_input.h"

namespace locsim::scenarios {

/// Where the car was, and how far it had driven, at any time of the drive.
class TruthTrack {
 public:
  /// Keeps the spans. Distances are sums of straight lines between samples, all three axes; where
  /// an event set the car down elsewhere between two samples, their mean speed times the time.
  TruthTrack(std::span<const TruthSample> truth, std::span<const ScoreEvent> events);

  struct Place {
    Pose T_map_vehicle;
    double distance_m = 0.0;
  };
  /// Between samples: linear, rotation by slerp. Where the car was set down elsewhere between them,
  /// straight on from the sample on the same side. Clamped to the drive.
  [[nodiscard]] Place at(Stamp time) const;
  /// When the car was set down elsewhere in (`after`, `until`], the last time.
  [[nodiscard]] std::optional<Stamp> set_down_within(Stamp after, Stamp until) const;
  /// Of the whole drive, horizontally; otherwise as the distances.
  [[nodiscard]] double driven_m() const { return driven_m_; }
  [[nodiscard]] bool covers(Stamp time) const;
  [[nodiscard]] bool empty() const { return truth_.empty(); }
  [[nodiscard]] Stamp start() const { return truth_.front().time; }
  [[nodiscard]] Stamp end() const { return truth_.back().time; }

 private:
  std::span<const TruthSample> truth_;
  std::span<const ScoreEvent> events_;
  std::vector<double> distance_m_;
  double driven_m_ = 0.0;
};

/// One estimate against truth at its time. Errors of a pose that is not finite are infinite.
struct ErrorSample {
  Stamp time;
  /// How long the estimate stands.
  Duration stands{};
  /// Driven by then.
  double distance_m = 0.0;
  localization::State state = localization::State::initializing;
  Pose T_map_true;
  Pose T_map_estimated;
  Matrix6d covariance = Matrix6d::Zero();
  /// Estimated minus true, map frame.
  Vector3d position_error_m = Vector3d::Zero();
  /// Angle between the two rotations, in [0, π].
  double rotation_error_rad = 0.0;
  double yaw_error_rad = 0.0;

  [[nodiscard]] double error_m() const { return position_error_m.norm(); }
  [[nodiscard]] bool tracking() const { return state == localization::State::tracking; }
};

/// All estimates of a drive against truth.
class EstimateErrors {
 public:
  /// Keeps the input's spans.
  explicit EstimateErrors(const ScoreInput& input);

  [[nodiscard]] const TruthTrack& track() const { return track_; }
  [[nodiscard]] Duration drive_time() const;
  /// Every estimate within the drive.
  [[nodiscard]] std::span<const ErrorSample> all() const { return samples_; }
  /// From the first one whose state is not `initializing` on: what the localizer answers for. If
  /// it falls back to `initializing` later, that still counts.
  [[nodiscard]] std::span<const ErrorSample> claimed() const;
  /// The last estimate that still stands at `time`; null where there is none.
  [[nodiscard]] const ErrorSample* at(Stamp time) const;

 private:
  TruthTrack track_;
  std::vector<ErrorSample> samples_;
  std::size_t first_claimed_ = 0;
};

}  // namespace locsim::scenarios
