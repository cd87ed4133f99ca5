#pragma once

#include <optional>
#include <vector>

#include "core/messages.h"
#include "localization/localizer.h"
#include "sim/vehicle/driver.h"

namespace locsim::scenarios {

/// What the driver is told between scans: the newest estimate that has reached it, carried on by
/// the IMU.
class DriverEstimate {
 public:
  explicit DriverEstimate(localization::Rig rig) : rig_(std::move(rig)) {}

  void add(const ImuSample& sample);
  void deliver(const std::optional<localization::Estimate>& estimate);
  /// Nothing before the first estimate that believes anything.
  [[nodiscard]] std::optional<sim::DriverView> view() const;

 private:
  localization::Rig rig_;
  std::optional<localization::Estimate> belief_;
  /// Since the last estimate.
  std::vector<ImuSample> recent_;
};

}  // namespace locsim::scenarios
