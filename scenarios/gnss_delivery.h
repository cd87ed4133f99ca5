#pragma once

#include <vector>

#include "sim/gnss/gnss.h"

namespace locsim::scenarios {

/// The way from the receiver to who listens: what an epoch gave is heard when the receiver has
/// computed and sent it. Where a delay ends, new fixes overtake late ones.
class GnssDelivery {
 public:
  /// Takes up outputs and gives out those that have arrived by `now`, in the order they do.
  [[nodiscard]] std::vector<sim::GnssOutput> deliver(std::vector<sim::GnssOutput> outputs,
                                                     Stamp now);

 private:
  std::vector<sim::GnssOutput> under_way_;
};

}  // namespace locsim::scenarios
