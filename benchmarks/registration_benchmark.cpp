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

constexpr double kPclMapVoxel_m = 0.4;

const Scene* scene_of(benchmark::State& state) {
  const Scene& scene = state.range(0) == 0 ? town_scene() : kitti_scene();
  if (!scene.queries.empty()) return &scene;
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
    if (!cut.back()->cut(scene.queries[i].truth.translation, kRegion_m)) return {};
  }
  return cut;
}

/// Errors of the last round against the given poses, and how the scans then lie on the surface.
class Tally {
 public:
  explicit Tally(const Scene& scene) : scene_(scene), found_(scene.queries.size()) {}

  void set(std::size_t query, const Pose& pose, int iterations) {
    found_[query] = pose;
    iterations_ += iterations;
    ++runs_;
  }
  void report(benchmark::State& state) const {
    const std::vector<std::unique_ptr<LocalMap>> maps = cut_maps(scene_);
    double error2_m2 = 0.0;
    double turn2 = 0.0;
    double residual_m = 0.0;
    double overlap = 0.0;
    double points = 0.0;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const Query& query = scene_.queries[i];
      const Vector6d error = se3::log(query.truth.inverse() * found_[i]);
      error2_m2 += error.head<3>().squaredNorm();
      turn2 += error.tail<3>().squaredNorm();
      const Alignment lies = localization::assess(*maps[i], query.points, found_[i], {});
      residual_m += lies.residual_m;
      overlap += lies.overlap;
      points += static_cast<double>(query.points.size());
    }
    const auto count = static_cast<double>(found_.size());
    state.counters["rmse_cm"] = 100.0 * std::sqrt(error2_m2 / count);
    state.counters["rmse_deg"] = std::sqrt(turn2 / count) * 180.0 / std::numbers::pi;
    state.counters["residual_cm"] = 100.0 * residual_m / count;
    state.counters["overlap"] = overlap / count;
    state.counters["points"] = points / count;
    state.counters["iterations"] = static_cast<double>(iterations_) / static_cast<double>(runs_);
    // Every round registers each scan once.
    state.counters["a_scan"] = benchmark::Counter(
        count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  }

 private:
  const Scene& scene_;
  std::vector<Pose> found_;
  std::int64_t iterations_ = 0;
  std::int64_t runs_ = 0;
};

/// Arguments: scene (0 town, 1 KITTI), threads.
void ours(benchmark::State& state, const std::string& metric) {
  const Scene* scene = scene_of(state);
  if (scene == nullptr) return;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(1)));
  const std::vector<std::unique_ptr<LocalMap>> maps = cut_maps(*scene);
  if (maps.empty()) return state.SkipWithError("the map does not reach the scans");
  Tally tally(*scene);
  const AlignmentConfig config{.metric = metric};
  for (auto _ : state) {
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const Query& query = scene->queries[i];
      const Alignment found = localization::align(*maps[i], query.points, query.guess, config);
      tally.set(i, found.T_map_vehicle, found.iterations);
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
BENCHMARK(point_to_plane)->Args({0, 1})->Args({0, 2})->Args({1, 1})->Args({1, 2})->UseRealTime();
BENCHMARK(point_to_point)->Args({0, 1})->Args({0, 2})->Args({1, 1})->Args({1, 2})->UseRealTime();

Cloud::Ptr to_cloud(std::span<const Vector3f> points) {
  auto cloud = std::make_shared<Cloud>();
  for (const Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  return cloud;
}

/// Exposes the number of iterations.
struct Icp : pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> {
  static void configure(Icp& icp) { icp.setMaxCorrespondenceDistance(1.0); }
  [[nodiscard]] int iterations() const { return nr_iterations_; }
};
struct Gicp : pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> {
  static void configure(Gicp& gicp) { gicp.setMaxCorrespondenceDistance(1.0); }
  [[nodiscard]] int iterations() const { return nr_iterations_; }
};
struct Ndt : pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> {
  static void configure(Ndt& ndt) { ndt.setResolution(1.0F); }
  [[nodiscard]] int iterations() const { return nr_iterations_; }
};

/// PCL's, its target (map thinned to 0.4 m) prepared beforehand as ours is. One thread.
template <typename Method>
void pcl_method(benchmark::State& state) {
  const Scene* scene = scene_of(state);
  if (scene == nullptr) return;
  maps::silence_pcl();
  std::vector<std::unique_ptr<Method>> methods;
  std::vector<Vector3d> origins;
  for (std::size_t i = 0; i < scene->queries.size(); ++i) {
    const maps::Crop crop = maps::thin(scene->map_of(i), kPclMapVoxel_m)
                                .crop(scene->queries[i].truth.translation, kRegion_m);
    origins.push_back(crop.origin);
    methods.push_back(std::make_unique<Method>());
    methods.back()->setInputTarget(to_cloud(crop.points));
    methods.back()->setMaximumIterations(40);
    methods.back()->setTransformationEpsilon(1e-6);
    Method::configure(*methods.back());
  }
  Tally tally(*scene);
  for (auto _ : state) {
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const Query& query = scene->queries[i];
      Pose guess = query.guess;
      guess.translation -= origins[i];
      methods[i]->setInputSource(to_cloud(query.points));
      Cloud aligned;
      methods[i]->align(aligned, guess.isometry().matrix().cast<float>());
      Eigen::Isometry3d found;
      found.matrix() = methods[i]->getFinalTransformation().template cast<double>();
      Pose pose = Pose::from_isometry(found);
      pose.rotation.normalize();
      pose.translation += origins[i];
      tally.set(i, pose, methods[i]->iterations());
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
BENCHMARK(pcl_icp)->Args({0, 1})->Args({1, 1})->UseRealTime();
BENCHMARK(pcl_gicp)->Args({0, 1})->Args({1, 1})->UseRealTime();
BENCHMARK(pcl_ndt)->Args({0, 1})->Args({1, 1})->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
