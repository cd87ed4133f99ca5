#include "sim/imu/flicker_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace locsim::sim {

FlickerShape flicker_shape(double flat_from_s, double flat_to_s) {
  const double shortest_s = flat_from_s / 3.0;
  const double longest_s = 2.0 * flat_to_s;
  const auto steps = std::max(1L, std::lround(std::log10(longest_s / shortest_s)));
  const double ratio = std::pow(longest_s / shortest_s, 1.0 / static_cast<double>(steps));
  FlickerShape shape;
  for (long i = 0; i <= steps; ++i) {
    const double share = i == 0 || i == steps ? ratio / (ratio - 1.0) : 1.0;
    shape.processes.push_back(
        {.correlation_time_s = shortest_s * std::pow(ratio, static_cast<double>(i)),
         .sigma_per_bias = std::sqrt(share * std::log(ratio) / std::numbers::pi)});
  }
  return shape;
}

}  // namespace locsim::sim
