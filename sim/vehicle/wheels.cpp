#include "sim/vehicle/wheels.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Vehicle/btRaycastVehicle.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/physics.h"
#include "sim/vehicle/bullet_types.h"

namespace locsim::sim {

namespace {

// Steeper faces (kerbs) lift the wheel but do not push it: a ray has no radius to roll over them.
constexpr double kLeastNormalCosine = 0.7;
constexpr double kBumpStiffnessRatio = 12.0;

}  // namespace

// Bullet's wheel rays on the ground mesh alone.
class Wheels::Raycaster final : public btVehicleRaycaster {
 public:
  explicit Raycaster(const GroundRays& ground) : ground_(ground) {}
  void* castRay(const btVector3& from, const btVector3& to,
                btVehicleRaycasterResult& result) override;

 private:
  const GroundRays& ground_;
};

class Wheels::Car final : public btRaycastVehicle {
 public:
  Car(const VehicleSpec& spec, btRigidBody* chassis, btVehicleRaycaster* raycaster);

  // Called by Bullet after the suspension.
  void updateFriction(btScalar step_s) override;

  // All forces follow from the motion at the start of the step; impulses applied within it must
  // not show, or a standing car would creep.
  void start_step(const AppliedControls& applied) {
    controls_ = applied;
    velocity_ = getRigidBody()->getLinearVelocity();
    spin_ = getRigidBody()->getAngularVelocity();
  }

  std::array<double, 4> loads_n{};
  bool beyond_travel = false;

 private:
  void update_loads(btScalar step_s);

  AppliedControls controls_;
  btVector3 velocity_{0, 0, 0};
  btVector3 spin_{0, 0, 0};
  VehicleSpec spec_;
  std::array<Tyre, 4> tyres_;
};

void* Wheels::Raycaster::castRay(const btVector3& from, const btVector3& to,
                                 btVehicleRaycasterResult& result) {
  const Vector3d start = as_eigen(from);
  const Vector3d end = as_eigen(to);
  const auto hit = ground_.cast(start, end);
  if (!hit) return nullptr;
  const Vector3d up = (start - end).normalized();
  result.m_hitPointInWorld = as_bullet(hit->point);
  result.m_hitNormalInWorld =
      as_bullet(hit->normal.dot(up) < kLeastNormalCosine ? up : hit->normal);
  result.m_distFraction = (hit->point - start).norm() / (end - start).norm();
  return this;  // Bullet only asks whether it is null
}

Wheels::Car::Car(const VehicleSpec& spec, btRigidBody* chassis, btVehicleRaycaster* raycaster)
    : btRaycastVehicle({}, chassis, raycaster),
      spec_(spec),
      tyres_{Tyre(spec.front_tyre), Tyre(spec.front_tyre), Tyre(spec.rear_tyre),
             Tyre(spec.rear_tyre)} {
  setCoordinateSystem(/*right=*/1, /*up=*/2, /*forward=*/0);
  const auto stiffness_n_m = spec.wheel_stiffness_n_m();
  const auto load_n = spec.static_load_n();
  for (std::size_t wheel = 0; wheel < 4; ++wheel) {
    const std::size_t axle = wheel / 2;
    const double x_m = (axle == 0 ? spec.wheelbase_m : 0.0) - spec.cog_from_rear_m;
    const double y_m = (wheel % 2 == 0 ? 0.5 : -0.5) * spec.track_m;
    // The ray starts high in the body, so that a wheel pushed up never loses the ground.
    const double mount_above_ground_m = spec.height_m;
    const double deflection_m = load_n[axle] / stiffness_n_m[axle];
    const double free_length_m = mount_above_ground_m - spec.wheel_radius_m + deflection_m;
    // Bullet takes stiffness and damping over the car's mass, travel from the free length.
    btVehicleTuning tuning;
    const double critical_n_s_m =
        2.0 * std::sqrt(stiffness_n_m[axle] * load_n[axle] / kGravity_m_s2);
    tuning.m_suspensionStiffness = stiffness_n_m[axle] / spec.mass_kg;
    tuning.m_suspensionCompression = spec.damping_ratio_compression * critical_n_s_m / spec.mass_kg;
    tuning.m_suspensionDamping = spec.damping_ratio_rebound * critical_n_s_m / spec.mass_kg;
    tuning.m_maxSuspensionTravelCm = 100.0 * (deflection_m + spec.bump_travel_m);
    tuning.m_maxSuspensionForce = 1e6;
    addWheel({x_m, y_m, mount_above_ground_m - spec.cog_height_m}, {0, 0, -1}, {0, -1, 0},
             free_length_m, spec.wheel_radius_m, tuning, axle == 0);
  }
}

void Wheels::Car::update_loads(btScalar step_s) {
  beyond_travel = false;
  const auto stiffness_n_m = spec_.wheel_stiffness_n_m();
  btRigidBody& body = *getRigidBody();
  for (std::size_t wheel = 0; wheel < 4; ++wheel) {
    const btWheelInfo& info = m_wheelInfo[static_cast<int>(wheel)];
    const auto& ray = info.m_raycastInfo;
    loads_n[wheel] = ray.m_isInContact ? info.m_wheelsSuspensionForce : 0.0;
    if (!ray.m_isInContact) {
      beyond_travel = true;
      continue;
    }
    const double length_m = (ray.m_contactPointWS - ray.m_hardPointWS).dot(ray.m_wheelDirectionWS) -
                            info.m_wheelsRadius;
    const double beyond_m =
        info.m_suspensionRestLength1 - 0.01 * info.m_maxSuspensionTravelCm - length_m;
    if (beyond_m <= 0.0) continue;
    beyond_travel = true;
    const double stop_n = kBumpStiffnessRatio * stiffness_n_m[wheel / 2] * beyond_m;
    loads_n[wheel] += stop_n;
    body.applyImpulse(ray.m_contactNormalWS * (stop_n * step_s),
                      ray.m_contactPointWS - body.getCenterOfMassPosition());
  }
}

void Wheels::Car::updateFriction(btScalar step_s) {
  update_loads(step_s);
  const double total_n = std::accumulate(loads_n.begin(), loads_n.end(), 0.0);
  const double curvature_1_m = std::tan(controls_.steering_rad) / spec_.wheelbase_m;
  btRigidBody& body = *getRigidBody();
  const btMatrix3x3& axes = body.getWorldTransform().getBasis();
  const btVector3 up = axes.getColumn(2);
  for (std::size_t wheel = 0; wheel < 4; ++wheel) {
    const bool is_front = wheel < 2;
    const auto& ray = m_wheelInfo[static_cast<int>(wheel)].m_raycastInfo;
    // Ackermann: both front wheels turn about the same point on the rear axle's line.
    const double y_m = (wheel % 2 == 0 ? 0.5 : -0.5) * spec_.track_m;
    const double steering_rad =
        is_front ? std::atan2(spec_.wheelbase_m * curvature_1_m, 1.0 - curvature_1_m * y_m) : 0.0;
    const btVector3& normal = ray.m_contactNormalWS;
    btVector3 forward = axes * btVector3(std::cos(steering_rad), std::sin(steering_rad), 0.0);
    forward = (forward - normal * normal.dot(forward)).normalized();
    const btVector3 left = normal.cross(forward);

    btVector3 lever = ray.m_contactPointWS - body.getCenterOfMassPosition();
    const btVector3 velocity = velocity_ + spin_.cross(lever);
    const TyreForce force = tyres_[wheel].step(
        {.normal_n = loads_n[wheel],
         .forward_m_s = velocity.dot(forward),
         .left_m_s = velocity.dot(left),
         .drive_n = is_front ? 0.5 * controls_.drive_n : 0.0,
         .brake_n = total_n > 0.0 ? controls_.brake_n * loads_n[wheel] / total_n : 0.0},
        step_s);
    body.applyImpulse(forward * (force.forward_n * step_s), lever);
    lever -= up * (up.dot(lever) * (1.0 - spec_.roll_lever_share));
    body.applyImpulse(left * (force.left_n * step_s), lever);
  }
}

Wheels::Wheels(const VehicleSpec& spec, btRigidBody& chassis, const GroundRays& ground)
    : raycaster_(std::make_unique<Raycaster>(ground)),
      car_(std::make_unique<Car>(spec, &chassis, raycaster_.get())) {}

Wheels::~Wheels() = default;

void Wheels::apply(const AppliedControls& controls, double step_s) {
  car_->start_step(controls);
  car_->updateVehicle(step_s);
}

const std::array<double, 4>& Wheels::loads_n() const {
  return car_->loads_n;
}

bool Wheels::is_beyond_travel() const {
  return car_->beyond_travel;
}

}  // namespace locsim::sim
