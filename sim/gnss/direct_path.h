#pragma once

#include <optional>

#include "sim/gnss/radio_rays.h"
#include "sim/gnss/signal_path.h"

namespace locsim::sim {

/// Amplitude that is left behind so much foliage.
[[nodiscard]] double foliage_amplitude(double foliage_m);

/// The way that is straight but for an edge: clear, through foliage, weakened by an edge that comes
/// near, or bent over one (single knife edge, ITU-R P.526) or round both sides of a thin thing.
/// Nothing where less than about −20 dB is left of it.
[[nodiscard]] std::optional<SignalPath> direct_path(const RadioRays& rays, const Vector3d& antenna,
                                                    const Vector3d& to_satellite,
                                                    double max_range_m);

}  // namespace locsim::sim
