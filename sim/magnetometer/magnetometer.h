#pragma once

#include <cstdint>
#include <vector>

#include "core/messages.h"
#include "core/pose.h"
#include "core/random.h"
#include "sim/magnetometer/magnetometer_spec.h"
#include "sim/magnetometer/steel_field.h"
#include "sim/magnetometer/tilt_estimate.h"
#include "sim/sample_times.h"
#include "sim/trajectory.h"

namespace locsim::sim {

/// A raw reading: flux density in the sensor's frame, uncalibrated.
struct MagneticField {
  Stamp time;
  Vector3d field_T = Vector3d::Zero();
};

/// A tilt-compensated magnetic compass on the vehicle.
///
/// It reads m = S⁻¹·(R_sensor_map·(B_earth + B_scene)) + b + noise, limited and in steps; S is the
/// soft iron that turns with it, b the hard iron. Its calibration undoes both but for residuals,
/// (1 + δS)·S·(m − b − δb); the result is levelled by the unit's own roll and pitch (TiltEstimate),
/// and its azimuth, less that of the model's field (declination), is the heading. A disturbing
/// field thus turns the heading by about its horizontal part across the earth's, over the earth's.
/// The claimed sigma knows nothing of that.
class Magnetometer {
 public:
  /// `earth_field_map_T` as earth_field_enu_T() gives it. `steel` may be
  /// null, or must outlive the magnetometer. Throws InputError where `spec` is out of its limits,
  /// or where the earth's field is so steep (horizontal part below 2 µT, the blackout zones of the
  /// World Magnetic Model) that a compass is of no use.
  Magnetometer(const MagnetometerSpec& spec, const Pose& T_vehicle_sensor,
               const Vector3d& earth_field_map_T, const SteelField* steel, std::uint64_t seed);

  /// Appends every sample in (from, to], to ≤ trajectory.end(). Samples are at trajectory.start()
  /// + k·period, k = 1, 2, … Calls go forward in time; how they cut it makes no difference.
  void sample(const Trajectory& trajectory, Stamp from, Stamp to,
              std::vector<MagneticHeading>& out);
  /// The readings from which the headings of the same times are made.
  void sample_field(const Trajectory& trajectory, Stamp from, Stamp to,
                    std::vector<MagneticField>& out) const;

  [[nodiscard]] const MagnetometerSpec& spec() const { return spec_; }

 private:
  [[nodiscard]] SampleTimes times(const Trajectory& trajectory) const;
  [[nodiscard]] Vector3d reading_uT(const Pose& T_map_vehicle, Stamp time, std::int64_t k) const;
  [[nodiscard]] double heading_rad(const Vector3d& reading_uT, const Vector3d& up_vehicle) const;

  MagnetometerSpec spec_;
  Pose T_vehicle_sensor_;
  Vector3d earth_field_map_T_;
  const SteelField* steel_;
  RandomStream white_;
  TiltEstimate tilt_;
  /// S⁻¹ and b.
  Matrix3d distortion_ = Matrix3d::Identity();
  Vector3d offset_uT_ = Vector3d::Zero();
  /// What calibration takes them to be: (1 + δS)·S and b + δb.
  Matrix3d correction_ = Matrix3d::Identity();
  Vector3d known_offset_uT_ = Vector3d::Zero();
};

}  // namespace locsim::sim
