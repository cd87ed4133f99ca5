#include "scenarios/imu_delivery.h"

#include <algorithm>
#include <utility>

namespace locsim::scenarios {

std::vector<DeliveredImu> ImuDelivery::deliver(std::span<const ImuSample> samples, Stamp now) {
  for (const ImuSample& sample : samples) {
    Duration delay{0};
    for (const auto& [interval, late] : faults_.all<sim::ImuLate>()) {
      if (interval.contains(sample.time)) delay = std::max(delay, late.delay());
    }
    under_way_.push_back({sample.time + delay, sample});
  }
  const auto still_under_way = std::ranges::stable_partition(
      under_way_, [now](const DeliveredImu& message) { return message.at <= now; });
  std::vector<DeliveredImu> arrived(under_way_.begin(), still_under_way.begin());
  under_way_.erase(under_way_.begin(), still_under_way.begin());
  std::ranges::stable_sort(arrived, {}, &DeliveredImu::at);
  return arrived;
}

}  // namespace locsim::scenarios
