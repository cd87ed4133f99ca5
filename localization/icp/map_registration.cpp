// GCC 12 sees Eigen read past a 3-vector within PCL (a false alarm of its vectoriser, -O3 only).
#pragma GCC diagnostic ignored "-Warray-bounds"

#include "localization/icp/map_registration.h"

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "maps/pcl_console.h"
#include "maps/thin.h"

namespace locsim::localization {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr std::size_t kTargetPointsMin = 100;
constexpr std::size_t kGainPoints = 150;
constexpr int kNeighbours = 8;

/// Exposes what the iterations left, so that nothing need be searched again.
class Icp : public pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, float> {
 public:
  [[nodiscard]] const pcl::Correspondences& matches() const { return *correspondences_; }
  [[nodiscard]] int iterations() const { return nr_iterations_; }
};

Cloud::Ptr to_cloud(std::span<const Vector3f> points) {
  auto cloud = std::make_shared<Cloud>();
  cloud->reserve(points.size());
  for (const Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  return cloud;
}

/// I less the directions in which the neighbours spread: n·nᵀ for a plane, the plane across for a
/// line, little for a cloud. A spread below a tenth of the widest (as variance) counts as thin.
Matrix3d constraint_of(const Cloud& cloud, const pcl::Indices& neighbours) {
  Vector3d mean = Vector3d::Zero();
  for (const int i : neighbours) {
    mean += cloud[static_cast<std::size_t>(i)].getVector3fMap().cast<double>();
  }
  mean /= static_cast<double>(neighbours.size());
  Matrix3d spread = Matrix3d::Zero();
  for (const int i : neighbours) {
    const Vector3d d = cloud[static_cast<std::size_t>(i)].getVector3fMap().cast<double>() - mean;
    spread += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
  eigen.computeDirect(spread);
  const double widest = eigen.eigenvalues()[2];
  if (!(widest > 0.0)) return Matrix3d::Zero();
  const Vector3d weights = (1.0 - 10.0 / widest * eigen.eigenvalues().array()).max(0.0).matrix();
  return eigen.eigenvectors() * weights.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

void MapRegistrationConfig::describe(Parameters& p) {
  p.number("map_voxel_m", map_voxel_m, {0.05, 5.0});
  p.number("crop_radius_m", crop_radius_m, {10.0, 500.0});
  p.number("crop_again_m", crop_again_m, {1.0, 100.0});
  p.number("max_correspondence_m", max_correspondence_m, {0.05, 20.0});
  p.integer("iterations_max", iterations_max, {1, 200});
  p.number("step_min_m", step_min_m, {0.0, 0.1});
  p.number("overlap_distance_m", overlap_distance_m, {0.05, 5.0});
}

struct MapRegistration::Target {
  maps::Crop crop;
  Vector3d center = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Cloud::Ptr cloud;
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree;
  Icp icp;
};

MapRegistration::MapRegistration(const maps::PriorMap& map, const MapRegistrationConfig& config)
    : config_(config),
      map_(maps::thin(map, config.map_voxel_m)),
      target_(std::make_unique<Target>()) {
  maps::silence_pcl();
}

MapRegistration::~MapRegistration() = default;

bool MapRegistration::move_to(const Vector3d& p_map) {
  if (!p_map.allFinite()) return false;
  if (!((p_map - target_->center).head<2>().norm() <= config_.crop_again_m)) {
    map_.crop(p_map, config_.crop_radius_m, target_->crop);
    target_->center = p_map;
    target_->cloud = to_cloud(target_->crop.points);
    if (target_->cloud->size() >= kTargetPointsMin) {
      target_->tree = std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>(false);
      target_->tree->setInputCloud(target_->cloud);
      target_->icp.setSearchMethodTarget(target_->tree, true);
      target_->icp.setInputTarget(target_->cloud);
    }
  }
  return target_->cloud->size() >= kTargetPointsMin;
}

Registration MapRegistration::align(std::span<const Vector3f> points, const Pose& guess,
                                    double max_correspondence_m, int iterations, bool with_gain) {
  assert(target_->cloud && target_->cloud->size() >= kTargetPointsMin);
  Registration result;
  result.T_map_vehicle = guess;
  if (points.size() < 3 || !guess.is_finite()) return result;

  Pose T_crop_guess = guess;
  T_crop_guess.translation -= target_->crop.origin;
  Icp& icp = target_->icp;
  icp.setInputSource(to_cloud(points));
  icp.setMaxCorrespondenceDistance(max_correspondence_m);
  icp.setMaximumIterations(iterations);
  icp.setTransformationEpsilon(config_.step_min_m * config_.step_min_m);
  // cos of the turn that moves a point 30 m away by the same step.
  const double turn_rad = config_.step_min_m / 30.0;
  icp.setTransformationRotationEpsilon(std::cos(turn_rad));
  Cloud aligned;
  icp.align(aligned, T_crop_guess.isometry().matrix().cast<float>());
  result.iterations = icp.iterations();
  if (result.iterations == 0 || !icp.getFinalTransformation().allFinite()) return result;

  Eigen::Isometry3d final_pose = Eigen::Isometry3d::Identity();
  final_pose.matrix() = icp.getFinalTransformation().cast<double>();
  Pose T_crop_vehicle = Pose::from_isometry(final_pose);
  T_crop_vehicle.rotation.normalize();
  result.T_map_vehicle = T_crop_vehicle;
  result.T_map_vehicle.translation += target_->crop.origin;

  const double limit2 = config_.overlap_distance_m * config_.overlap_distance_m;
  double sum2 = 0.0;
  std::vector<std::size_t> inliers;
  for (const pcl::Correspondence& match : icp.matches()) {
    if (static_cast<double>(match.distance) > limit2) continue;
    sum2 += static_cast<double>(match.distance);
    inliers.push_back(static_cast<std::size_t>(match.index_query));
  }
  const auto all = static_cast<double>(points.size());
  const auto inside = static_cast<double>(inliers.size());
  result.inliers = static_cast<int>(inliers.size());
  result.overlap = inside / all;
  result.residual_m = inliers.empty() ? 0.0 : std::sqrt(sum2 / inside);
  result.cost_m2 = (sum2 + (all - inside) * limit2) / all;

  if (with_gain && !inliers.empty()) {
    const std::size_t count = std::min(inliers.size(), kGainPoints);
    const Matrix3d R = T_crop_vehicle.rotation.toRotationMatrix();
    std::vector<Vector3f> places;
    std::vector<Matrix3d> constraints;
    pcl::Indices neighbours(kNeighbours);
    std::vector<float> distances(kNeighbours);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t point = inliers[i * inliers.size() / count];
      target_->tree->nearestKSearch(aligned[point], kNeighbours, neighbours, distances);
      places.push_back(points[point]);
      constraints.push_back(R.transpose() * constraint_of(*target_->cloud, neighbours) * R);
    }
    result.gain = step_gain(places, constraints, result.iterations);
  }
  return result;
}

double MapRegistration::ground_height_m(const Vector3d& p_map) const {
  const Vector3d center = p_map - target_->crop.origin;
  return localization::ground_height_m(target_->crop.points, center.cast<float>()) +
         target_->crop.origin.z();
}

double ground_height_m(std::span<const Vector3f> points, const Vector3f& center) {
  constexpr float kNear2 = 3.0F * 3.0F;
  constexpr float kFar2 = 12.0F * 12.0F;
  std::vector<float> heights;
  for (const Vector3f& p : points) {
    const float distance2 = (p - center).head<2>().squaredNorm();
    if (distance2 >= kNear2 && distance2 <= kFar2) heights.push_back(p.z());
  }
  if (heights.size() < 10) return std::numeric_limits<double>::quiet_NaN();
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 10);
  std::ranges::nth_element(heights, low);
  return static_cast<double>(*low);
}

Matrix6d step_gain(std::span<const Vector3f> points, std::span<const Matrix3d> constraints,
                   int iterations) {
  assert(points.size() == constraints.size());
  Matrix6d M = Matrix6d::Zero();
  Matrix6d A = Matrix6d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Matrix<double, 3, 6> J;
    J << Matrix3d::Identity(), -skew(points[i].cast<double>());
    M += J.transpose() * J;
    A += J.transpose() * constraints[i] * J;
  }
  // M = L·Lᵀ, L⁻¹·A·L⁻ᵀ = U·diag(f)·Uᵀ with every f in [0, 1].
  const Eigen::LLT<Matrix6d> cholesky(M);
  if (points.size() < 6 || cholesky.info() != Eigen::Success) return Matrix6d::Zero();
  const auto L = cholesky.matrixL();
  const Matrix6d half = L.solve(A);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(L.solve(half.transpose().eval()));
  const Vector6d shares = eigen.eigenvalues().array().max(0.0).min(1.0);
  const Vector6d gains = (1.0 - (1.0 - shares.array()).pow(iterations)).matrix();
  const Matrix6d& U = eigen.eigenvectors();
  const Matrix6d half_gain = gains.asDiagonal() * U.transpose() * Matrix6d(cholesky.matrixU());
  return cholesky.matrixU().solve(U * half_gain);
}

}  // namespace locsim::localization
