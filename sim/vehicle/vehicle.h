#pragma once

#include <array>
#include <memory>
#include <span>

#include "sim/actors.h"
#include "sim/vehicle/controls.h"
#include "sim/vehicle/vehicle_spec.h"
#include "sim/world/world.h"

namespace locsim::sim {

/// A car on the world's ground: Bullet's raycast vehicle (body, four sprung wheels, rays down to
/// the ground mesh) with the side and brake forces of `Tyre`, stepped at a fixed rate.
///
/// The `vehicle` frame: x forward, y left, z up, origin on the ground plane below the middle of
/// the rear axle when the car stands on level ground. It is fixed to the body: it pitches, rolls
/// and heaves with it.
///
/// Steering turns the front wheels by Ackermann's law about a common point. The brake's force is
/// shared among the wheels by their load. Wheels feel the ground only; the body feels colliders
/// and actors, and the ground by its eight corners once a wheel has lost it or the bump stop is
/// reached. The same inputs give the same bytes.
class Vehicle {
 public:
  /// Stands the car on the ground below `T_map_vehicle_start` (its yaw is kept to the millimetre
  /// and its place too, height and tilt come from the ground) and lets the suspension settle with
  /// the brake on, so that it stands still at the first step.
  /// `world` must outlive the car. `actors` tell which shape each moving actor wears.
  /// Throws InputError where a value of `spec` is out of range, where a wheel has no ground below
  /// it, or where an actor's shape is unknown.
  Vehicle(const VehicleSpec& spec, const World& world, const Pose& T_map_vehicle_start,
          std::span<const Actor> actors = {});
  ~Vehicle();
  Vehicle(Vehicle&&) noexcept;

  /// Advances by `spec().step`. `controls` must be finite.
  void step(const Controls& controls);

  /// Sets the car down elsewhere between two steps: `T_map_map`, which turns about the vertical
  /// only, takes it there with the speed and the rates that it has in its own frame. Its height
  /// follows from the ground: on the mean of the four wheels the same as before. Answers what was
  /// done, `T_map_map` with that height. Throws InputError where a wheel has no ground below it.
  Pose set_down(const Pose& T_map_map);

  /// Puts the boxes of the moving actors: one T_map_actor for each actor given at construction,
  /// in order. Throws std::invalid_argument at another number.
  void set_actor_poses(std::span<const Pose> T_map_actor);

  [[nodiscard]] const VehicleSpec& spec() const;
  [[nodiscard]] Pose T_map_vehicle() const;
  /// Of the vehicle frame's origin, in the map frame.
  [[nodiscard]] Vector3d velocity_m_s() const;
  /// In the vehicle frame.
  [[nodiscard]] Vector3d angular_rate_rad_s() const;
  /// Along the vehicle's x axis; negative when it rolls back.
  [[nodiscard]] double speed_m_s() const;
  /// As the actuator has turned the wheels by now (bicycle model).
  [[nodiscard]] double steering_rad() const;
  /// Front left, front right, rear left, rear right.
  [[nodiscard]] std::array<double, 4> wheel_loads_n() const;
  /// Contacts begun between the body and colliders, actors or the ground. Touching the same thing
  /// again counts after a second apart. Wheels on the ground or over a kerb do not count.
  [[nodiscard]] int collisions() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace locsim::sim
