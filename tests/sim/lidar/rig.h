#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/messages.h"
#include "sim/lidar/lidar.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "sim/world/world.h"
#include "tests/sim/lidar/specs.h"

namespace locsim::sim {

inline constexpr double kPi = std::numbers::pi;

/// A world whose material 0 sends everything back, by Lambert's law.
inline World bright_world() {
  World world;
  world.materials = {{.name = "white", .reflectivity_905nm = 1.0, .roughness_rad = 0.0}};
  return world;
}

/// One revolution and a little more of `motion`, at the step of a physics engine.
inline Trajectory make_trajectory(const std::function<Pose(double)>& motion, double until_s = 0.3) {
  constexpr Duration kStep{2'500'000};
  Trajectory trajectory(Stamp{}, kStep);
  for (int i = 0; to_seconds(kStep) * (i - 2) < until_s; ++i) {
    trajectory.push(motion(to_seconds(kStep) * i));
  }
  return trajectory;
}

inline Trajectory standing_still() {
  return make_trajectory([](double) { return Pose{}; });
}

/// Ranges with Gaussian errors of 2 cm, the same at any power, and no others; a 90 % target is seen
/// to 100 m.
inline LidarSpec plainly_noisy(LidarSpec spec) {
  spec.range_noise_m = 0.02;
  spec.weak_range_noise_m = 0.0;
  spec.detection_range_m = 100.0;
  spec.detection_reflectivity = 0.9;
  spec.effects.beam_bias = false;
  spec.effects.quantisation = false;
  return spec;
}

/// Ranges without random, constant and rounding errors, of all that is met.
inline LidarSpec noiseless(LidarSpec spec) {
  spec.effects.noise = false;
  spec.effects.beam_bias = false;
  spec.effects.quantisation = false;
  spec.effects.detection_limit = false;
  return spec;
}

inline LidarScan one_scan(Lidar lidar, const RayScene& scene, const Trajectory& trajectory,
                          Stamp start = Stamp{}) {
  LidarScan scan = lidar.start_scan(start);
  lidar.cast(scene, trajectory, scan.start, scan.end, scan);
  return scan;
}

/// A ray as the data sheet has it, from the beam's angles and the rotation until it fires.
struct NominalRay {
  Duration since_start;
  std::uint16_t ring = 0;
  /// Lidar frame.
  Vector3d direction;
};

inline Vector3d nominal_direction(const LidarSpec& spec, const LidarBeam& beam,
                                  Duration since_start) {
  const double turned_rad =
      (spec.clockwise ? -2.0 : 2.0) * kPi * spec.rate_hz * to_seconds(since_start);
  const double azimuth_rad = spec.start_azimuth_rad + turned_rad + beam.azimuth_offset_rad;
  return {std::cos(beam.elevation_rad) * std::cos(azimuth_rad),
          std::cos(beam.elevation_rad) * std::sin(azimuth_rad), std::sin(beam.elevation_rad)};
}

inline std::vector<NominalRay> nominal_rays(const LidarSpec& spec) {
  const auto rings = spec.rings();
  std::vector<NominalRay> rays;
  for (std::size_t cycle = 0; cycle < spec.cycles(); ++cycle) {
    for (std::size_t b = 0; b < spec.beams.size(); ++b) {
      const Duration time =
          spec.cycle * static_cast<std::int64_t>(cycle) + spec.beams[b].firing_time;
      rays.push_back({.since_start = time,
                      .ring = rings[b],
                      .direction = nominal_direction(spec, spec.beams[b], time)});
    }
  }
  return rays;
}

/// Range at which a ray from outside meets the box |x| ≤ half extent, or leaves it from inside.
inline double box_range_m(const Vector3d& origin, const Vector3d& direction,
                          const Vector3d& half_extent_m) {
  const Eigen::Array3d a = (-half_extent_m - origin).array() / direction.array();
  const Eigen::Array3d b = (half_extent_m - origin).array() / direction.array();
  const double enter_m = a.min(b).maxCoeff();
  const double leave_m = a.max(b).minCoeff();
  if (enter_m > leave_m || leave_m <= 0.0) return std::numeric_limits<double>::infinity();
  return enter_m > 0.0 ? enter_m : leave_m;
}

/// Ranges by the closed form for every ray of a scan against the scan: the points must be exactly
/// those rays whose closed form lies within the limits, each within `tolerance_m`. Rays that
/// `expected_m` answers with nothing are too near an edge to tell. Returns how many were compared.
struct Comparison {
  std::size_t compared = 0;
  std::size_t missing = 0;
  std::size_t unexpected = 0;
  double largest_error_m = 0.0;
};

inline Comparison compare(
    const LidarSpec& spec, const LidarScan& scan,
    const std::function<std::optional<double>(const NominalRay&)>& expected_m) {
  Comparison result;
  auto point = scan.points.begin();
  for (const NominalRay& ray : nominal_rays(spec)) {
    const bool is_there = point != scan.points.end() &&
                          Duration{point->time_ns} == ray.since_start && point->ring == ray.ring;
    const std::optional<double> range_m = expected_m(ray);
    if (range_m) {
      const bool is_due = *range_m >= spec.range_min_m && *range_m <= spec.range_max_m;
      if (is_due && !is_there) ++result.missing;
      if (!is_due && is_there) ++result.unexpected;
      if (is_due && is_there) {
        ++result.compared;
        const double error_m = (point->position() - *range_m * ray.direction).norm();
        result.largest_error_m = std::max(result.largest_error_m, error_m);
      }
    }
    if (is_there) ++point;
  }
  result.unexpected += static_cast<std::size_t>(scan.points.end() - point);
  return result;
}

}  // namespace locsim::sim
