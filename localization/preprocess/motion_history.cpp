#include "localization/preprocess/motion_history.h"

#include <algorithm>
#include <cassert>

namespace locsim::localization {

void MotionHistory::push(Stamp time, const Pose& T_map_vehicle) {
  if (!knots_.empty() && time <= knots_.back().time) return;
  knots_.push_back({time, T_map_vehicle});
  // Dropped in batches, so that a push costs little.
  if (knots_.back().time - knots_.front().time > 2 * keep_) {
    std::erase_if(knots_, [&](const Knot& knot) { return time - knot.time > keep_; });
  }
}

void MotionHistory::move_newest_to(const Pose& T_map_vehicle) {
  if (knots_.empty()) return;
  const Pose correction = T_map_vehicle * knots_.back().T_map_vehicle.inverse();
  for (Knot& knot : knots_) knot.T_map_vehicle = correction * knot.T_map_vehicle;
}

bool MotionHistory::covers(Stamp time, Duration reach) const {
  return !knots_.empty() && time >= knots_.front().time && time <= knots_.back().time + reach;
}

Pose MotionHistory::at(Stamp time) const {
  assert(!knots_.empty());
  if (knots_.size() == 1) return knots_.front().T_map_vehicle;
  const auto after = std::ranges::lower_bound(knots_, time, {}, &Knot::time);
  const auto first = std::clamp<std::ptrdiff_t>(after - knots_.begin() - 1, 0,
                                                static_cast<std::ptrdiff_t>(knots_.size()) - 2);
  const Knot& a = knots_[static_cast<std::size_t>(first)];
  const Knot& b = knots_[static_cast<std::size_t>(first) + 1];
  return interpolate(a.T_map_vehicle, b.T_map_vehicle,
                     to_seconds(time - a.time) / to_seconds(b.time - a.time));
}

}  // namespace locsim::localization
