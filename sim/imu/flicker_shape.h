#pragma once

#include "sim/imu/allan_model.h"

namespace locsim::sim {

/// The processes that `FlickerNoise` adds up for a floor that is flat from `flat_from_s` to
/// `flat_to_s`; it says why they are these.
[[nodiscard]] FlickerShape flicker_shape(double flat_from_s, double flat_to_s);

}  // namespace locsim::sim
