#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "benchmarks/fidelity/weather_loss.h"
#include "core/messages.h"
#include "core/pose.h"
#include "sim/lidar/lidar_spec.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "sim/weather/weather.h"

namespace locsim::fidelity {

struct NamedWeather {
  std::string name;
  sim::WeatherSpec weather;
};

/// Clear air, fog of 50 m, rain of 30 mm/h, snow of 2 mm/h, dust of 100 m.
[[nodiscard]] std::vector<NamedWeather> shown_weathers();

/// One scan in one weather, beside the same scan in clear air.
struct WeatherScan {
  std::string name;
  /// One way.
  double extinction_1_m = 0.0;
  LidarScan scan;
  /// One for each point of the scan.
  std::vector<Target> targets;
  WeatherMatch match;
  WeatherFigures figures;
};

/// Two measurements of one surface lie this near to each other: five standard deviations of the
/// range of an echo just seen, at least 0.3 m.
[[nodiscard]] double match_tolerance_m(const sim::LidarSpec& spec);

/// What every return of a scan comes from: the first surface along its ray, if it lies within
/// `tolerance_m` of the return. What lies behind panes has none. Walls are structures that stand
/// upright: facades, poles, trunks, not crowns.
[[nodiscard]] std::vector<Target> targets_of(const LidarScan& scan, const sim::RayScene& scene,
                                             const sim::Trajectory& trajectory,
                                             const Pose& T_vehicle_lidar, double tolerance_m);

/// A LIDAR on a car.
struct MountedLidar {
  sim::LidarSpec spec;
  Pose T_vehicle_lidar;
  std::uint64_t seed = 1;
};

/// One scan from the start of the trajectory in each weather, with the same noise and the same
/// actors. Throws InputError for weather or sensor beyond their limits.
[[nodiscard]] std::vector<WeatherScan> scan_weathers(std::span<const NamedWeather> weathers,
                                                     const MountedLidar& lidar,
                                                     const sim::RayScene& scene,
                                                     const sim::Trajectory& trajectory);

/// The scenario's first LIDAR half way along the route, in the weathers above instead of its own.
/// Throws InputError as load_scenario does.
[[nodiscard]] std::vector<WeatherScan> scan_weathers(const std::filesystem::path& scenario);

/// A Markdown table of all figures, a row a weather.
[[nodiscard]] std::string weather_table(std::span<const WeatherScan> scans);

}  // namespace locsim::fidelity
