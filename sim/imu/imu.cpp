#include "sim/imu/imu.h"

#include <cassert>

#include "core/physics.h"
#include "sim/sample_times.h"

namespace locsim::sim {

namespace {

const Vector3d kGravityMap(0.0, 0.0, -kGravity_m_s2);

Stamp time_of_step(const Trajectory& trajectory, std::size_t step) {
  return trajectory.start() + static_cast<std::int64_t>(step) * trajectory.step();
}

// Of a point fixed in the vehicle, along the unbroken curve, at a physics step.
Vector3d velocity_of(const Trajectory& trajectory, std::size_t step, const Vector3d& p_vehicle) {
  // Throws beyond the end, so it comes before the poses are read.
  const Vector3d velocity_vehicle_m_s =
      trajectory.unbroken_at(time_of_step(trajectory, step)).velocity_m_s;
  const auto arm = [&](std::size_t i) -> Vector3d {
    return trajectory.unbroken_poses()[i].rotation * p_vehicle;
  };
  // Second order at the very first pose, too.
  const Vector3d difference = step == 0 ? Vector3d(-3.0 * arm(0) + 4.0 * arm(1) - arm(2))
                                        : Vector3d(arm(step + 1) - arm(step - 1));
  return velocity_vehicle_m_s + difference / (2.0 * to_seconds(trajectory.step()));
}

}  // namespace

Imu::Imu(const ImuSpec& spec, const Pose& T_vehicle_imu, std::uint64_t seed, const Faults& faults)
    : spec_((check_parameters(spec, "imu"), spec)),
      T_vehicle_imu_(T_vehicle_imu),
      errors_(spec, seed),
      faults_(faults, seed) {}

void Imu::sample(const Trajectory& trajectory, Stamp from, Stamp to, std::vector<ImuSample>& out) {
  const std::int64_t steps = spec_.steps_per_sample(trajectory.step());
  const SampleTimes times{.start = trajectory.start(), .period = spec_.period()};
  const std::int64_t first = times.first_after(from);
  assert(first >= next_ || times[next_] > to);
  // Samples that nobody asked for are made as well: filters and stuck axes remember them.
  for (; times[next_] <= to; ++next_) {
    auto [sample, speed_m_s] = ideal(trajectory, static_cast<std::size_t>((next_ - 1) * steps),
                                     static_cast<std::size_t>(next_ * steps));
    if (spec_.noise) errors_.sense(next_, speed_m_s, sample);
    faults_.shift_biases(sample);
    if (spec_.noise) errors_.digitise(sample);
    faults_.clip(sample);
    faults_.hold_stuck_axes(sample);
    if (next_ >= first && !faults_.is_lost(next_, sample.time)) out.push_back(sample);
  }
}

Imu::Ideal Imu::ideal(const Trajectory& trajectory, std::size_t first_step,
                      std::size_t last_step) const {
  ImuSample sample;
  sample.time = time_of_step(trajectory, last_step);
  const double dt_s = to_seconds(sample.time - time_of_step(trajectory, first_step));
  const Vector3d& arm = T_vehicle_imu_.translation;
  const Vector3d velocity_last_m_s = velocity_of(trajectory, last_step, arm);
  const Vector3d velocity_change_m_s = velocity_last_m_s - velocity_of(trajectory, first_step, arm);
  const Eigen::Quaterniond R_map_first =
      trajectory.unbroken_poses()[first_step].rotation * T_vehicle_imu_.rotation;
  const Eigen::Quaterniond R_map_last =
      trajectory.unbroken_poses()[last_step].rotation * T_vehicle_imu_.rotation;
  const Vector3d turn_rad = so3::log(R_map_first.conjugate() * R_map_last);
  const Eigen::Quaterniond R_map_middle = R_map_first * so3::exp(0.5 * turn_rad);
  sample.angular_rate_rad_s = turn_rad / dt_s;
  sample.specific_force_m_s2 =
      R_map_middle.conjugate() * (velocity_change_m_s / dt_s - kGravityMap);
  return {.sample = sample, .speed_m_s = velocity_last_m_s.norm()};
}

}  // namespace locsim::sim
