#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/messages.h"
#include "sim/imu/allan.h"
#include "sim/imu/allan_fit.h"
#include "sim/imu/imu_spec.h"
#include "sim/imu/rest_stretches.h"

namespace locsim::sim {

/// Measured curves of one kind of sensor, x, y, z; gyros in rad/s, accelerometers in m/s².
using AllanAxes = std::array<AllanCurve, 3>;

struct ImuAllanCurves {
  AllanAxes gyro;
  AllanAxes accelerometer;
};

/// Curves of all six signals over the stretches, pooled where averages fit into more than one.
[[nodiscard]] ImuAllanCurves measure_allan(std::span<const ImuSample> samples,
                                           std::span<const Stretch> stretches, double rate_hz);
/// Curves of several recordings of one kind of unit as if it were one recording.
[[nodiscard]] ImuAllanCurves pool_recordings(std::span<const ImuAllanCurves> recordings);

/// What a data sheet promises, the same on each axis.
struct ImuAllanModel {
  AllanModel gyro;
  AllanModel accelerometer;
};
/// The curve of a unit at rest, warm and without vibration, as `simulate_at_rest` makes it. White
/// noise counts with what rounding to the unit's resolution adds to it.
[[nodiscard]] ImuAllanModel specified_allan(const ImuSpec& spec);

struct AllanTriadFit {
  std::array<AllanFit, 3> axes;
  /// Of the three curves pooled.
  AllanFit together;
};
struct ImuAllanFit {
  AllanTriadFit gyro;
  AllanTriadFit accelerometer;
};
[[nodiscard]] ImuAllanFit fit_imu_allan(const ImuAllanCurves& curves);
/// For a unit that is known to be made of a specification's terms: finds their sizes.
[[nodiscard]] ImuAllanFit fit_imu_allan(const ImuAllanCurves& curves,
                                        const ImuAllanModel& specified);

/// How far a unit lies from a specification.
struct ImuDistance {
  /// Mean of |log₁₀(measured/specified)| over N, B and K of gyros and accelerometers, as far as
  /// they are specified: 0.3 is a factor of two. A coefficient that was seen on all axes counts
  /// with their geometric mean. Of others the lowest bound of the axes is known: N counts with it,
  /// since shaking only adds and the quietest axis comes nearest to the sensor; B and K count with
  /// how far the specification exceeds it, and not at all where it does not. Infinite where nothing
  /// counts.
  double mean_log10_ratio = 0.0;
  /// How many coefficients were seen, and how many were counted by a bound.
  int seen = 0;
  int by_bound = 0;
};
[[nodiscard]] ImuDistance distance(const ImuAllanFit& measured, const ImuAllanModel& specified);

}  // namespace locsim::sim
