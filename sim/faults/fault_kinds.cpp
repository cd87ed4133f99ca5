#include "sim/faults/fault_kinds.h"

#include <cmath>

namespace locsim::sim {

namespace {

constexpr Bounds kAnyTurn{.min = -360.0, .max = 360.0};
constexpr Bounds kSpoofer_db{.min = -30.0, .max = 60.0};

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

void GnssJamming::describe(Parameters& p) {
  p.number("jammer_to_signal_db", jammer_to_signal_db, {.min = 0.0, .max = 120.0});
  p.number("ramp_s", ramp_s, {.min = 0.0, .max = 1e5});
}

void GnssSpoofingDragOff::describe(Parameters& p) {
  p.number("advantage_db", advantage_db, kSpoofer_db);
  p.number("hold_s", hold_s, {.min = 0.0, .max = 1e5});
  p.vector3("rate_m_s", rate_m_s, {.min = -100.0, .max = 100.0});
  p.number("clock_rate_m_s", clock_rate_m_s, {.min = -1000.0, .max = 1000.0});
}

void GnssSpoofingStep::describe(Parameters& p) {
  p.number("advantage_db", advantage_db, kSpoofer_db);
  p.vector3("offset_m", offset_m, {.min = -1e5, .max = 1e5});
  p.number("clock_offset_m", clock_offset_m, {.min = -1e6, .max = 1e6});
}

void GnssClockJump::describe(Parameters& p) {
  p.number("jump_s", jump_s, {.min = -0.01, .max = 0.01});
}

void GnssOverconfident::describe(Parameters& p) {
  p.number("sigma_factor", sigma_factor, {.min = 1e-6, .max = 1.0});
}

void GnssFrozen::describe(Parameters& p) {
  p.flag("new_stamps", new_stamps);
}

void GnssLate::describe(Parameters& p) {
  p.number("delay_s", delay_s, {.min = 0.0, .max = 60.0});
}

void GnssAntennaCut::describe(Parameters& p) {
  p.number("attenuation_db", attenuation_db, {.min = 0.0, .max = 120.0});
}

void Kidnap::describe(Parameters& p) {
  p.number("along_m", along_m, {.min = -1e4, .max = 1e4});
  p.number("left_m", left_m, {.min = -20.0, .max = 20.0});
  p.degrees("turn_deg", turn_rad, kAnyTurn);
}

}  // namespace locsim::sim
