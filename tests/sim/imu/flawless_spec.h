#pragma once

#include "sim/imu/imu_spec.h"

namespace locsim::sim {

/// A unit of which every error is zero, all effects on: to give it one error at a time.
inline ImuSpec flawless_spec(double rate_hz = 200.0) {
  ImuSpec spec;
  spec.rate_hz = rate_hz;
  spec.gyro = {};
  spec.accelerometer = {};
  spec.gyro_g_sensitivity = 0.0;
  spec.warm_up_k = 0.0;
  spec.vibration.road_rms_m_s2 = 0.0;
  spec.vibration.engine_rms_m_s2 = 0.0;
  return spec;
}

}  // namespace locsim::sim
