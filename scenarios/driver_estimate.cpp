#include "scenarios/driver_estimate.h"

#include "localization/propagate.h"

namespace locsim::scenarios {

void DriverEstimate::add(const ImuSample& sample) {
  recent_.push_back(sample);
  if (belief_) belief_ = localization::propagate(*belief_, {&sample, 1}, rig_);
}

void DriverEstimate::deliver(const std::optional<localization::Estimate>& estimate) {
  if (!estimate) return;
  std::erase_if(recent_, [&](const ImuSample& s) { return s.time <= estimate->time; });
  belief_ = localization::propagate(*estimate, recent_, rig_);
}

std::optional<sim::DriverView> DriverEstimate::view() const {
  if (!belief_ || belief_->state == localization::State::initializing) return std::nullopt;
  const Vector3d velocity_vehicle =
      belief_->T_map_vehicle.rotation.conjugate() * belief_->velocity_m_s;
  return sim::DriverView{.T_map_vehicle = belief_->T_map_vehicle,
                         .speed_m_s = velocity_vehicle.x(),
                         .yaw_rate_rad_s = belief_->angular_rate_rad_s.z()};
}

}  // namespace locsim::scenarios
