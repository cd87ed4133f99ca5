#pragma once

#include <span>

#include "benchmarks/relocalization/start_case.h"
#include "localization/icp/map_registration.h"
#include "localization/icp/pose_search.h"

namespace locsim::relocalization {

/// What there is without candidates: PCL's point-to-point ICP, as the localizer `icp` uses it and
/// with the checks that it makes (overlap, inliers, residual).
class PlainIcp {
 public:
  /// For GNSS off by `gnss_error_m`: the region is the scan's 75 m and three claimed sigmas.
  PlainIcp(const maps::PriorMap& map, double gnss_error_m);

  /// Once, from where GNSS says; a heading of 0 where it is unknown. Wide at first, then narrow.
  [[nodiscard]] Try once(const Pose& truth, std::span<const Vector3f> points, const Start& start);
  /// `search_pose`: a grid of starts over three sigmas of GNSS and of the heading, as fine as
  /// `seconds` of computing allow; the rival test is its own.
  [[nodiscard]] Try grid(const Pose& truth, std::span<const Vector3f> points, const Start& start,
                         double seconds);

 private:
  [[nodiscard]] localization::PoseSearchConfig search_within(const Start& start,
                                                             double seconds) const;

  localization::MapRegistration registration_;
  /// Of a search, measured as it goes: for each start, and whatever their number.
  double seconds_per_start_ = 8e-3;
};

}  // namespace locsim::relocalization
