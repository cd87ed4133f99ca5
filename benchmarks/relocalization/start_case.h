#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "benchmarks/relocalization/start_town.h"
#include "localization/dynamic_icp/dynamic_icp.h"

namespace locsim::relocalization {

/// What the receiver claims for each axis, over the length of its error.
inline constexpr double kClaimedShare = 0.5;

/// What is known before the search.
struct Start {
  double gnss_error_m = 0.0;
  /// Claimed, of each axis.
  double sigma_m = 0.0;
  bool is_heading_known = false;
  /// Horizontal, map frame.
  Eigen::Vector2d offset_m = Eigen::Vector2d::Zero();
  double yaw_error_rad = 0.0;
  /// Of roll, pitch [rad] and height [m].
  Vector3d level_error = Vector3d::Zero();

  /// What GNSS and gravity say where the vehicle is at `truth`.
  [[nodiscard]] localization::GnssGuess guess(const Pose& truth) const;
};

/// The start for place `index`: GNSS off by that length in any direction; the heading within 10°
/// (sigma 5°), or unknown and drawn from all; roll and pitch 0.3° and height 5 m off (1 sigma).
[[nodiscard]] Start draw_start(std::uint64_t seed, std::uint64_t index, double gnss_error_m,
                               bool is_heading_known);

struct Error {
  double distance_m = 0.0;
  double angle_rad = 0.0;
};

[[nodiscard]] Error error_of(const Pose& estimate, const Pose& truth);

/// `fixed`: said to be found and within 0.5 m and 2°; `false_fix`: said to be found and beyond 2 m
/// or 5°; `loose`: said to be found, between the two.
enum class Outcome : std::uint8_t { fixed, loose, false_fix, abstained };

[[nodiscard]] Outcome judge(bool is_found, const Error& error);
[[nodiscard]] const char* name_of(Outcome outcome);

/// Of one method from one start.
struct Try {
  Outcome outcome = Outcome::abstained;
  /// Of the processor for one thread, of the wall for more.
  double seconds = 0.0;
  Error error;
};

/// While the car drives on.
inline constexpr double kNextScan_s = 0.5;
inline constexpr double kDriveSpeed_m_s = 10.0;
inline constexpr int kScansMax = 10;

/// Of Algorithm 1's relocalization: the first scan, and on until there is a fix.
struct DynamicTry {
  Try first;
  localization::DynamicIcpResult result;
  /// Of the last scan tried.
  Outcome final = Outcome::abstained;
  int scans = 1;

  /// From the first scan to the last.
  [[nodiscard]] double drive_s() const { return kNextScan_s * (scans - 1); }
};

/// Tries the scan with `icp`, begun anew, in `threads` threads; where it abstains, those that
/// follow every 0.5 s at 10 m/s, `scans_max` in all, with the same error of GNSS.
[[nodiscard]] DynamicTry try_dynamic(localization::DynamicIcp& icp, const StartTown& town,
                                     const Berth& berth, std::span<const Vector3f> points,
                                     const Start& start, int threads, int scans_max);

}  // namespace locsim::relocalization
