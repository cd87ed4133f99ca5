#include "benchmarks/relocalization/start_town.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"
#include "sim/lidar/lidar.h"
#include "sim/trajectory.h"

namespace locsim::relocalization {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// Free of a street's ends.
constexpr double kEnd_m = 6.0;
constexpr double kLaneOffset_m = 1.75;

/// A car about its rear axle, and the height at which it would touch others.
constexpr double kFront_m = 3.9;
constexpr double kRear_m = -1.1;
constexpr double kHalfWidth_m = 1.0;
constexpr double kBumper_m = 0.6;

double length_m(const sim::Street& street) {
  double sum = 0.0;
  for (std::size_t i = 1; i < street.centreline.size(); ++i) {
    sum += (street.centreline[i] - street.centreline[i - 1]).head<2>().norm();
  }
  return sum;
}

struct Spot {
  Eigen::Vector2d position;
  Eigen::Vector2d course;
};

Spot spot_at(const sim::Street& street, double station_m) {
  double left_m = station_m;
  for (std::size_t i = 1;; ++i) {
    const Eigen::Vector2d a = street.centreline[i - 1].head<2>();
    const Eigen::Vector2d way = street.centreline[i].head<2>() - a;
    if (left_m <= way.norm() || i + 1 == street.centreline.size()) {
      return {a + left_m * way.normalized(), way.normalized()};
    }
    left_m -= way.norm();
  }
}

scenarios::Scenario seeded(const std::filesystem::path& file, std::uint64_t seed) {
  const std::vector<std::string> overrides = {"seed=" + std::to_string(seed),
                                              "world.seed=" + std::to_string(seed)};
  return scenarios::load_scenario(file, overrides);
}

}  // namespace

StartTown::StartTown(const std::filesystem::path& scenario, std::uint64_t seed,
                     const localization::PointPickerConfig& picker)
    : scenario_(seeded(scenario, seed)),
      stage_(scenarios::build_stage(scenario_)),
      map_(scenarios::build_map(scenario_, stage_)),
      ground_(std::make_unique<sim::GroundSurface>(
          sim::Layout{.streets = stage_.streets, .route = stage_.route})),
      scene_(std::make_unique<sim::RayScene>(stage_.world, stage_.actors)),
      picker_(picker) {}

StartTown::~StartTown() = default;

std::vector<Berth> StartTown::draw_berths(int count) const {
  RandomSequence random(scenario_.seed, "relocalization/berths");
  double total_m = 0.0;
  for (const sim::Street& street : stage_.streets) {
    total_m += std::max(0.0, length_m(street) - 2.0 * kEnd_m);
  }
  if (!(total_m > 0.0)) throw InputError("relocalization: the scenario's world has no streets");
  std::vector<Berth> berths;
  for (int draws = 0; static_cast<int>(berths.size()) < count; ++draws) {
    if (draws > 100 * count + 1000)
      throw InputError("relocalization: no free place on the streets");
    Berth berth;
    double at_m = random.uniform(0.0, total_m);
    for (;; ++berth.street) {
      const double usable_m = std::max(0.0, length_m(stage_.streets[berth.street]) - 2.0 * kEnd_m);
      if (at_m <= usable_m || berth.street + 1 == stage_.streets.size()) break;
      at_m -= usable_m;
    }
    berth.station_m = kEnd_m + at_m;
    berth.direction = random.chance(0.5) ? 1.0 : -1.0;
    berth.lateral_m = random.uniform(-0.6, 0.6);
    berth.turn_rad = random.uniform(-5.0, 5.0) * kDegree;
    berth.time = stamp_from_seconds(random.uniform(1.0, 0.8 * stage_.route.duration_s()));
    if (is_free(berth)) berths.push_back(berth);
  }
  return berths;
}

Berth StartTown::driven_on(const Berth& from, double distance_m, double time_s) const {
  Berth to = from;
  const double end_m = length_m(stage_.streets[from.street]) - kEnd_m;
  to.station_m = std::clamp(from.station_m + from.direction * distance_m, kEnd_m, end_m);
  to.time = from.time + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(time_s));
  if (is_free(to)) return to;
  Berth waiting = from;
  waiting.time = to.time;
  return waiting;
}

Pose StartTown::pose(const Berth& berth) const {
  const Spot spot = spot_at(stage_.streets[berth.street], berth.station_m);
  const Eigen::Vector2d course = berth.direction * spot.course;
  const Eigen::Vector2d left(-course.y(), course.x());
  const Eigen::Vector2d at = spot.position + (berth.lateral_m - kLaneOffset_m) * left;
  const Eigen::Vector2d x = Eigen::Rotation2Dd(berth.turn_rad) * course;
  const Eigen::Vector2d y(-x.y(), x.x());
  const auto height_m = [&](const Eigen::Vector2d& p) {
    return ground_->at(p.x(), p.y()).road_height_m;
  };
  const auto rise = [&](const Eigen::Vector2d& way) {
    return 0.5 * (height_m(at + way) - height_m(at - way));
  };
  const Vector3d forward = Vector3d(x.x(), x.y(), rise(x)).normalized();
  const Vector3d up = forward.cross(Vector3d(y.x(), y.y(), rise(y))).normalized();
  Matrix3d R;
  R << forward, up.cross(forward), up;
  return {Eigen::Quaterniond(R).normalized(), Vector3d(at.x(), at.y(), height_m(at))};
}

bool StartTown::is_free(const Berth& berth) const {
  const Pose T = pose(berth);
  const auto is_blocked = [&](double x0, double y0, double x1, double y1) {
    const Vector3d a = T * Vector3d(x0, y0, kBumper_m);
    const Vector3d b = T * Vector3d(x1, y1, kBumper_m);
    return scene_->is_blocked(a, (b - a).normalized(), (b - a).norm(), berth.time);
  };
  for (const double y : {-kHalfWidth_m, 0.0, kHalfWidth_m}) {
    if (is_blocked(kRear_m, y, kFront_m, y) || is_blocked(kFront_m, y, kRear_m, y)) return false;
  }
  for (double x = kRear_m; x <= kFront_m; x += 0.5) {
    if (is_blocked(x, -kHalfWidth_m, x, kHalfWidth_m)) return false;
  }
  return true;
}

std::vector<Vector3f> StartTown::scan(const Berth& berth) const {
  const scenarios::LidarSetup& setup = scenario_.sensors.lidar.front();
  const Pose T_vehicle_lidar = setup.mount.pose();
  sim::Lidar lidar(setup.spec, T_vehicle_lidar, 0, scenario_.seed);
  LidarScan scan = lidar.start_scan(berth.time);
  constexpr Duration kStep{2'500'000};
  sim::Trajectory trajectory(scan.start, kStep);
  const Pose T_map_vehicle = pose(berth);
  // Its last pose but one is the last that can be asked for.
  const auto steps = (scan.end - scan.start) / kStep + 3;
  for (std::int64_t i = 0; i < steps; ++i) trajectory.push(T_map_vehicle);
  lidar.cast(*scene_, trajectory, scan.start, scan.end, scan);
  localization::Rig rig;
  rig.T_vehicle_lidar = {T_vehicle_lidar};
  std::vector<Vector3f> points;
  for (const std::uint32_t i : localization::pick_points(scan, rig, picker_)) {
    points.push_back((T_vehicle_lidar * scan.points[i].position()).cast<float>());
  }
  return points;
}

}  // namespace locsim::relocalization
