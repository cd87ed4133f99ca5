#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/messages.h"

namespace locsim::fidelity {

/// Which returns of a clear scan are still there in bad weather, by the rays that made them.
struct WeatherMatch {
  struct Kept {
    std::size_t clear = 0;
    std::size_t weather = 0;
  };
  /// Indices of points of both scans, in firing order.
  std::vector<Kept> kept;
  /// Points of the clear scan whose ray ends elsewhere or nowhere.
  std::vector<std::size_t> lost;
  /// Points of the scan in bad weather that are no return of the clear one.
  std::vector<std::size_t> gained;
  /// Of the lost: those whose ray ends in something gained; the rays of the others end nowhere.
  std::size_t replaced = 0;
};

/// Both scans start at one time in one place; a ray is told by its firing time, ring and sensor,
/// and rays are in firing order. A return is kept when it lies within `tolerance_m` of the clear
/// one.
[[nodiscard]] WeatherMatch match_returns(const LidarScan& clear, const LidarScan& weather,
                                         double tolerance_m);

/// What a return comes from; `none`: no surface is first met there.
enum class Target { ground, wall, other, none };

/// A scan and, for each of its points, what it comes from.
struct SeenScan {
  const LidarScan& scan;
  std::span<const Target> targets;
};

/// How far targets of one kind are seen; zeros for none.
struct Reach {
  std::size_t kept = 0;
  double farthest_m = 0.0;
  /// Quantile 0.95 of the ranges.
  double p95_m = 0.0;
};

/// One scan beside the clear one.
struct WeatherFigures {
  static constexpr std::size_t kBands = 4;
  /// Where bands of range end; the last has no end.
  static constexpr std::array<double, kBands - 1> kBandEnds_m = {2.0, 5.0, 10.0};

  std::size_t returns = 0;
  std::size_t kept = 0;
  std::size_t lost = 0;
  std::size_t replaced = 0;
  /// Gained from surfaces that are there: panes, where clear air lets what lies behind them win.
  std::size_t other_surfaces = 0;
  /// Gained from the air, by range.
  std::array<std::size_t, kBands> false_by_range{};
  Reach ground;
  Reach walls;
  /// Means over kept returns below full scale in clear air: what is left of the intensity, and what
  /// e^(−2αR) leaves; 0 for none.
  double intensity_ratio = 0.0;
  double expected_ratio = 0.0;

  /// Of the clear scan's returns.
  [[nodiscard]] double lost_share() const;
  [[nodiscard]] std::size_t false_returns() const;
};

/// `extinction_1_m` is the weather's, one way.
[[nodiscard]] WeatherFigures weather_figures(const SeenScan& clear, const SeenScan& weather,
                                             const WeatherMatch& match, double extinction_1_m);

}  // namespace locsim::fidelity
