#include "sim/faults/fault_kinds.h"

#include <cmath>

namespace locsim::sim {

namespace {

constexpr Bounds kAnyTurn{.min = -360.0, .max = 360.0};

}  // namespace

void LidarDirt::describe(Parameters& p) {
  LidarChoice::describe(p);
  p.degrees("from_deg", from_rad, kAnyTurn);
  p.degrees("to_deg", to_rad, kAnyTurn);
  p.number("transmission", transmission, kShare);
}

bool LidarDirt::covers(double azimuth_rad) const {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const auto turns_from = [&](double angle) {
    const double rest = std::fmod(angle - from_rad, kTurn);
    return rest < 0.0 ? rest + kTurn : rest;
  };
  return to_rad - from_rad >= kTurn || turns_from(azimuth_rad) <= turns_from(to_rad);
}

void LidarFrozen::describe(Parameters& p) {
  LidarChoice::describe(p);
  p.flag("new_stamps", new_stamps);
}

void LidarStamps::describe(Parameters& p) {
  LidarChoice::describe(p);
  p.number("offset_s", offset_s, {.min = -1.0, .max = 1.0});
  p.number("jitter_s", jitter_s, {.min = 0.0, .max = 1.0});
}

void LidarKnock::describe(Parameters& p) {
  LidarChoice::describe(p);
  p.vector3("shift_m", shift_m, {.min = -5.0, .max = 5.0});
  p.degrees("roll_deg", roll_pitch_yaw_rad.x(), kAnyTurn);
  p.degrees("pitch_deg", roll_pitch_yaw_rad.y(), kAnyTurn);
  p.degrees("yaw_deg", roll_pitch_yaw_rad.z(), kAnyTurn);
}

Pose LidarKnock::offset() const {
  return {rotation_from_rpy(roll_pitch_yaw_rad.x(), roll_pitch_yaw_rad.y(), roll_pitch_yaw_rad.z()),
          shift_m};
}

void ImuStuckAxis::describe(Parameters& p) {
  p.choice("axis", axis, kAxes);
}

void ImuBiasJump::describe(Parameters& p) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  Vector3d gyro_deg_s = gyro_rad_s / kDegree;
  const Vector3d before = gyro_deg_s;
  p.vector3("gyro_deg_s", gyro_deg_s, {.min = -1000.0, .max = 1000.0});
  if (gyro_deg_s != before) gyro_rad_s = gyro_deg_s * kDegree;
  p.vector3("accelerometer_m_s2", accelerometer_m_s2, {.min = -1000.0, .max = 1000.0});
}

void ImuDropout::describe(Parameters& p) {
  p.number("share", share, kShare);
}

void ImuLate::describe(Parameters& p) {
  p.number("delay_s", delay_s, {.min = 0.0, .max = 10.0});
}

void ImuSaturation::describe(Parameters& p) {
  p.degrees("gyro_range_deg_s", gyro_range_rad_s, kPositive);
  p.number("accelerometer_range_m_s2", accelerometer_range_m_s2, kPositive);
}

}  // namespace locsim::sim
