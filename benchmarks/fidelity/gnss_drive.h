#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/messages.h"
#include "scenarios/scenario.h"
#include "scenarios/stage.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "sim/world/route.h"

namespace locsim::fidelity {

/// A satellite above the horizon at one epoch, as the receiver had it.
struct SatelliteRecord {
  SatelliteId id;
  double elevation_rad = 0.0;
  /// Whether the straight way was open; ways in all.
  bool is_direct = false;
  std::size_t paths = 0;
  /// Of the strongest way as it comes to the antenna: reflections, excess, power over a clear one.
  int turns = 0;
  double excess_m = 0.0;
  double power_db = 0.0;
  bool is_tracked = false;
  /// Where tracked: positive where the signal seems late; without clocks, orbits and atmosphere.
  double code_error_m = 0.0;
  double range_rate_error_m_s = 0.0;
  double cn0_db_hz = 0.0;
};

/// A fix against the antenna's truth, east, north, up.
struct FixRecord {
  Vector3d error_m = Vector3d::Zero();
  Vector3d velocity_error_m_s = Vector3d::Zero();
  /// As the receiver claims.
  Matrix3d covariance_m2 = Matrix3d::Zero();
};

struct EpochRecord {
  Stamp time;
  /// Along the route.
  double s_m = 0.0;
  double speed_m_s = 0.0;
  std::vector<SatelliteRecord> satellites;
  /// Nothing without a fix.
  std::optional<FixRecord> fix;
};

/// What a receiver made of a drive, epoch by epoch.
struct GnssDrive {
  Duration period{1'000'000'000};
  std::vector<EpochRecord> epochs;
};

/// The car in the middle of its lane by the route's speeds and stops, from `start` to the end of
/// the route, each stretch between two of the route's points at constant acceleration.
[[nodiscard]] sim::Trajectory drive_route(const sim::Route& route, Stamp start = Stamp{});

/// The scenario's receiver carried along `trajectory`. `scene` holds the stage's world and actors.
/// The sky is that of `later` after the scenario's date.
[[nodiscard]] GnssDrive drive_gnss(const scenarios::Scenario& scenario,
                                   const scenarios::Stage& stage, const sim::RayScene& scene,
                                   const sim::Trajectory& trajectory, std::uint64_t seed,
                                   Duration later = Duration{0});

}  // namespace locsim::fidelity
