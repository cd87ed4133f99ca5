#include "sim/imu/vibration_spec.h"

#include <algorithm>
#include <cmath>

namespace locsim::sim {

namespace {

// Turns of the crankshaft a metre, first to fifth gear of a middle-sized car.
constexpr std::array<double, 5> kGears_per_m = {8.0, 4.7, 3.1, 2.2, 1.6};
constexpr double kLowestDriving_hz = 20.0;

}  // namespace

void VibrationSpec::describe(Parameters& p) {
  p.number("road_rms_m_s2", road_rms_m_s2, {.min = 0.0, .max = 100.0});
  p.number("road_speed_m_s", road_speed_m_s, {.min = 0.1, .max = 100.0});
  p.number("engine_rms_m_s2", engine_rms_m_s2, {.min = 0.0, .max = 100.0});
  p.number("engine_idle_hz", engine_idle_hz, {.min = 1.0, .max = 100.0});
  p.number("lever_arm_m", lever_arm_m, {.min = 0.01, .max = 1000.0});
}

double VibrationSpec::road_rms_at(double speed_m_s) const {
  return road_rms_m_s2 * std::sqrt(speed_m_s / road_speed_m_s);
}

double VibrationSpec::engine_hz_at(double speed_m_s) const {
  const auto high_enough = [&](double gear) { return gear * speed_m_s >= kLowestDriving_hz; };
  const auto gear = std::find_if(kGears_per_m.rbegin(), kGears_per_m.rend(), high_enough);
  const double driving_hz =
      (gear == kGears_per_m.rend() ? kGears_per_m.front() : *gear) * speed_m_s;
  return std::max(engine_idle_hz, driving_hz);
}

}  // namespace locsim::sim
