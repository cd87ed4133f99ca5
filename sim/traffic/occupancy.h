#pragma once

#include <cstdint>
#include <vector>

#include "sim/world/site.h"
#include "sim/world/world.h"

namespace locsim::sim {

/// Poses are this far apart in time.
inline constexpr double kTrafficStep_s = 0.1;
/// Wheels and feet get over what is lower.
inline constexpr double kStepOver_m = 0.3;
/// From the car's scheduled place: nothing comes, goes or turns nearer.
inline constexpr double kOutOfSight_m = 100.0;

/// An actor to be: there during steps first, first + 1, …
struct Candidate {
  std::uint32_t shape = 0;
  std::size_t first = 0;
  std::vector<Pose> poses;
  /// Free ground that it needs before and behind it, and beside it.
  double room_along_m = 0.1;
  double room_beside_m = 0.1;
};

/// Who is where when: actors taken on, and what stands in the world.
class Occupancy {
 public:
  /// `world` must outlive it.
  explicit Occupancy(const World& world);

  /// Whether it touches one of the world's colliders on its way.
  [[nodiscard]] bool hits_standing(const Candidate& candidate) const;
  /// Whether a rectangle touches a collider between these heights.
  [[nodiscard]] bool hits_standing(const Footprint& footprint, double low_m, double high_m) const;
  /// Takes it on, unless it has no poses or comes too close to one that was taken on before.
  bool accept(Candidate candidate);
  [[nodiscard]] std::vector<Candidate>& accepted() { return accepted_; }

  [[nodiscard]] const Vector3d& half_extent_m(std::uint32_t shape) const {
    return world_.actor_half_extents_m[shape];
  }

 private:
  [[nodiscard]] bool conflict(const Candidate& a, const Candidate& b) const;

  const World& world_;
  std::vector<Footprint> standing_;
  PlanGrid grid_{8.0};
  std::vector<Candidate> accepted_;
};

}  // namespace locsim::sim
