#pragma once

#include <cstdint>
#include <vector>

#include "core/pose.h"
#include "core/time.h"

namespace locsim::sim {

/// Something that moves on its own: a shape of `World::actor_shapes` and its poses at a fixed
/// step, linear in between, standing still before the first and after the last.
struct Actor {
  std::uint32_t shape = 0;
  Stamp start;
  Duration step{100'000'000};
  /// T_map_actor: ground point under the middle, x forward.
  std::vector<Pose> poses;

  [[nodiscard]] Pose pose_at(Stamp time) const;
};

}  // namespace locsim::sim
