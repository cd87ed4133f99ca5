#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/parameters.h"
#include "core/pose.h"
#include "maps/prior_map.h"

namespace locsim::localization {

struct MapRegistrationConfig {
  /// The map is thinned once to one point for each such voxel.
  double map_voxel_m = 0.4;
  /// Piece of the map about the vehicle, and how far it may drive before the next is cut.
  double crop_radius_m = 75.0;
  double crop_again_m = 12.0;
  double max_correspondence_m = 0.6;
  int iterations_max = 8;
  /// A registration ends when a step is shorter than this.
  double step_min_m = 1e-3;
  /// A point overlaps the map where its neighbour is this close.
  double overlap_distance_m = 0.5;

  void describe(Parameters& p);
};

/// How well a scan lies on the map.
struct Registration {
  Pose T_map_vehicle;
  /// Points with a neighbour in the map within the overlap distance, and their share of all.
  int inliers = 0;
  double overlap = 0.0;
  /// Root mean square distance of these to their neighbours [m]; a map of voxels v thick gives
  /// about 0.4 v where everything fits.
  double residual_m = 0.0;
  int iterations = 0;
  /// See `step_gain`; zero where it was not asked for or cannot be known.
  Matrix6d gain = Matrix6d::Zero();
  /// Mean over all points of min(d, overlap distance)² [m²]: less is better, overlap included.
  double cost_m2 = 0.0;
};

/// What point-to-point ICP can correct in `iterations` steps of an error ξ of the vehicle's pose
/// (right perturbation): residual = G·ξ. Each point p has a constraint matrix W in the vehicle
/// frame (n·nᵀ on a plane, where a slip along it goes unnoticed; identity where a point is alone).
/// With J = [I, −[p]×], M = Σ JᵀJ and A = Σ JᵀWJ a step takes M⁻¹A·ξ off, so
/// G = I − (I − M⁻¹A)^iterations: near the identity where surfaces face all ways, near zero along
/// a tunnel. It is what makes the covariance of an uninformative registration honest.
[[nodiscard]] Matrix6d step_gain(std::span<const Vector3f> points,
                                 std::span<const Matrix3d> constraints, int iterations);

/// PCL's point-to-point ICP of scans against the prior map. Coordinates within PCL are floats
/// about the crop's float64 origin.
class MapRegistration {
 public:
  MapRegistration(const maps::PriorMap& map, const MapRegistrationConfig& config);
  ~MapRegistration();

  /// Cuts the map about the place where the last cut does not serve it. False where the map has
  /// nearly nothing there.
  [[nodiscard]] bool move_to(const Vector3d& p_map);
  /// Registers `points` (vehicle frame) from `guess`; after move_to. `with_gain` asks for the gain.
  [[nodiscard]] Registration align(std::span<const Vector3f> points, const Pose& guess,
                                   double max_correspondence_m, int iterations, bool with_gain);
  /// Height of the map's ground about a place: a low quantile of the points between 3 and 12 m
  /// away horizontally. NaN where there are too few.
  [[nodiscard]] double ground_height_m(const Vector3d& p_map) const;

 private:
  struct Target;
  MapRegistrationConfig config_;
  maps::PriorMap map_;
  std::unique_ptr<Target> target_;
};

/// The same quantile over points about the origin of their frame. NaN where there are too few.
[[nodiscard]] double ground_height_m(std::span<const Vector3f> points, const Vector3f& center);

}  // namespace locsim::localization
