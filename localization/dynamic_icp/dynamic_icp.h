#pragma once

#include <limits>
#include <optional>
#include <span>

#include "core/parameters.h"
#include "core/pose.h"
#include "localization/dynamic_icp/candidate_search.h"
#include "localization/dynamic_icp/local_map.h"
#include "localization/dynamic_icp/registration.h"
#include "maps/prior_map.h"

/// LIDAR odometry by Dynamic-ICP: paper Algorithm 1.
namespace locsim::localization {

struct DynamicIcpConfig {
  LocalMapConfig local_map;
  AlignmentConfig alignment;
  CandidateSearchConfig search;

  /// SCANRANGE: points farther from the vehicle are not used.
  double scan_range_m = 75.0;
  /// The search covers so many standard deviations of GNSS, at least and at most these lengths.
  double sigmas = 3.0;
  double search_min_m = 6.0;
  double search_max_m = 80.0;
  double heading_sigmas = 3.0;

  /// The paper's Error Tolerance [m] on E, and what else a pose must have to be believed.
  double error_tolerance_m = 0.15;
  /// The same for `track`, where the IMU bears witness too: what a map with points 5 cm off and an
  /// overlap of 0.6 leave.
  double tracking_tolerance_m = 0.18;
  double overlap_min = 0.6;
  int inliers_min = 100;
  /// A pose that ended elsewhere (1 m or 3° away) with a cost below this many times the best's
  /// makes it ambiguous.
  double rival_cost_ratio = 1.25;

  /// The region after a try that failed, and before one that converged, as a factor.
  double growth = 1.6;
  int tries_max = 3;
  /// Candidates are aligned with so many points, and the best so many of them with all.
  int coarse_points = 300;
  double coarse_correspondence_m = 2.5;
  int coarse_iterations = 12;
  int refined_max = 12;
  /// In place of `alignment.information_min`: a search has no prediction to keep to, and places
  /// that a weak direction cannot tell apart are each other's rivals.
  double search_information_min = 0.005;

  void describe(Parameters& p);
};

/// Where GNSS says the vehicle is.
struct GnssGuess {
  /// Roll and pitch from gravity; the yaw may mean nothing. The height does not matter.
  Pose T_map_vehicle;
  /// Of the horizontal position, as GNSS claims it.
  Eigen::Matrix2d covariance_xy_m2 = Eigen::Matrix2d::Zero();
  /// Nothing where the heading is unknown.
  std::optional<double> yaw_sigma_rad;
};

enum class DynamicIcpStatus {
  /// Within the error tolerance, and nothing else nearly as good was found.
  converged,
  /// Another place fits nearly as well: the best is as likely an alias.
  ambiguous,
  failed
};

struct DynamicIcpResult {
  DynamicIcpStatus status = DynamicIcpStatus::failed;
  /// The best found, whatever the status.
  Alignment alignment;
  int tries = 0;
  int candidates = 0;
  /// Of all alignments together.
  int iterations = 0;
  /// r_k of the last try.
  double region_radius_m = 0.0;
  /// Cost of the best rival over the best's own, both with the noise of a point added; infinite
  /// where there is none.
  double rival_ratio = std::numeric_limits<double>::infinity();
};

/// Within 1 m and 3°: what ended there ended at the same place.
[[nodiscard]] bool is_same_place(const Pose& a, const Pose& b);

/// Of the costs, both with the noise of a point added.
[[nodiscard]] double cost_ratio(const Alignment& rival, const Alignment& best,
                                const AlignmentConfig& config);

/// Finds the vehicle on the prior map. Keeps a local map about where it last looked.
class DynamicIcp {
 public:
  /// Throws InputError where `config` is out of its limits.
  DynamicIcp(const maps::PriorMap& map, const DynamicIcpConfig& config);

  /// Algorithm 1 from GNSS, for the start and when lost. `points` are of one moment, vehicle frame.
  [[nodiscard]] DynamicIcpResult relocalize(std::span<const Vector3f> points,
                                            const GnssGuess& guess);
  /// Algorithm 1 from the IMU's prediction, whose horizontal position is known to
  /// `position_sigma_m`: one candidate, a region of the scan's size and of that uncertainty.
  [[nodiscard]] DynamicIcpResult track(std::span<const Vector3f> points, const Pose& prediction,
                                       double position_sigma_m = 0.0);

  /// As if newly made, but for what the local map holds.
  void start_anew() { search_growth_ = track_growth_ = 1.0; }

  [[nodiscard]] const LocalMap& local_map() const { return map_; }
  /// How many times as far as configured the next call looks at first: grows with tries that
  /// failed, shrinks with those that converged.
  [[nodiscard]] double search_growth() const { return search_growth_; }
  [[nodiscard]] double track_growth() const { return track_growth_; }

 private:
  struct Found;
  [[nodiscard]] Found find(std::span<const Vector3f> points, const SearchArea& area) const;
  [[nodiscard]] bool is_within_tolerance(const Alignment& alignment, double tolerance_m) const;

  DynamicIcpConfig config_;
  LocalMap map_;
  double search_growth_ = 1.0;
  double track_growth_ = 1.0;
};

}  // namespace locsim::localization
