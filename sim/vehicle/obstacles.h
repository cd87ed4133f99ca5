#pragma once

#include <memory>
#include <span>

#include "sim/actors.h"
#include "sim/world/world.h"

class btDynamicsWorld;

namespace locsim::sim {

/// What the body of the car can hit: the world's colliders and the moving actors, as boxes that
/// give way to nothing. Only those near the car stand in the physics world, so a step costs the
/// same in a town of any size. Bodies collide with group `kCarGroup` alone.
class Obstacles {
 public:
  static constexpr int kCarGroup = 1;
  static constexpr int kObstacleGroup = 2;

  /// All must outlive this. `actors` only tell which shape each wears.
  Obstacles(btDynamicsWorld& physics, const World& world, std::span<const Actor> actors);
  ~Obstacles();

  /// Brings in what is near `p_map` and takes out what is not.
  void move_to(const Vector3d& p_map);
  /// One T_map_actor for each actor, in order. Throws std::invalid_argument at another number.
  void set_actor_poses(std::span<const Pose> T_map_actor);
  /// Call after each physics step: counts contacts that began, and those of the body with the
  /// ground as `touches_ground` says.
  void count_contacts(bool touches_ground, double step_s);
  /// Contacts begun so far. Touching the same thing again counts after a second apart.
  [[nodiscard]] int contacts_begun() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace locsim::sim
