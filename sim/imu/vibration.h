#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "core/pose.h"
#include "core/random.h"
#include "core/time.h"
#include "sim/imu/oscillator.h"
#include "sim/imu/vibration_spec.h"

namespace locsim::sim {

/// Three independent oscillators driven by white noise, stationary from the first value on, with
/// an ẋ of standard deviation 1. One-sided density of ẋ at f, with Ω = 2πf:
/// 8ζω·Ω² / ((ω² − Ω²)² + (2ζωΩ)²).
class OscillatorNoise {
 public:
  OscillatorNoise(std::uint64_t seed, std::string_view purpose, const Oscillator& oscillator,
                  Duration period);

  /// x at sample k, in ẋ's unit times seconds. Exact at any period. Moves forward only.
  [[nodiscard]] Vector3d at(std::int64_t k);

 private:
  RandomStream stream_;
  Eigen::Matrix2d transition_;
  Eigen::Matrix2d kick_;
  std::int64_t k_ = 0;
  Eigen::Matrix<double, 2, 3> state_;
};

/// What three gyros or three accelerometers feel of an engine and a road.
///
/// The shaking is the derivative of something bounded, the shaking's velocity or angle, so that
/// its mean over an interval is a difference quotient: exact, with the attenuation and aliasing
/// that taking means entails. Of each line and mode there is what the sensor's own bandwidth
/// leaves of it.
class ShakenAxes {
 public:
  /// `turning` for gyros. `purpose` names the streams.
  ShakenAxes(const VibrationSpec& spec, bool turning, double bandwidth_hz, Duration period,
             std::uint64_t seed, std::string_view purpose);

  /// The mean over the interval that ends at sample k, by the car's speed at its end [m/s² or
  /// rad/s]. For k = 1, 2, 3, …, none left out.
  [[nodiscard]] Vector3d next(std::int64_t k, double speed_m_s);

 private:
  [[nodiscard]] Vector3d integral(std::int64_t k, double speed_m_s);
  /// Of a shaking of 1 m/s² at that frequency: what the sensor gives.
  [[nodiscard]] double response(double frequency_hz) const;

  VibrationSpec spec_;
  bool turning_;
  double bandwidth_hz_;
  double period_s_;
  std::array<OscillatorNoise, kRoadModes.size()> modes_;
  /// Of each mode, for a road of 1 m/s² rms.
  std::array<double, kRoadModes.size()> mode_amplitudes_;
  /// Of each engine order: sine and cosine of each axis' phase.
  std::array<Vector3d, kEngineOrders.size()> phase_sines_;
  std::array<Vector3d, kEngineOrders.size()> phase_cosines_;
  double crank_angle_rad_ = 0.0;
  Vector3d integral_ = Vector3d::Zero();
};

}  // namespace locsim::sim
