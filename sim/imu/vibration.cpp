#include "sim/imu/vibration.h"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/imu/low_pass.h"

namespace locsim::sim {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

Eigen::Matrix<double, 2, 3> draw(const RandomStream& stream, std::int64_t k) {
  Eigen::Matrix<double, 2, 3> draws;
  draws.row(0) = stream.gaussian3(static_cast<std::uint64_t>(k), 0).transpose();
  draws.row(1) = stream.gaussian3(static_cast<std::uint64_t>(k), 1).transpose();
  return draws;
}

OscillatorNoise mode_noise(std::size_t i, std::uint64_t seed, std::string_view purpose,
                           Duration period) {
  const RoadMode& mode = kRoadModes[i];
  return {seed, std::string(purpose) + "/road/" + std::to_string(i),
          Oscillator::of(mode.frequency_hz, mode.damping), period};
}

}  // namespace

OscillatorNoise::OscillatorNoise(std::uint64_t seed, std::string_view purpose,
                                 const Oscillator& oscillator, Duration period)
    : stream_(seed, purpose), transition_(oscillator.transition(to_seconds(period))) {
  // Driven by white noise, x and ẋ of one instant are independent, and ω·x varies as ẋ does. What
  // a step adds is what it takes to keep that covariance.
  const double w = oscillator.angular_frequency_rad_s;
  const Eigen::Matrix2d stationary = Eigen::Vector2d(1.0 / (w * w), 1.0).asDiagonal();
  const Eigen::Matrix2d added = stationary - transition_ * stationary * transition_.transpose();
  kick_ = added.llt().matrixL();
  state_ = stationary.cwiseSqrt() * draw(stream_, 0);
}

Vector3d OscillatorNoise::at(std::int64_t k) {
  assert(k >= k_);
  while (k_ < k) {
    ++k_;
    state_ = transition_ * state_ + kick_ * draw(stream_, k_);
  }
  return state_.row(0).transpose();
}

ShakenAxes::ShakenAxes(const VibrationSpec& spec, bool turning, double bandwidth_hz,
                       Duration period, std::uint64_t seed, std::string_view purpose)
    : spec_(spec),
      turning_(turning),
      bandwidth_hz_(bandwidth_hz),
      period_s_(to_seconds(period)),
      modes_{mode_noise(0, seed, purpose, period), mode_noise(1, seed, purpose, period),
             mode_noise(2, seed, purpose, period)} {
  for (std::size_t i = 0; i < modes_.size(); ++i) {
    mode_amplitudes_[i] = std::sqrt(kRoadModes[i].share) * response(kRoadModes[i].frequency_hz);
  }
  const RandomStream stream(seed, std::string(purpose) + "/engine");
  for (std::size_t i = 0; i < kEngineOrders.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double phase = stream.uniform(0.0, kTurn, i, static_cast<std::uint64_t>(axis));
      phase_sines_[i][axis] = std::sin(phase);
      phase_cosines_[i][axis] = std::cos(phase);
    }
  }
}

Vector3d ShakenAxes::next(std::int64_t k, double speed_m_s) {
  if (k == 1) integral_ = integral(0, speed_m_s);
  crank_angle_rad_ =
      std::fmod(crank_angle_rad_ + kTurn * spec_.engine_hz_at(speed_m_s) * period_s_, kTurn);
  const Vector3d before = integral_;
  integral_ = integral(k, speed_m_s);
  return (integral_ - before) / period_s_;
}

Vector3d ShakenAxes::integral(std::int64_t k, double speed_m_s) {
  Vector3d road = Vector3d::Zero();
  for (std::size_t i = 0; i < modes_.size(); ++i) road += mode_amplitudes_[i] * modes_[i].at(k);
  Vector3d engine = Vector3d::Zero();
  const double engine_hz = spec_.engine_hz_at(speed_m_s);
  for (std::size_t i = 0; i < kEngineOrders.size(); ++i) {
    const auto [order, share] = kEngineOrders[i];
    const double frequency_hz = order * engine_hz;
    const double amplitude =
        std::sqrt(2.0 * share) * response(frequency_hz) / (kTurn * frequency_hz);
    const double angle = order * crank_angle_rad_;
    engine += amplitude * (std::sin(angle) * phase_cosines_[i] + std::cos(angle) * phase_sines_[i]);
  }
  return spec_.road_rms_at(speed_m_s) * road + spec_.engine_rms_m_s2 * engine;
}

double ShakenAxes::response(double frequency_hz) const {
  const double passed = low_pass_gain(bandwidth_hz_, frequency_hz);
  return turning_ ? passed / (kTurn * frequency_hz * spec_.lever_arm_m) : passed;
}

}  // namespace locsim::sim
