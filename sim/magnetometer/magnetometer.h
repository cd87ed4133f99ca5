#pragma once

#include <cstdint>
#include <vector>

#include "core/messages.h"
#include "core/random.h"
#include "sim/imu/markov_noise.h"
#include "sim/magnetometer/magnetometer_spec.h"
#include "sim/trajectory.h"

namespace locsim::sim {

/// A magnetometer that delivers the heading of the vehicle's x axis. Its errors are added to the
/// true heading; the sigma it claims is that of their sum over many runs. Within one run the
/// residual of calibration does not average out.
class Magnetometer {
 public:
  /// Throws InputError where `spec` is out of its limits.
  Magnetometer(const MagnetometerSpec& spec, std::uint64_t seed);

  /// Appends every sample in (from, to], to ≤ trajectory.end(). Samples are at trajectory.start()
  /// + k·period, k = 1, 2, … Calls go forward in time; how they cut it makes no difference.
  void sample(const Trajectory& trajectory, Stamp from, Stamp to,
              std::vector<MagneticHeading>& out);

  [[nodiscard]] const MagnetometerSpec& spec() const { return spec_; }

 private:
  [[nodiscard]] double error_rad(std::int64_t k);

  MagnetometerSpec spec_;
  double calibration_residual_rad_;
  MarkovNoise disturbance_;
  RandomStream white_;
};

}  // namespace locsim::sim
