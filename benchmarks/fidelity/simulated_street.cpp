#include "benchmarks/fidelity/simulated_street.h"

#include <cstdint>
#include <string>

#include "core/error.h"
#include "scenarios/scenario.h"
#include "scenarios/stage.h"
#include "sim/lidar/lidar.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"

namespace locsim::fidelity {

namespace {

constexpr Duration kStep{10'000'000};

}  // namespace

sim::Trajectory drive_along(const sim::Route& route, double from_m, double speed_m_s,
                            Duration time) {
  const Stamp start = stamp_from_seconds(route.at(from_m).time_s);
  sim::Trajectory trajectory(start, kStep);
  // The curve's last tangent needs the pose after it.
  const auto steps = time / kStep + 3;
  for (std::int64_t i = 0; i < steps; ++i) {
    trajectory.push(route.pose(from_m + speed_m_s * to_seconds(i * kStep)));
  }
  return trajectory;
}

std::vector<LaserScan> scan_street(const std::filesystem::path& scenario_file,
                                   const StreetDrive& drive) {
  const scenarios::Scenario scenario = scenarios::load_scenario(scenario_file);
  const scenarios::Stage stage = scenarios::build_stage(scenario);
  const sim::RayScene scene(stage.world, stage.actors);
  const scenarios::LidarSetup& setup = scenario.sensors.lidar.front();
  sim::Lidar lidar(setup.spec, setup.mount.pose(), 0, scenario.seed);
  const Duration period = lidar.spec().period();
  const Duration time = period * drive.scans_each;
  std::vector<LaserScan> scans;
  for (const double share : drive.at) {
    const double from_m = share * stage.route.length_m();
    if (from_m < 0.0 || from_m + drive.speed_m_s * to_seconds(time) > stage.route.length_m()) {
      throw InputError("street drive: place " + std::to_string(share) +
                       " leaves the route, needs one from 0 to a scan or so before 1");
    }
    const sim::Trajectory trajectory = drive_along(stage.route, from_m, drive.speed_m_s, time);
    for (int i = 0; i < drive.scans_each; ++i) {
      const Stamp start = trajectory.start() + period * i;
      LidarScan scan = lidar.start_scan(start);
      lidar.cast(scene, trajectory, start, scan.end, scan);
      scans.push_back(recover_lasers(in_kitti_order(scan)));
    }
  }
  return scans;
}

}  // namespace locsim::fidelity
