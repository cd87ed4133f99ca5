#pragma once

#include <span>

#include "core/messages.h"

namespace locsim::scenarios {

/// White noise that an IMU showed, of its own and of the car's vibration.
struct ImuNoise {
  double gyro_rad_s_sqrthz = 0.0;
  double accel_m_s2_sqrthz = 0.0;
};

/// The densities that would scatter the differences of samples in a row as they do: of white noise
/// at interval dt, rms(difference)·√(dt/2). Motion of a car hardly changes within a sample; the
/// engine and the road do, and a data sheet knows nothing of them. The middle one of the three
/// axes; zero for less than two samples. A gap counts as any other interval.
[[nodiscard]] ImuNoise measure_imu_noise(std::span<const ImuSample> samples);

}  // namespace locsim::scenarios
