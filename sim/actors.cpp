#include "sim/actors.h"

#include <cassert>

namespace locsim::sim {

Pose Actor::pose_at(Stamp time) const {
  assert(!poses.empty() && step > Duration::zero());
  if (time <= start) return poses.front();
  const Duration since = time - start;
  const auto before = static_cast<std::size_t>(since / step);
  if (before + 1 >= poses.size()) return poses.back();
  const double fraction =
      static_cast<double>((since % step).count()) / static_cast<double>(step.count());
  return interpolate(poses[before], poses[before + 1], fraction);
}

}  // namespace locsim::sim
