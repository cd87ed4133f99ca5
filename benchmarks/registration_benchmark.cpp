// GCC 12 sees Eigen read past a 3-vector within PCL (a false alarm of its vectoriser, -O3 only).
#pragma GCC diagnostic ignored "-Warray-bounds"

#include <benchmark/benchmark.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt.h>
#include <tbb/global_control.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "benchmarks/figures.h"
#include "benchmarks/registration_scenes.h"
#include "localization/dynamic_icp/local_map.h"
#include "localization/dynamic_icp/registration.h"
#include "maps/pcl_console.h"
#include "maps/thin.h"

namespace {

using namespace locsim;
using namespace locsim::benchmarks;
using localization::Alignment;
using localization::AlignmentConfig;
using localization::LocalMap;

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

enum SceneName : std::int64_t { kTownHdl32e, kTownHdl64e, kKitti, kKittiNear };

const Scene* scene_of(benchmark::State& state) {
  const Scene* scene = nullptr;
  switch (state.range(0)) {
    case kTownHdl32e:
      return &town_hdl32e_scene();
    case kTownHdl64e:
      return &town_hdl64e_scene();
    case kKitti:
      scene = &kitti_scene();
      break;
    default:
      scene = &kitti_near_scene();
      break;
  }
  if (!scene->queries.empty()) return scene;
  state.SkipWithError(
      ("no drive in " + kitti_folder().string() + "; LOCSIM_DATA_DIR names the folder of drives")
          .c_str());
  return nullptr;
}

/// A local map for each query.
std::vector<std::unique_ptr<LocalMap>> cut_maps(const Scene& scene) {
  std::vector<std::unique_ptr<LocalMap>> cut;
  for (std::size_t i = 0; i < scene.queries.size(); ++i) {
    cut.push_back(std::make_unique<LocalMap>(scene.map_of(i), localization::LocalMapConfig{}));
    if (!cut.back()->cut(scene.queries[i].truth.translation, kRangeMax_m)) return {};
  }
  return cut;
}

/// Costs of all rounds; errors of the last against the given poses, and how the scans then lie on
/// the surface.
class Tally {
 public:
  explicit Tally(const Scene& scene) : scene_(scene), found_(scene.queries.size()) {}

  void set(std::size_t query, const Pose& pose, int iterations, const Stopwatch::Lap& cost) {
    found_[query] = pose;
    iterations_.push_back(iterations);
    wall_ms_.push_back(cost.wall_ms);
    worked_ms_.push_back(cost.worked_ms);
  }
  void prepared(const Stopwatch::Lap& cost) { prepare_ms_ = cost.worked_ms; }

  void report(benchmark::State& state) const {
    const std::vector<std::unique_ptr<LocalMap>> maps = cut_maps(scene_);
    double error2_m2 = 0.0;
    double turn2 = 0.0;
    double residual_m = 0.0;
    double points = 0.0;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const Query& query = scene_.queries[i];
      const Vector6d error = se3::log(query.truth.inverse() * found_[i]);
      error2_m2 += error.head<3>().squaredNorm();
      turn2 += error.tail<3>().squaredNorm();
      residual_m += localization::assess(*maps[i], query.points, found_[i], {}).residual_m;
      points += static_cast<double>(query.points.size());
    }
    const auto count = static_cast<double>(found_.size());
    state.counters["ms"] = mean(wall_ms_);
    state.counters["ms_p50"] = quantile(wall_ms_, 0.5);
    state.counters["ms_p99"] = quantile(wall_ms_, 0.99);
    state.counters["cpu_ms"] = mean(worked_ms_);
    state.counters["prepare_cpu_ms"] = prepare_ms_ / count;
    state.counters["rmse_cm"] = 100.0 * std::sqrt(error2_m2 / count);
    state.counters["rmse_deg"] = std::sqrt(turn2 / count) * 180.0 / std::numbers::pi;
    state.counters["residual_cm"] = 100.0 * residual_m / count;
    state.counters["points"] = points / count;
    state.counters["iterations"] = mean(iterations_);
  }

 private:
  const Scene& scene_;
  std::vector<Pose> found_;
  std::vector<double> iterations_;
  std::vector<double> wall_ms_;
  std::vector<double> worked_ms_;
  double prepare_ms_ = 0.0;
};

/// Arguments: scene, threads.
void ours(benchmark::State& state, const std::string& metric) {
  const Scene* scene = scene_of(state);
  if (scene == nullptr) return;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(1)));
  Tally tally(*scene);
  Stopwatch preparing;
  const std::vector<std::unique_ptr<LocalMap>> maps = cut_maps(*scene);
  tally.prepared(preparing.lap());
  if (maps.empty()) return state.SkipWithError("the map does not reach the scans");
  const AlignmentConfig config{.metric = metric};
  for (auto _ : state) {
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const Query& query = scene->queries[i];
      Stopwatch stopwatch;
      const Alignment found = localization::align(*maps[i], query.points, query.guess, config);
      tally.set(i, found.T_map_vehicle, found.iterations, stopwatch.lap());
    }
  }
  tally.report(state);
}

void point_to_plane(benchmark::State& state) {
  ours(state, "point_to_plane");
}
void point_to_point(benchmark::State& state) {
  ours(state, "point_to_point");
}

Cloud::Ptr to_cloud(std::span<const Vector3f> points) {
  auto cloud = std::make_shared<Cloud>();
  for (const Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  return cloud;
}

// PCL's, with what its users would set, their number of iterations exposed.

struct Icp : pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> {
  static constexpr double kMapVoxel_m = 0.4;
  Icp() {
    setMaxCorrespondenceDistance(1.0);
    setMaximumIterations(50);
    setTransformationEpsilon(1e-6);
  }
  [[nodiscard]] int iterations() const { return nr_iterations_; }
};
/// As it comes: 5 m to the correspondences, 20 neighbours for a covariance.
struct Gicp : pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> {
  static constexpr double kMapVoxel_m = 0.4;
  [[nodiscard]] int iterations() const { return nr_iterations_; }
};
struct Ndt : pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> {
  /// A cell needs six points to count.
  static constexpr double kMapVoxel_m = 0.2;
  Ndt() {
    setResolution(1.0F);
    setStepSize(0.1);
    // PCL compares it with the square of a step: 1 cm. With 0.01 no second step is ever made.
    setTransformationEpsilon(1e-4);
    setMaximumIterations(30);
  }
  [[nodiscard]] int iterations() const { return nr_iterations_; }
};

/// A PCL method with its map, prepared beforehand as ours is.
template <typename Method>
struct Prepared {
  Method method;
  Vector3d origin;

  Prepared(const maps::PriorMap& map, const Query& query) {
    const maps::Crop crop =
        maps::thin(map, Method::kMapVoxel_m).crop(query.truth.translation, kRangeMax_m);
    origin = crop.origin;
    method.setInputTarget(to_cloud(crop.points));
    // The first call makes search trees and covariances of the map.
    const int iterations = method.getMaximumIterations();
    method.setMaximumIterations(1);
    (void)align(to_cloud(query.points), query.guess);
    method.setMaximumIterations(iterations);
  }

  Pose align(const Cloud::Ptr& points, Pose guess) {
    guess.translation -= origin;
    method.setInputSource(points);
    Cloud aligned;
    method.align(aligned, guess.isometry().matrix().template cast<float>());
    Eigen::Isometry3d found;
    found.matrix() = method.getFinalTransformation().template cast<double>();
    Pose pose = Pose::from_isometry(found);
    pose.rotation.normalize();
    pose.translation += origin;
    return pose;
  }
};

/// One thread.
template <typename Method>
void pcl_method(benchmark::State& state) {
  const Scene* scene = scene_of(state);
  if (scene == nullptr) return;
  maps::silence_pcl();
  Tally tally(*scene);
  Stopwatch preparing;
  std::vector<std::unique_ptr<Prepared<Method>>> methods;
  std::vector<Cloud::Ptr> clouds;
  for (std::size_t i = 0; i < scene->queries.size(); ++i) {
    const Query& query = scene->queries[i];
    methods.push_back(std::make_unique<Prepared<Method>>(scene->map_of(i), query));
    clouds.push_back(to_cloud(query.points));
  }
  tally.prepared(preparing.lap());
  for (auto _ : state) {
    for (std::size_t i = 0; i < methods.size(); ++i) {
      Stopwatch stopwatch;
      const Pose pose = methods[i]->align(clouds[i], scene->queries[i].guess);
      tally.set(i, pose, methods[i]->method.iterations(), stopwatch.lap());
    }
  }
  tally.report(state);
}

void pcl_icp(benchmark::State& state) {
  pcl_method<Icp>(state);
}
void pcl_gicp(benchmark::State& state) {
  pcl_method<Gicp>(state);
}
void pcl_ndt(benchmark::State& state) {
  pcl_method<Ndt>(state);
}

void with_threads(benchmark::internal::Benchmark* of) {
  of->ArgNames({"scene", "threads"})
      ->ArgsProduct({{kTownHdl32e, kTownHdl64e, kKitti, kKittiNear}, {1, 2}});
  of->Iterations(10)->Unit(benchmark::kMillisecond)->UseRealTime();
}
/// A round is 12 or 24 scans of up to a second each.
void one_round(benchmark::internal::Benchmark* of) {
  of->ArgName("scene")->DenseRange(kTownHdl32e, kKittiNear);
  of->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK(point_to_plane)->Apply(with_threads);
BENCHMARK(point_to_point)->Apply(with_threads);
BENCHMARK(pcl_icp)->Apply(one_round);
BENCHMARK(pcl_gicp)->Apply(one_round);
BENCHMARK(pcl_ndt)->Apply(one_round);

}  // namespace

BENCHMARK_MAIN();
