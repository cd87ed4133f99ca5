#include "sim/gnss/smooth_noise.h"

#include <array>
#include <cassert>
#include <cmath>

namespace locsim::sim {

SmoothNoise::SmoothNoise(std::uint64_t seed, std::string_view purpose, Duration spacing)
    : stream_(seed, purpose), spacing_(spacing) {
  assert(spacing > Duration::zero());
}

double SmoothNoise::at(GpsTime time, std::uint64_t lane) const {
  const Duration since_epoch = time - GpsTime{};
  assert(since_epoch >= Duration::zero());
  const auto knot = static_cast<std::uint64_t>(since_epoch / spacing_);
  const double x = to_seconds(since_epoch % spacing_) / to_seconds(spacing_);
  const double y = 1.0 - x;
  const std::array<double, 4> weights{y * y * y, 4.0 - 6.0 * x * x + 3.0 * x * x * x,
                                      4.0 - 6.0 * y * y + 3.0 * y * y * y, x * x * x};
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i] * stream_.gaussian(knot + i, lane);
    squares += weights[i] * weights[i];
  }
  return sum / std::sqrt(squares);
}

}  // namespace locsim::sim
