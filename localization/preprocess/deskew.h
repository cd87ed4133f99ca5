#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/messages.h"
#include "localization/localizer.h"
#include "localization/preprocess/motion_history.h"

namespace locsim::localization {

/// Takes the points `picked` of the scan to the vehicle frame as it stood at `reference`: each
/// from where the vehicle was when it was fired. Positions are in the order of `picked`; every
/// picked point must name a LIDAR of the rig, and `motion` must not be empty.
[[nodiscard]] std::vector<Vector3f> deskew(const LidarScan& scan,
                                           std::span<const std::uint32_t> picked,
                                           const MotionHistory& motion, Stamp reference,
                                           const Rig& rig);

}  // namespace locsim::localization
