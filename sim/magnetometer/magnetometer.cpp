#include "sim/magnetometer/magnetometer.h"

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "core/error.h"

namespace locsim::sim {

namespace {

constexpr double kMicrotesla = 1e-6;
constexpr double kHorizontalMin_T = 2e-6;

Matrix3d gaussian_matrix(const RandomStream& stream) {
  Matrix3d m;
  for (int column = 0; column < 3; ++column) {
    m.col(column) = stream.gaussian3(static_cast<std::uint64_t>(column));
  }
  return m;
}

}  // namespace

Magnetometer::Magnetometer(const MagnetometerSpec& spec, const Pose& T_vehicle_sensor,
                           const Vector3d& earth_field_map_T, const SteelField* steel,
                           std::uint64_t seed)
    : spec_((check_parameters(spec, "magnetometer"), spec)),
      T_vehicle_sensor_(T_vehicle_sensor),
      earth_field_map_T_(earth_field_map_T),
      steel_(spec.noise && spec.effects.steel ? steel : nullptr),
      white_(seed, "magnetometer/white"),
      tilt_(spec, seed) {
  if (!spec_.noise) return;
  const double horizontal_T = earth_field_map_T.head<2>().norm();
  if (!(horizontal_T >= kHorizontalMin_T)) {
    throw InputError("magnetometer: the earth's field has a horizontal part of " +
                     std::to_string(horizontal_T / kMicrotesla) +
                     " uT at the world's origin, needs 2 uT; choose an origin farther from the "
                     "magnetic poles or set noise: false");
  }
  const Matrix3d identity = Matrix3d::Identity();
  if (spec_.effects.soft_iron) {
    distortion_ += spec_.soft_iron * gaussian_matrix(RandomStream(seed, "magnetometer/soft_iron"));
    if (spec_.effects.calibration) {
      const RandomStream residual(seed, "magnetometer/residual_soft_iron");
      correction_ =
          (identity + spec_.residual_soft_iron * gaussian_matrix(residual)) * distortion_.inverse();
    }
  }
  if (spec_.effects.hard_iron) {
    offset_uT_ = spec_.hard_iron_uT * RandomStream(seed, "magnetometer/hard_iron").gaussian3(0);
    if (spec_.effects.calibration) {
      const RandomStream residual(seed, "magnetometer/residual_hard_iron");
      known_offset_uT_ = offset_uT_ + spec_.residual_hard_iron_uT * residual.gaussian3(0);
    }
  }
}

SampleTimes Magnetometer::times(const Trajectory& trajectory) const {
  return {.start = trajectory.start(), .period = spec_.period()};
}

void Magnetometer::sample(const Trajectory& trajectory, Stamp from, Stamp to,
                          std::vector<MagneticHeading>& out) {
  const SampleTimes at = times(trajectory);
  for (std::int64_t k = at.first_after(from); at[k] <= to; ++k) {
    const TruthState truth = trajectory.at(at[k]);
    double yaw_rad = truth.T_map_vehicle.yaw();
    if (spec_.noise) {
      yaw_rad = heading_rad(reading_uT(truth.T_map_vehicle, at[k], k),
                            tilt_.up_in_vehicle(trajectory, at, k, trajectory.unbroken_at(at[k])));
    }
    out.push_back({.time = at[k], .yaw_rad = yaw_rad, .sigma_rad = spec_.heading_sigma_rad});
  }
}

void Magnetometer::sample_field(const Trajectory& trajectory, Stamp from, Stamp to,
                                std::vector<MagneticField>& out) const {
  const SampleTimes at = times(trajectory);
  for (std::int64_t k = at.first_after(from); at[k] <= to; ++k) {
    out.push_back(
        {.time = at[k], .field_T = kMicrotesla * reading_uT(trajectory.pose_at(at[k]), at[k], k)});
  }
}

Vector3d Magnetometer::reading_uT(const Pose& T_map_vehicle, Stamp time, std::int64_t k) const {
  const Pose T_map_sensor = T_map_vehicle * T_vehicle_sensor_;
  Vector3d field_map_T = earth_field_map_T_;
  if (steel_ != nullptr) field_map_T += steel_->at(T_map_sensor.translation, time);
  const Vector3d field_uT = T_map_sensor.rotation.conjugate() * field_map_T / kMicrotesla;
  if (!spec_.noise) return field_uT;

  Vector3d reading = distortion_ * field_uT + offset_uT_;
  if (spec_.effects.white_noise) {
    reading += spec_.white_noise_uT() * white_.gaussian3(static_cast<std::uint64_t>(k));
  }
  if (spec_.effects.saturation) {
    reading = reading.cwiseMax(-spec_.range_uT).cwiseMin(spec_.range_uT);
  }
  if (spec_.effects.quantisation && spec_.step_uT > 0.0) {
    reading = (reading / spec_.step_uT).array().round() * spec_.step_uT;
  }
  return reading;
}

double Magnetometer::heading_rad(const Vector3d& reading_uT, const Vector3d& up_vehicle) const {
  const Vector3d field_sensor = correction_ * (reading_uT - known_offset_uT_);
  const double roll = std::atan2(up_vehicle.y(), up_vehicle.z());
  const double pitch = std::atan2(-up_vehicle.x(), up_vehicle.tail<2>().norm());
  const Vector3d level =
      rotation_from_rpy(roll, pitch, 0.0) * (T_vehicle_sensor_.rotation * field_sensor);
  return wrap_angle(std::atan2(earth_field_map_T_.y(), earth_field_map_T_.x()) -
                    std::atan2(level.y(), level.x()));
}

}  // namespace locsim::sim
