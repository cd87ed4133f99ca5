#pragma once

#include <span>
#include <vector>

#include "core/messages.h"
#include "core/time.h"
#include "sim/faults/faults.h"

namespace locsim::scenarios {

/// A sample and when it arrives.
struct DeliveredImu {
  Stamp at;
  ImuSample sample;
};

/// The way from the IMU to who listens: at once, or as late as the fault `imu_late` says, by when
/// the sample was taken. Where a delay ends, new samples overtake late ones.
class ImuDelivery {
 public:
  explicit ImuDelivery(sim::Faults faults) : faults_(std::move(faults)) {}

  /// Takes up samples and gives out those that have arrived by `now`, in the order they do.
  [[nodiscard]] std::vector<DeliveredImu> deliver(std::span<const ImuSample> samples, Stamp now);

 private:
  sim::Faults faults_;
  std::vector<DeliveredImu> under_way_;
};

}  // namespace locsim::scenarios
