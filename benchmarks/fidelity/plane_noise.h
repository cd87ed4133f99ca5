#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "benchmarks/fidelity/scan_statistics.h"

namespace locsim::fidelity {

/// How far one return lies from where its neighbours put it, along its beam.
struct Residual {
  /// Positive: measured too far. Scaled so that its variance is that of one range: what the
  /// neighbours' own noise adds is taken out.
  float residual_m = 0.0F;
  float range_m = 0.0F;
  float cos_incidence = 1.0F;
  float intensity = 0.0F;
  std::uint8_t laser = 0;
};

/// Whose returns a plane is laid through.
enum class PlaneFrom {
  /// The return's own laser and the two next to it: noise and the lasers' biases.
  all_three,
  /// The two next to it only: what remains in the mean is its laser's bias against theirs.
  neighbours
};

/// Against the plane through the neighbours of each return (principal components, the return
/// itself left out), wherever these are a plane: every `stride`-th return of each laser is tried.
[[nodiscard]] std::vector<Residual> plane_residuals(const LaserScan& scan, const Beams& beams,
                                                    PlaneFrom from, std::size_t stride = 1);

/// Against the parabola of range over azimuth through eight returns of the same laser around each
/// return: noise of the range alone, whatever the laser's calibration. Incidence is not known: the
/// cosines are left at 1.
[[nodiscard]] std::vector<Residual> laser_residuals(const LaserScan& scan, std::size_t stride = 1);

struct Noise {
  std::size_t count = 0;
  double mean_m = 0.0;
  double median_m = 0.0;
  /// Root mean square of those within four robust standard deviations of the median.
  double rms_m = 0.0;
  /// 1.4826 times the median of the deviations from the median: that of a normal distribution,
  /// blind to outliers.
  double robust_m = 0.0;
};

/// All zero for no residuals.
[[nodiscard]] Noise noise_of(std::span<const Residual> residuals);

/// Those for which `wanted(residual)` holds.
template <typename Wanted>
[[nodiscard]] Noise noise_where(std::span<const Residual> residuals, const Wanted& wanted) {
  std::vector<Residual> some;
  for (const Residual& r : residuals) {
    if (wanted(r)) some.push_back(r);
  }
  return noise_of(some);
}

}  // namespace locsim::fidelity
