#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/gnss/gnss.h"
#include "sim/ray_scene.h"
#include "sim/world/materials.h"
#include "tests/sim/imu/analytic_trajectory.h"

namespace locsim::sim {

inline const LocalFrame kHongKong({.latitude_rad = 0.3892,
                                   .longitude_rad = 1.9927,
                                   .height_m = 10.0});
inline const GpsTime kNoon = GpsTime::from_utc("2026-06-01T04:00:00Z");

/// A plain of asphalt, two kilometres wide.
inline World open_world() {
  World world;
  world.materials = town_materials();
  world.ground.add_quad({-1000.0, -1000.0, 0.0}, {1000.0, -1000.0, 0.0}, {1000.0, 1000.0, 0.0},
                        {-1000.0, 1000.0, 0.0}, id(TownMaterial::asphalt));
  return world;
}

/// The plain with a street of concrete towers along x, `width_m` wide.
inline World street_world(double width_m, double height_m) {
  World world = open_world();
  for (const double side : {-1.0, 1.0}) {
    const Pose middle{.translation = {0.0, side * (0.5 * width_m + 5.0), 0.5 * height_m}};
    add_box(world.structures, middle, {900.0, 5.0, 0.5 * height_m}, id(TownMaterial::concrete));
  }
  return world;
}

/// Everything that errs switched off.
inline GnssSpec flawless_receiver() {
  GnssSpec spec;
  spec.errors = {.signal_in_space = false,
                 .ionosphere = false,
                 .troposphere = false,
                 .scene = false,
                 .thermal = false,
                 .receiver_clock = false};
  return spec;
}

inline constexpr double kAntennaHeight_m = 1.6;

inline std::vector<GnssOutput> outputs_of(const GnssSpec& spec, const World& world,
                                          const Trajectory& trajectory, std::uint64_t seed = 1,
                                          const Faults& faults = {},
                                          const Vector3d& antenna_in_vehicle_m = {
                                              0.0, 0.0, kAntennaHeight_m}) {
  const RayScene scene(world, {});
  std::vector<GnssOutput> out;
  Gnss(spec, antenna_in_vehicle_m, world, scene, kHongKong, kNoon, seed, faults)
      .sample(trajectory, trajectory.start(), trajectory.end(), out);
  return out;
}

/// Position of a fix less where an antenna is that stands on the vehicle's origin.
inline Vector3d error_of(const GnssFix& fix, const Trajectory& trajectory) {
  return kHongKong.to_map(fix.position) -
         (trajectory.pose_at(fix.time) * Vector3d(0.0, 0.0, kAntennaHeight_m));
}

}  // namespace locsim::sim
