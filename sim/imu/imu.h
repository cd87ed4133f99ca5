#pragma once

#include <cstdint>
#include <vector>

#include "core/messages.h"
#include "core/pose.h"
#include "core/time.h"
#include "sim/faults/faults.h"
#include "sim/imu/imu_errors.h"
#include "sim/imu/imu_faults.h"
#include "sim/imu/imu_spec.h"
#include "sim/trajectory.h"

namespace locsim::sim {

/// An inertial measurement unit on the vehicle.
///
/// A sample covers the interval [a, b] of whole physics steps, Δt long. Its means are those of a
/// unit that does its own strapdown integration at a high rate (coning and sculling removed):
///
///     ω = Log(R_aᵀ·R_b) / Δt
///     f = R_mᵀ·((v_b − v_a)/Δt − g),   R_m = R_a·Exp(ω·Δt/2)
///
/// R is the imu's attitude and v the velocity of its own place in the map, the trajectory's plus
/// the central difference of the rotating lever arm: Euler and centripetal terms are within. Both
/// are of the trajectory's unbroken curve: being set down elsewhere is not felt.
/// Hence a receiver that does R_b = R_a·Exp(ω·Δt), v_b = v_a + (R_m·f + g)·Δt and
/// p_b = p_a + (v_a + v_b)·Δt/2 has attitude and velocity exactly, and the position to a bounded
/// Δt²/12·(change of acceleration) as long as the motion has nothing near half the sample rate.
/// Then come the errors of the unit (imu_errors.h) and what faults make of them.
class Imu {
 public:
  /// Of `faults` it asks for those of an IMU. Throws InputError where `spec` is out of its limits.
  Imu(const ImuSpec& spec, const Pose& T_vehicle_imu, std::uint64_t seed,
      const Faults& faults = {});

  /// Appends every sample whose interval ends in (from, to], to ≤ trajectory.end(), but those that
  /// faults lose. Samples end at trajectory.start() + k·period, k = 1, 2, … Calls go forward in
  /// time, of one trajectory; how they cut it and what they leave out makes no difference. Throws
  /// InputError where the rate does not divide that of the trajectory.
  void sample(const Trajectory& trajectory, Stamp from, Stamp to, std::vector<ImuSample>& out);

  [[nodiscard]] const ImuSpec& spec() const { return spec_; }

 private:
  struct Ideal {
    ImuSample sample;
    /// Of the imu, at the end of the interval.
    double speed_m_s;
  };
  [[nodiscard]] Ideal ideal(const Trajectory& trajectory, std::size_t first_step,
                            std::size_t last_step) const;

  ImuSpec spec_;
  Pose T_vehicle_imu_;
  ImuErrors errors_;
  ImuFaults faults_;
  /// The first sample that has not been made.
  std::int64_t next_ = 1;
};

}  // namespace locsim::sim
