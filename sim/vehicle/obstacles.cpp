#include "sim/vehicle/obstacles.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletDynamics/Dynamics/btDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/error.h"
#include "sim/vehicle/bullet_types.h"

namespace locsim::sim {

namespace {

constexpr double kReach_m = 25.0;
constexpr double kRefreshEvery_m = 10.0;
constexpr double kApart_s = 1.0;
constexpr int kGroundId = -2;

// A box that stands in the physics world while it lives.
class Box {
 public:
  Box(btDynamicsWorld& physics, const Pose& T_map_box, const Vector3d& half_extent_m, int id)
      : physics_(physics), shape_(as_bullet(half_extent_m)), body_(0.0, nullptr, &shape_) {
    body_.setWorldTransform(as_bullet(T_map_box));
    body_.setUserIndex(id);
    body_.setFriction(0.5);
    physics_.addRigidBody(&body_, Obstacles::kObstacleGroup, Obstacles::kCarGroup);
  }
  ~Box() { physics_.removeRigidBody(&body_); }
  Box(const Box&) = delete;
  Box& operator=(const Box&) = delete;

  void move(const Pose& T_map_box) {
    body_.setWorldTransform(as_bullet(T_map_box));
    physics_.updateSingleAabb(&body_);
  }

 private:
  btDynamicsWorld& physics_;
  btBoxShape shape_;
  btRigidBody body_;
};

}  // namespace

struct Obstacles::Impl {
  btDynamicsWorld& physics;
  const std::vector<Collider>& colliders;
  std::vector<Vector3d> actor_half_extents_m;
  Vector3d place = Vector3d::Zero();
  std::optional<Vector3d> refreshed_at;
  // Ordered, so that bodies enter the physics world in the same order every time.
  std::map<int, std::unique_ptr<Box>> boxes;
  std::map<int, double> touched_at_s;
  double now_s = 0.0;
  int contacts_begun = 0;

  [[nodiscard]] bool near(const Vector3d& center, double radius_m, double reach_m) const {
    return (center - place).squaredNorm() < (reach_m + radius_m) * (reach_m + radius_m);
  }
  void hold(int id, bool wanted, const Pose& T_map_box, const Vector3d& half_extent_m) {
    const auto found = boxes.find(id);
    if (!wanted) {
      if (found != boxes.end()) boxes.erase(found);
    } else if (found == boxes.end()) {
      boxes.emplace(id, std::make_unique<Box>(physics, T_map_box, half_extent_m, id));
    } else {
      found->second->move(T_map_box);
    }
  }
  void touch(int id) {
    const auto [entry, is_new] = touched_at_s.try_emplace(id, now_s);
    if (is_new || now_s - entry->second > kApart_s) ++contacts_begun;
    entry->second = now_s;
  }
};

Obstacles::Obstacles(btDynamicsWorld& physics, const World& world, std::span<const Actor> actors)
    : impl_(new Impl{.physics = physics,
                     .colliders = world.colliders,
                     .actor_half_extents_m = {},
                     .refreshed_at = {},
                     .boxes = {},
                     .touched_at_s = {}}) {
  for (const Actor& actor : actors) {
    if (actor.shape >= world.actor_half_extents_m.size()) {
      throw InputError("traffic: an actor wears shape " + std::to_string(actor.shape) +
                       ", but the world has " + std::to_string(world.actor_half_extents_m.size()));
    }
    impl_->actor_half_extents_m.push_back(world.actor_half_extents_m[actor.shape]);
  }
}

Obstacles::~Obstacles() = default;

void Obstacles::move_to(const Vector3d& p_map) {
  impl_->place = p_map;
  if (impl_->refreshed_at &&
      (p_map - *impl_->refreshed_at).squaredNorm() < kRefreshEvery_m * kRefreshEvery_m) {
    return;
  }
  impl_->refreshed_at = p_map;
  for (std::size_t i = 0; i < impl_->colliders.size(); ++i) {
    const Collider& c = impl_->colliders[i];
    const int id = static_cast<int>(i);
    const bool wanted = impl_->near(c.T_map_box.translation, c.half_extent_m.norm(), kReach_m);
    if (wanted != impl_->boxes.contains(id)) impl_->hold(id, wanted, c.T_map_box, c.half_extent_m);
  }
}

void Obstacles::set_actor_poses(std::span<const Pose> T_map_actor) {
  if (T_map_actor.size() != impl_->actor_half_extents_m.size()) {
    throw std::invalid_argument("Vehicle::set_actor_poses: " + std::to_string(T_map_actor.size()) +
                                " poses for " + std::to_string(impl_->actor_half_extents_m.size()) +
                                " actors");
  }
  for (std::size_t i = 0; i < T_map_actor.size(); ++i) {
    const Vector3d& half = impl_->actor_half_extents_m[i];
    // The actor's origin is on the ground below it.
    const Pose T_map_box = T_map_actor[i] * Pose{.translation = {0.0, 0.0, half.z()}};
    const int id = static_cast<int>(impl_->colliders.size() + i);
    impl_->hold(id, impl_->near(T_map_box.translation, half.norm(), kReach_m), T_map_box, half);
  }
}

void Obstacles::count_contacts(bool touches_ground, double step_s) {
  impl_->now_s += step_s;
  if (touches_ground) impl_->touch(kGroundId);
  btDispatcher& dispatcher = *impl_->physics.getDispatcher();
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      if (manifold.getContactPoint(k).getDistance() > 0.0) continue;
      // The car's own index is −1.
      impl_->touch(
          std::max(manifold.getBody0()->getUserIndex(), manifold.getBody1()->getUserIndex()));
      break;
    }
  }
}

int Obstacles::contacts_begun() const {
  return impl_->contacts_begun;
}

}  // namespace locsim::sim
