#pragma once

#include <array>

#include "core/parameters.h"

namespace locsim::sim {

/// Something that the road shakes: an oscillator of which the acceleration has `share` of the
/// variance.
struct RoadMode {
  double frequency_hz;
  double damping;
  double share;
};
/// The axles' hop, the body's bending, and what of the panels and the tyres' hum reaches the
/// sensor. Shares and places by the spectra of the log of a real drive at 10–14 m/s (10–50 Hz;
/// what is above is assumed). Slower shaking is the ride, which the vehicle's physics has.
inline constexpr std::array<RoadMode, 3> kRoadModes = {
    {{.frequency_hz = 12.0, .damping = 0.25, .share = 0.3},
     {.frequency_hz = 27.0, .damping = 0.2, .share = 0.4},
     {.frequency_hz = 60.0, .damping = 0.5, .share = 0.3}}};

/// A multiple of the crankshaft's speed with its share of the engine's variance.
struct EngineOrder {
  double order;
  double share;
};
/// Four cylinders, four strokes: two firings a turn.
inline constexpr std::array<EngineOrder, 3> kEngineOrders = {
    {{.order = 1.0, .share = 0.1}, {.order = 2.0, .share = 0.7}, {.order = 4.0, .share = 0.2}}};

/// How the place where the sensor sits shakes, the same along each axis.
struct VibrationSpec {
  /// By the road, along each axis [m/s² rms], at `road_speed_m_s`; it grows with the root of the
  /// speed, as the unevenness of roads has it (ISO 8608, waviness 2).
  double road_rms_m_s2 = 0.35;
  double road_speed_m_s = 12.0;
  /// By the engine, at any of its speeds.
  double engine_rms_m_s2 = 0.08;
  /// Turns of the crankshaft a second when idling.
  double engine_idle_hz = 16.0;
  /// What shakes by the acceleration a also turns by the angular acceleration a/lever_arm_m.
  double lever_arm_m = 0.5;

  void describe(Parameters& p);

  [[nodiscard]] bool is_still() const { return road_rms_m_s2 == 0.0 && engine_rms_m_s2 == 0.0; }
  [[nodiscard]] double road_rms_at(double speed_m_s) const;
  /// Turns of the crankshaft a second: idling, or in the highest gear that keeps 20.
  [[nodiscard]] double engine_hz_at(double speed_m_s) const;
};

}  // namespace locsim::sim
