#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/world/layout.h"

namespace locsim::sim {

using Eigen::Vector2d;

/// Where a place lies among the streets.
struct StreetPlace {
  /// Nearest centreline: street, distance, signed distance (left positive), length along it [m].
  std::size_t street = 0;
  double distance_m = 0.0;
  double lateral_m = 0.0;
  double station_m = 0.0;
  Vector2d direction = Vector2d::UnitX();
  double camber_share = 0.0;
  /// Nearest carriageway, which may be another's: signed distance to its border, its half width,
  /// pavement and share of camber.
  double border_m = 0.0;
  double border_half_width_m = 0.0;
  double border_pavement_m = 0.0;
  double border_camber_share = 0.0;
  /// The least distance to any pavement's outer edge, negative inside.
  double clear_m = 0.0;
};

/// The pieces of all centrelines, for distances in the plane.
class StreetIndex {
 public:
  explicit StreetIndex(std::span<const Street> streets);

  /// Numbers of the pieces that may be nearest to some place within `radius_m` of (x, y), chosen
  /// among `among`, or among all where that is empty.
  [[nodiscard]] std::vector<std::uint32_t> candidates(
      double x_m, double y_m, double radius_m, std::span<const std::uint32_t> among = {}) const;
  /// Of the pieces given; of all where `pieces` is empty.
  [[nodiscard]] StreetPlace locate(double x_m, double y_m,
                                   std::span<const std::uint32_t> pieces = {}) const;

 private:
  struct Piece {
    Vector2d start;
    Vector2d direction;
    double length_m;
    double station_m;
    double half_width_m;
    double pavement_m;
    double camber_start, camber_end;
    std::uint32_t street;
  };
  [[nodiscard]] static double distance(const Piece& piece, double x_m, double y_m);

  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> all_;
};

/// Share of camber at every vertex of every street: 0 where another street or another pass of the
/// same one is near and where the bend is tight, rising smoothly to 1 away from there.
[[nodiscard]] std::vector<std::vector<double>> camber_shares(std::span<const Street> streets);

/// 0 below 0, 1 above 1, between them a cubic with level ends.
[[nodiscard]] constexpr double smoothstep(double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  return x * x * (3.0 - 2.0 * x);
}

}  // namespace locsim::sim
