#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "sim/magnetometer/magnetometer.h"
#include "tests/sim/imu/analytic_trajectory.h"

namespace locsim::sim {

inline constexpr double kDegree = std::numbers::pi / 180.0;
inline constexpr Duration kStep{20'000'000};
// About that of 49° north, with more declination: east, north, up.
inline const Vector3d kEarth_T{4.0e-6, 20.2e-6, -44.0e-6};

/// Nothing but what a test then turns on.
inline MagnetometerSpec bare() {
  MagnetometerSpec spec;
  spec.effects = {.white_noise = false,
                  .saturation = false,
                  .quantisation = false,
                  .hard_iron = false,
                  .soft_iron = false,
                  .calibration = true,
                  .tilt_noise = false,
                  .acceleration = false,
                  .steel = false};
  return spec;
}

struct Setting {
  Pose T_vehicle_sensor = {};
  Vector3d earth_T = kEarth_T;
  const SteelField* steel = nullptr;
  std::uint64_t seed = 1;
};

inline std::vector<MagneticHeading> headings_of(const MagnetometerSpec& spec,
                                                const Trajectory& trajectory,
                                                const Setting& s = {}) {
  std::vector<MagneticHeading> headings;
  Magnetometer(spec, s.T_vehicle_sensor, s.earth_T, s.steel, s.seed)
      .sample(trajectory, trajectory.start(), trajectory.end(), headings);
  return headings;
}

inline std::vector<MagneticField> fields_of(const MagnetometerSpec& spec,
                                            const Trajectory& trajectory, const Setting& s = {}) {
  std::vector<MagneticField> fields;
  Magnetometer(spec, s.T_vehicle_sensor, s.earth_T, s.steel, s.seed)
      .sample_field(trajectory, trajectory.start(), trajectory.end(), fields);
  return fields;
}

/// The first heading of a vehicle that stands at `pose`, less its yaw.
inline double first_error_rad(const MagnetometerSpec& spec, const Pose& pose, const Setting& s) {
  const Trajectory trajectory = standing_still(0.02, kStep, pose);
  return wrap_angle(headings_of(spec, trajectory, s).at(0).yaw_rad - pose.yaw());
}

inline double rms_first_error_rad(const MagnetometerSpec& spec, const Pose& pose, Setting s,
                                  int seeds) {
  double square = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    s.seed = static_cast<std::uint64_t>(seed);
    const double error = first_error_rad(spec, pose, s);
    square += error * error / seeds;
  }
  return std::sqrt(square);
}

}  // namespace locsim::sim
