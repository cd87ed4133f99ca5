#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/geodesy.h"
#include "core/messages.h"
#include "sim/faults/faults.h"
#include "sim/gnss/gnss_receiver.h"
#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/navigation.h"
#include "sim/trajectory.h"

namespace locsim::sim {

/// What a receiver hands out for one epoch, and when.
struct GnssOutput {
  Stamp delivered;
  GnssFix fix;
  GnssEpoch raw;
};

/// A GNSS receiver in the scene, whole: it measures satellites' signals on all their ways to the
/// antenna (GnssReceiver) and computes its own position, velocity and covariance (Navigation).
/// Nothing of the truth but what reached the antenna gets into its messages.
class Gnss {
 public:
  /// `start`: GPS time at Stamp{}. `world` and `scene` must outlive it. Throws InputError where
  /// `spec` is out of its limits.
  Gnss(const GnssSpec& spec, const Vector3d& antenna_in_vehicle_m, const World& world,
       const RayScene& scene, const LocalFrame& frame, GpsTime start, std::uint64_t seed,
       const Faults& faults = {});

  /// Appends what the epochs in (from, to] give, to ≤ trajectory.end(), with or without a fix.
  /// Epochs are at trajectory.start() + k·period, k = 1, 2, … Calls go forward in time; how they
  /// cut it makes no difference. The receiver has been tracking when the trajectory starts.
  void sample(const Trajectory& trajectory, Stamp from, Stamp to, std::vector<GnssOutput>& out);

  [[nodiscard]] const GnssSpec& spec() const { return spec_; }
  [[nodiscard]] const GnssReceiver& receiver() const { return receiver_; }
  /// Of the last epoch.
  [[nodiscard]] const std::vector<SignalTruth>& last_truth() const { return receiver_.truth(); }

 private:
  [[nodiscard]] GnssOutput epoch(const Trajectory& trajectory, const SampleTimes& times,
                                 std::int64_t k);

  GnssSpec spec_;
  LocalFrame frame_;
  Faults faults_;
  GnssReceiver receiver_;
  Navigation navigation_;
  /// Where the receiver last believed to be.
  std::optional<GeodeticPoint> believed_;
  /// The last output before what freezes it.
  std::optional<GnssOutput> last_;
};

}  // namespace locsim::sim
