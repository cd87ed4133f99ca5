#pragma once

#include <functional>

#include "sim/trajectory.h"

namespace locsim::sim {

/// The trajectory of a physics that gives `pose_at(seconds)` every `step`, usable for `length_s`.
inline Trajectory trajectory_along(const std::function<Pose(double)>& pose_at, double length_s,
                                   Duration step = Duration{1'250'000}) {
  Trajectory trajectory(Stamp{}, step);
  const auto steps = duration_from_seconds(length_s) / step;
  for (std::int64_t k = 0; k <= steps + 1; ++k) trajectory.push(pose_at(to_seconds(k * step)));
  return trajectory;
}

inline Trajectory standing_still(double length_s, Duration step, const Pose& pose = {}) {
  return trajectory_along([&](double) { return pose; }, length_s, step);
}

}  // namespace locsim::sim
