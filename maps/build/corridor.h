#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/pose.h"

namespace locsim::maps::build {

/// The places within a horizontal distance of a polyline.
class Corridor {
 public:
  Corridor(std::span<const Vector3d> path, double half_width_m);

  [[nodiscard]] bool contains(double x_m, double y_m);

 private:
  enum class Cover : std::uint8_t { outside, inside, border };

  [[nodiscard]] double distance_m(const Eigen::Vector2d& place) const;
  [[nodiscard]] Cover classify(std::int64_t column, std::int64_t row) const;

  std::vector<Eigen::Vector2d> path_;
  double half_width_m_;
  /// Cells met so far: only those on the border need the distance of each point.
  std::unordered_map<std::uint64_t, Cover> cells_;
};

}  // namespace locsim::maps::build
