#pragma once

#include <span>

#include "core/messages.h"
#include "localization/localizer.h"

namespace locsim::localization {

/// Strapdown integration of `samples` (each the mean over the interval that ends at its time,
/// oldest first) from `estimate` to the last sample; samples at or before estimate.time are
/// skipped. Carries the pose, the velocity and the covariance, the lever arm of the IMU included.
[[nodiscard]] Estimate propagate(const Estimate& estimate, std::span<const ImuSample> samples,
                                 const Rig& rig);

}  // namespace locsim::localization
