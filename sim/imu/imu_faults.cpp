#include "sim/imu/imu_faults.h"

#include <algorithm>

namespace locsim::sim {

namespace {

double& value_of_axis(ImuSample& sample, int axis) {
  return axis < 3 ? sample.angular_rate_rad_s[axis] : sample.specific_force_m_s2[axis - 3];
}

Vector3d clipped(const Vector3d& value, double range) {
  return value.cwiseMax(-range).cwiseMin(range);
}

}  // namespace

ImuFaults::ImuFaults(const Faults& faults, std::uint64_t seed)
    : jumps_(faults.all<ImuBiasJump>()),
      saturations_(faults.all<ImuSaturation>()),
      dropouts_(faults.all<ImuDropout>()),
      losses_(seed, "imu/dropout") {
  for (const auto& [interval, fault] : faults.all<ImuStuckAxis>()) {
    const auto found = std::ranges::find(ImuStuckAxis::kAxes, fault.axis);
    stuck_axes_.push_back(
        {.interval = interval, .axis = static_cast<int>(found - ImuStuckAxis::kAxes.begin())});
  }
}

void ImuFaults::shift_biases(ImuSample& sample) const {
  for (const auto& [interval, jump] : jumps_) {
    if (!interval.contains(sample.time)) continue;
    sample.angular_rate_rad_s += jump.gyro_rad_s;
    sample.specific_force_m_s2 += jump.accelerometer_m_s2;
  }
}

void ImuFaults::clip(ImuSample& sample) const {
  for (const auto& [interval, ranges] : saturations_) {
    if (!interval.contains(sample.time)) continue;
    sample.angular_rate_rad_s = clipped(sample.angular_rate_rad_s, ranges.gyro_range_rad_s);
    sample.specific_force_m_s2 =
        clipped(sample.specific_force_m_s2, ranges.accelerometer_range_m_s2);
  }
}

void ImuFaults::hold_stuck_axes(ImuSample& sample) {
  for (const StuckAxis& stuck : stuck_axes_) {
    if (has_last_ && stuck.interval.contains(sample.time)) {
      value_of_axis(sample, stuck.axis) = value_of_axis(last_, stuck.axis);
    }
  }
  last_ = sample;
  has_last_ = true;
}

bool ImuFaults::is_lost(std::int64_t k, Stamp time) const {
  for (std::size_t i = 0; i < dropouts_.size(); ++i) {
    if (dropouts_[i].interval.contains(time) &&
        losses_.uniform(static_cast<std::uint64_t>(k), i) < dropouts_[i].fault.share) {
      return true;
    }
  }
  return false;
}

}  // namespace locsim::sim
