#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/geodesy.h"
#include "core/messages.h"
#include "core/random.h"
#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/sky.h"
#include "sim/markov_noise.h"
#include "sim/trajectory.h"

namespace locsim::sim {

/// A GNSS receiver that delivers solutions of its own. Their errors are statistical: what the sky
/// leaves visible sets the number of satellites, scales the errors axis by axis by the geometry of
/// the open directions, and takes the fix away. The claimed covariance is that of the errors
/// drawn. Axes are those of the map frame, which serve as east, north, up within a few kilometres
/// of its origin.
class Gnss {
 public:
  /// Throws InputError where `spec` is out of its limits.
  Gnss(const GnssSpec& spec, const Vector3d& antenna_in_vehicle_m, std::uint64_t seed);

  /// Appends every epoch in (from, to], with or without a fix, to ≤ trajectory.end(). Epochs are
  /// at trajectory.start() + k·period, k = 1, 2, … Calls go forward in time; how they cut it makes
  /// no difference. The receiver has been tracking when the trajectory starts. An outage is an
  /// `is_blocked` that answers true throughout.
  void sample(const Trajectory& trajectory, const SkyBlocked& is_blocked, const LocalFrame& frame,
              Stamp from, Stamp to, std::vector<GnssFix>& out);

  [[nodiscard]] const GnssSpec& spec() const { return spec_; }

 private:
  /// Whether a fix comes out of an epoch whose sky would do for one.
  [[nodiscard]] bool tracks(bool sky_is_usable, Stamp time);

  GnssSpec spec_;
  Vector3d antenna_in_vehicle_m_;
  Sky sky_;
  MarkovNoise position_wander_;
  RandomStream position_white_;
  RandomStream velocity_white_;
  bool tracking_ = true;
  /// First usable epoch after the loss.
  std::optional<Stamp> regained_;
};

}  // namespace locsim::sim
