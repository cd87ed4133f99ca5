#include "benchmarks/fidelity/weather_scans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "benchmarks/fidelity/simulated_street.h"
#include "scenarios/scenario.h"
#include "scenarios/stage.h"
#include "sim/lidar/lidar.h"

namespace locsim::fidelity {

namespace {

Target target_of(const sim::Hit& hit) {
  // A wall leans by a few degrees at most.
  constexpr double kUpright = 0.1;
  if (hit.surface == sim::Surface::ground) return Target::ground;
  const bool is_upright = std::abs(hit.normal.z()) < kUpright;
  return hit.surface == sim::Surface::structures && is_upright ? Target::wall : Target::other;
}

LidarScan scan_in(const sim::Weather& weather, const MountedLidar& lidar,
                  const sim::RayScene& scene, const sim::Trajectory& trajectory) {
  sim::Lidar sensor(lidar.spec, lidar.T_vehicle_lidar, 0, lidar.seed, weather);
  LidarScan scan = sensor.start_scan(trajectory.start());
  sensor.cast(scene, trajectory, scan.start, scan.end, scan);
  return scan;
}

template <typename... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 256> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

std::string reach_text(const Reach& reach) {
  return reach.kept == 0 ? "nowhere" : text("%.1f, %.1f", reach.p95_m, reach.farthest_m);
}

}  // namespace

std::vector<NamedWeather> shown_weathers() {
  return {{"clear air", {}},
          {"fog, visibility 50 m", {.fog_visibility_m = 50.0}},
          {"rain, 30 mm/h", {.rain_mm_h = 30.0}},
          {"snow, 2 mm/h", {.snow_mm_h = 2.0}},
          {"dust, visibility 100 m", {.dust_visibility_m = 100.0}}};
}

double match_tolerance_m(const sim::LidarSpec& spec) {
  return std::max(0.3, 5.0 * std::hypot(spec.range_noise_m, spec.weak_range_noise_m));
}

std::vector<Target> targets_of(const LidarScan& scan, const sim::RayScene& scene,
                               const sim::Trajectory& trajectory, const Pose& T_vehicle_lidar,
                               double tolerance_m) {
  std::vector<Target> targets;
  targets.reserve(scan.points.size());
  for (const LidarPoint& point : scan.points) {
    const Stamp fired = scan.start + Duration{point.time_ns};
    const Pose T_map_lidar = trajectory.pose_at(fired) * T_vehicle_lidar;
    const double range_m = point.position().norm();
    const Vector3d direction = T_map_lidar.rotation * (point.position() / range_m);
    const std::optional<sim::Hit> hit =
        scene.cast(T_map_lidar.translation, direction, fired, range_m + tolerance_m);
    targets.push_back(hit && hit->range_m > range_m - tolerance_m ? target_of(*hit) : Target::none);
  }
  return targets;
}

std::vector<WeatherScan> scan_weathers(std::span<const NamedWeather> weathers,
                                       const MountedLidar& lidar, const sim::RayScene& scene,
                                       const sim::Trajectory& trajectory) {
  const double tolerance_m = match_tolerance_m(lidar.spec);
  const LidarScan clear = scan_in({}, lidar, scene, trajectory);
  const auto targets = [&](const LidarScan& scan) {
    return targets_of(scan, scene, trajectory, lidar.T_vehicle_lidar, tolerance_m);
  };
  const std::vector<Target> clear_targets = targets(clear);
  std::vector<WeatherScan> scans;
  for (const NamedWeather& named : weathers) {
    const sim::Weather weather({named.weather}, clear.start);
    WeatherScan& scan = scans.emplace_back();
    scan.name = named.name;
    scan.extinction_1_m = weather.at(clear.start).extinction_1_m;
    scan.scan = scan_in(weather, lidar, scene, trajectory);
    scan.targets = targets(scan.scan);
    scan.match = match_returns(clear, scan.scan, tolerance_m);
    scan.figures = weather_figures({clear, clear_targets}, {scan.scan, scan.targets}, scan.match,
                                   scan.extinction_1_m);
  }
  return scans;
}

std::vector<WeatherScan> scan_weathers(const std::filesystem::path& scenario_file) {
  const scenarios::Scenario scenario = scenarios::load_scenario(scenario_file);
  const scenarios::Stage stage = scenarios::build_stage(scenario);
  const sim::RayScene scene(stage.world, stage.actors);
  const scenarios::LidarSetup& setup = scenario.sensors.lidar.front();
  const double half_way_m = 0.5 * stage.route.length_m();
  const sim::Trajectory trajectory = drive_along(
      stage.route, half_way_m, stage.route.at(half_way_m).speed_m_s, setup.spec.period());
  return scan_weathers(
      shown_weathers(),
      {.spec = setup.spec, .T_vehicle_lidar = setup.mount.pose(), .seed = scenario.seed}, scene,
      trajectory);
}

std::string weather_table(std::span<const WeatherScan> scans) {
  std::string table =
      "| air | α [1/m] | returns | of the clear ones lost | of these the ray ends elsewhere "
      "| false at 0–2 / 2–5 / 5–10 / >10 m | other surfaces | ground seen to: 95 %, farthest [m] "
      "| walls seen to [m] | intensity left, mean | by e^(−2αR) |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const WeatherScan& scan : scans) {
    const WeatherFigures& f = scan.figures;
    const auto& bands = f.false_by_range;
    table += text("| %s | %.2e | %zu | %zu (%.1f %%) | %zu | %zu / %zu / %zu / %zu | %zu ",
                  scan.name.c_str(), scan.extinction_1_m, f.returns, f.lost, 100.0 * f.lost_share(),
                  f.replaced, bands[0], bands[1], bands[2], bands[3], f.other_surfaces);
    table += text("| %s | %s | %.4f | %.4f |\n", reach_text(f.ground).c_str(),
                  reach_text(f.walls).c_str(), f.intensity_ratio, f.expected_ratio);
  }
  return table;
}

}  // namespace locsim::fidelity
