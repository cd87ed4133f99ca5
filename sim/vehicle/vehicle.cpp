#include "sim/vehicle/vehicle.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/physics.h"
#include "sim/vehicle/bullet_types.h"
#include "sim/vehicle/obstacles.h"
#include "sim/vehicle/wheels.h"

namespace locsim::sim {

namespace {

constexpr double kSettleAtLeast_s = 2.0;
constexpr double kSettleAtMost_s = 20.0;
constexpr double kStill_m_s = 1e-5;

// The body's corners on the ground: as stiff as a step of 1.25 ms bears comfortably.
constexpr double kCornerStiffness_n_m = 2e5;
constexpr double kCornerDamping_n_s_m = 8e3;
constexpr double kCornerFriction = 0.6;
constexpr double kCornerProbe_m = 3.0;

VehicleSpec checked(const VehicleSpec& spec) {
  check_parameters(spec, "vehicle");
  return spec;
}

Vector3d ground_below(const GroundRays& ground, const Vector3d& p_map,
                      const std::string& place = "the start") {
  // A start may lie metres off in height (a logged GNSS height); the nearest ground is meant.
  for (const double reach_m : {3.0, 300.0}) {
    const Vector3d reach(0.0, 0.0, reach_m);
    if (const auto hit = ground.cast(p_map + reach, p_map - reach)) return hit->point;
  }
  throw InputError("vehicle: no ground below " + place + ", at x " + std::to_string(p_map.x()) +
                   " m, y " + std::to_string(p_map.y()) +
                   " m of the map; choose a place on the world's ground");
}

Pose standing_pose(const VehicleSpec& spec, const GroundRays& ground, const Pose& T_map_start) {
  const double yaw_rad = T_map_start.yaw();
  const Vector3d forward(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  const Vector3d left(-forward.y(), forward.x(), 0.0);
  const auto wheel = [&](double x_m, double side) {
    return ground_below(ground,
                        T_map_start.translation + x_m * forward + side * 0.5 * spec.track_m * left);
  };
  const Vector3d rear_left = wheel(0.0, 1.0);
  const Vector3d rear_right = wheel(0.0, -1.0);
  const Vector3d front = 0.5 * (wheel(spec.wheelbase_m, 1.0) + wheel(spec.wheelbase_m, -1.0));
  const Vector3d rear = 0.5 * (rear_left + rear_right);
  Matrix3d axes;
  axes.col(0) = (front - rear).normalized();
  axes.col(2) = axes.col(0).cross(rear_left - rear_right).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return {.rotation = Eigen::Quaterniond(axes).normalized(), .translation = rear};
}

}  // namespace

struct Vehicle::Impl {
  Impl(const VehicleSpec& spec_, const World& world, std::span<const Actor> actors)
      : spec(checked(spec_)),
        ground(world.ground),
        dispatcher(&configuration),
        physics(&dispatcher, &broadphase, &solver, &configuration),
        body_box({0.5 * spec.length_m, 0.5 * spec.width_m,
                  0.5 * (spec.height_m - spec.ground_clearance_m)}),
        T_vehicle_cog{.translation = {spec.cog_from_rear_m, 0.0, spec.cog_height_m}},
        chassis(spec.mass_kg, nullptr, &body_shape, as_bullet(spec.inertia_kg_m2)),
        wheels(spec, chassis, ground),
        obstacles(physics, world, actors) {
    const Vector3d box_center(0.5 * spec.length_m - spec.rear_overhang_m, 0.0,
                              0.5 * (spec.height_m + spec.ground_clearance_m));
    T_cog_box.translation = box_center - T_vehicle_cog.translation;
    body_shape.addChildShape(as_bullet(T_cog_box), &body_box);
    physics.setGravity({0.0, 0.0, -kGravity_m_s2});
    chassis.setActivationState(DISABLE_DEACTIVATION);
    chassis.setFriction(0.5);
    physics.addRigidBody(&chassis, Obstacles::kCarGroup, Obstacles::kObstacleGroup);
    chassis.setGravity({0.0, 0.0, -kGravity_m_s2});
  }
  ~Impl() { physics.removeRigidBody(&chassis); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void stand_at(const Pose& T_map_vehicle) {
    chassis.setWorldTransform(as_bullet(T_map_vehicle * T_vehicle_cog));
    chassis.setInterpolationWorldTransform(chassis.getWorldTransform());
  }

  // Of the ground below the wheels, on their mean, over the vehicle's own plane.
  [[nodiscard]] double ground_above_m(const Pose& T_map_vehicle) const {
    double sum_m = 0.0;
    for (const double x_m : {0.0, spec.wheelbase_m}) {
      for (const double side : {-0.5, 0.5}) {
        const Vector3d p_map = T_map_vehicle * Vector3d(x_m, side * spec.track_m, 0.0);
        sum_m += ground_below(ground, p_map, "where the car is set down").z() - p_map.z();
      }
    }
    return 0.25 * sum_m;
  }

  Pose set_down(const Pose& T_map_map) {
    const Pose T_map_vehicle = as_pose(chassis.getWorldTransform()) * T_vehicle_cog.inverse();
    Pose done = T_map_map;
    done.translation.z() +=
        ground_above_m(T_map_map * T_map_vehicle) - ground_above_m(T_map_vehicle);
    const btTransform motion = as_bullet(done);
    chassis.setLinearVelocity(motion.getBasis() * chassis.getLinearVelocity());
    chassis.setAngularVelocity(motion.getBasis() * chassis.getAngularVelocity());
    // Turns the inertia, too.
    chassis.setCenterOfMassTransform(motion * chassis.getWorldTransform());
    obstacles.move_to(as_eigen(chassis.getCenterOfMassPosition()));
    return done;
  }

  void move_actuators(const Controls& controls, double step_s) {
    const double wanted_rad =
        std::clamp(controls.steering_rad, -spec.steering_max_rad, spec.steering_max_rad);
    const double rate_rad_s =
        std::clamp((wanted_rad - steering_rad) / spec.steering_lag_s, -spec.steering_rate_max_rad_s,
                   spec.steering_rate_max_rad_s);
    steering_rad += rate_rad_s * step_s;
    const double wanted_m_s2 =
        std::clamp(controls.acceleration_m_s2, -spec.braking_max_m_s2, spec.acceleration_max_m_s2);
    acceleration_m_s2 += (wanted_m_s2 - acceleration_m_s2) * step_s / spec.acceleration_lag_s;
  }

  // Answers whether the body touches the ground.
  bool hold_above_ground(double step_s) {
    const btTransform& T_map_cog = chassis.getWorldTransform();
    if (!wheels.is_beyond_travel() && T_map_cog.getBasis()[2][2] > 0.9) return false;
    bool touches = false;
    const btVector3 half = body_box.getHalfExtentsWithMargin();
    for (int corner = 0; corner < 8; ++corner) {
      const btVector3 p_box((corner & 1) != 0 ? half.x() : -half.x(),
                            (corner & 2) != 0 ? half.y() : -half.y(),
                            (corner & 4) != 0 ? half.z() : -half.z());
      const Vector3d p_map = as_eigen(T_map_cog(p_box + as_bullet(T_cog_box.translation)));
      const auto hit = ground.cast(p_map + Vector3d(0.0, 0.0, kCornerProbe_m), p_map);
      if (!hit) continue;
      touches = true;
      const btVector3 lever = as_bullet(p_map) - chassis.getCenterOfMassPosition();
      const btVector3 velocity = chassis.getVelocityInLocalPoint(lever);
      const double force_n = std::max(0.0, kCornerStiffness_n_m * (hit->point.z() - p_map.z()) -
                                               kCornerDamping_n_s_m * velocity.z());
      const btVector3 slide(velocity.x(), velocity.y(), 0.0);
      const double regularised_m_s = std::hypot(slide.length(), 0.1);
      chassis.applyImpulse(
          (btVector3(0.0, 0.0, force_n) - slide * (kCornerFriction * force_n / regularised_m_s)) *
              step_s,
          lever);
    }
    return touches;
  }

  void step(const Controls& controls) {
    const double step_s = to_seconds(spec.step);
    move_actuators(controls, step_s);
    obstacles.move_to(as_eigen(chassis.getCenterOfMassPosition()));
    const double force_n = spec.mass_kg * acceleration_m_s2;
    // Forces from where the car is now, then velocity, then place: with the springs of the tyres
    // a standing car stays where it is.
    wheels.apply({.steering_rad = steering_rad,
                  .drive_n = std::max(0.0, force_n),
                  .brake_n = std::max(0.0, -force_n)},
                 step_s);
    const btVector3 velocity = chassis.getLinearVelocity();
    chassis.applyCentralImpulse(velocity * (-spec.drag_n_s2_m2 * velocity.length() * step_s));
    const bool touches_ground = hold_above_ground(step_s);
    physics.stepSimulation(step_s, /*maxSubSteps=*/0);
    obstacles.count_contacts(touches_ground, step_s);
  }

  VehicleSpec spec;
  GroundRays ground;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld physics;
  btBoxShape body_box;
  btCompoundShape body_shape;
  Pose T_vehicle_cog;
  Pose T_cog_box;
  btRigidBody chassis;
  Wheels wheels;
  Obstacles obstacles;
  double steering_rad = 0.0;
  double acceleration_m_s2 = 0.0;
};

Vehicle::Vehicle(const VehicleSpec& spec, const World& world, const Pose& T_map_vehicle_start,
                 std::span<const Actor> actors)
    : impl_(std::make_unique<Impl>(spec, world, actors)) {
  impl_->stand_at(standing_pose(impl_->spec, impl_->ground, T_map_vehicle_start));
  const Controls brake{.acceleration_m_s2 = -impl_->spec.braking_max_m_s2};
  impl_->acceleration_m_s2 = brake.acceleration_m_s2;
  const double step_s = to_seconds(impl_->spec.step);
  for (double t_s = 0.0; t_s < kSettleAtMost_s; t_s += step_s) {
    impl_->step(brake);
    if (t_s > kSettleAtLeast_s && impl_->chassis.getLinearVelocity().length() < kStill_m_s &&
        impl_->chassis.getAngularVelocity().length() < kStill_m_s) {
      break;
    }
  }
}

Vehicle::~Vehicle() = default;
Vehicle::Vehicle(Vehicle&&) noexcept = default;

void Vehicle::step(const Controls& controls) {
  assert(std::isfinite(controls.steering_rad) && std::isfinite(controls.acceleration_m_s2));
  impl_->step(controls);
}

Pose Vehicle::set_down(const Pose& T_map_map) {
  return impl_->set_down(T_map_map);
}

void Vehicle::set_actor_poses(std::span<const Pose> T_map_actor) {
  impl_->obstacles.set_actor_poses(T_map_actor);
}

const VehicleSpec& Vehicle::spec() const {
  return impl_->spec;
}

Pose Vehicle::T_map_vehicle() const {
  return as_pose(impl_->chassis.getWorldTransform()) * impl_->T_vehicle_cog.inverse();
}

Vector3d Vehicle::velocity_m_s() const {
  const btVector3 lever = impl_->chassis.getWorldTransform().getBasis() *
                          as_bullet(Vector3d(-impl_->T_vehicle_cog.translation));
  return as_eigen(impl_->chassis.getVelocityInLocalPoint(lever));
}

Vector3d Vehicle::angular_rate_rad_s() const {
  return T_map_vehicle().rotation.conjugate() * as_eigen(impl_->chassis.getAngularVelocity());
}

double Vehicle::speed_m_s() const {
  return velocity_m_s().dot(T_map_vehicle().rotation * Vector3d::UnitX());
}

double Vehicle::steering_rad() const {
  return impl_->steering_rad;
}

std::array<double, 4> Vehicle::wheel_loads_n() const {
  return impl_->wheels.loads_n();
}

int Vehicle::collisions() const {
  return impl_->obstacles.contacts_begun();
}

}  // namespace locsim::sim
