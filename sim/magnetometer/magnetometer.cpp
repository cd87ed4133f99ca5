#include "sim/magnetometer/magnetometer.h"

#include "sim/imu/sample_times.h"

namespace locsim::sim {

Magnetometer::Magnetometer(const MagnetometerSpec& spec, std::uint64_t seed)
    : spec_((check_parameters(spec, "magnetometer"), spec)),
      calibration_residual_rad_(spec.calibration_residual_rad *
                                RandomStream(seed, "magnetometer/calibration").gaussian(0)),
      disturbance_(MarkovNoise::gauss_markov(seed, "magnetometer/disturbance",
                                             spec.disturbance_time_s, spec.period())),
      white_(seed, "magnetometer/white") {}

void Magnetometer::sample(const Trajectory& trajectory, Stamp from, Stamp to,
                          std::vector<MagneticHeading>& out) {
  const SampleTimes times{.start = trajectory.start(), .period = spec_.period()};
  for (std::int64_t k = times.first_after(from); times[k] <= to; ++k) {
    const double yaw_rad = trajectory.pose_at(times[k]).yaw();
    out.push_back({.time = times[k],
                   .yaw_rad = spec_.noise ? wrap_angle(yaw_rad + error_rad(k)) : yaw_rad,
                   .sigma_rad = spec_.sigma_rad()});
  }
}

double Magnetometer::error_rad(std::int64_t k) {
  return calibration_residual_rad_ + spec_.disturbance_rad * disturbance_.at(k).x() +
         spec_.white_rad * white_.gaussian(static_cast<std::uint64_t>(k));
}

}  // namespace locsim::sim
