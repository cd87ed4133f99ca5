#pragma once

#include <cstddef>
#include <vector>

#include "benchmarks/fidelity/laser_scan.h"

namespace locsim::fidelity {

/// The ground under one scan, by cells of a metre: the lowest returns of each cell where they
/// follow from the cells nearer to the sensor, and these carried on where they do not (a wall, a
/// car, nothing).
class GroundGrid {
 public:
  explicit GroundGrid(const LaserScan& scan);

  /// Of a point above the ground [m]; NaN farther than 80 m from the sensor.
  [[nodiscard]] double height_above_m(const Vector3f& position) const;

 private:
  [[nodiscard]] double height_at(double x_m, double y_m) const;

  std::vector<double> height_m_;
};

}  // namespace locsim::fidelity
