#include "scenarios/gnss_delivery.h"

#include <algorithm>
#include <iterator>

namespace locsim::scenarios {

std::vector<sim::GnssOutput> GnssDelivery::deliver(std::vector<sim::GnssOutput> outputs,
                                                   Stamp now) {
  std::ranges::move(outputs, std::back_inserter(under_way_));
  std::ranges::stable_sort(under_way_, {}, &sim::GnssOutput::delivered);
  const auto first_later =
      std::ranges::upper_bound(under_way_, now, {}, &sim::GnssOutput::delivered);
  std::vector<sim::GnssOutput> arrived(std::move_iterator(under_way_.begin()),
                                       std::move_iterator(first_later));
  under_way_.erase(under_way_.begin(), first_later);
  return arrived;
}

}  // namespace locsim::scenarios
