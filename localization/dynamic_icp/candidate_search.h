#pragma once

#include <numbers>
#include <span>
#include <vector>

#include "core/parameters.h"
#include "core/pose.h"
#include "localization/dynamic_icp/local_map.h"

namespace locsim::localization {

/// Where the vehicle may be and which way it may face.
struct SearchArea {
  /// Roll and pitch are taken as they are (gravity), height comes from the map's ground.
  Pose guess;
  /// Offsets o (map frame, horizontal) with oᵀ·shape⁻¹·o ≤ 1 are looked at [m²].
  Eigen::Matrix2d shape_m2 = Eigen::Matrix2d::Zero();
  /// Headings within this of the guess's; π is all.
  double heading_rad = std::numbers::pi;

  /// Half of its longest axis.
  [[nodiscard]] double radius_m() const;
};

struct CandidateSearchConfig {
  /// Step of the positions, and size of the cells that points fall in.
  double cell_m = 1.0;
  double heading_step_rad = 3.0 * std::numbers::pi / 180.0;
  /// So many points of the scan that stand this high above its ground decide: ground is the same
  /// everywhere, and parked cars are lower.
  int points = 250;
  double above_ground_m = 1.5;
  /// The best so many are kept, at least this far apart or turned.
  int candidates_max = 60;
  double apart_m = 2.0;
  double apart_rad = 9.0 * std::numbers::pi / 180.0;

  void describe(Parameters& p);
};

struct Candidate {
  Pose T_map_vehicle;
  /// 0…1: 1 where every point falls into a cell that the map fills.
  double score = 0.0;
};

/// Scores every position (by `cell_m`) and heading of the area by the cells of the local map that
/// the scan's points fall in or next to (Olson 2009's correlative matching, in three dimensions),
/// and returns the best, best first. `points` are in the vehicle frame and finite. Positions
/// without ground are left out. In as many threads as the caller's task arena has, with the same
/// result for any number.
[[nodiscard]] std::vector<Candidate> find_candidates(const LocalMap& map,
                                                     std::span<const Vector3f> points,
                                                     const SearchArea& area,
                                                     const CandidateSearchConfig& config);

}  // namespace locsim::localization
