#pragma once

#include <span>
#include <vector>

#include "sim/world/layout.h"

namespace locsim::sim {

/// Heights of centrelines spread over the plane: a mean over all that lies near, weighted by the
/// inverse fourth power of the distance (Shepard), smooth where streets cross, overlap or disagree.
/// Half of each point's slope along its street goes into the mean, which cancels the error that
/// averaging over a curved profile makes.
class HeightBlend {
 public:
  /// Throws InputError where no street has two vertices.
  explicit HeightBlend(std::span<const Street> streets);

  [[nodiscard]] double at(double x_m, double y_m) const;
  /// The points that count within `radius_m` of a place: gives the same heights there.
  [[nodiscard]] HeightBlend near(double x_m, double y_m, double radius_m) const;

 private:
  struct Point {
    double x_m, y_m, z_m;
    /// Half the height gained for each metre East and North.
    double half_slope_x, half_slope_y;
    double weight;
  };
  HeightBlend() = default;

  std::vector<Point> points_;
};

}  // namespace locsim::sim
