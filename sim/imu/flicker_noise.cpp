#include "sim/imu/flicker_noise.h"

#include <algorithm>
#include <string>

#include "sim/imu/flicker_shape.h"

namespace locsim::sim {

FlickerNoise::FlickerNoise(std::uint64_t seed, std::string_view purpose, double flat_from_s,
                           double flat_to_s, Duration period) {
  constexpr double kEvaluationsPerCorrelationTime = 50.0;
  for (const auto& [correlation_time_s, sigma] : flicker_shape(flat_from_s, flat_to_s).processes) {
    const auto stride = std::max<std::int64_t>(
        1, static_cast<std::int64_t>(correlation_time_s / kEvaluationsPerCorrelationTime /
                                     to_seconds(period)));
    const std::string stream = std::string(purpose) + "/" + std::to_string(processes_.size());
    processes_.push_back(
        {.noise = MarkovNoise::gauss_markov(seed, stream, correlation_time_s, stride * period),
         .sigma = sigma,
         .stride = stride});
  }
}

Vector3d FlickerNoise::at(std::int64_t k) {
  Vector3d sum = Vector3d::Zero();
  for (Process& process : processes_) sum += process.sigma * process.noise.at(k / process.stride);
  return sum;
}

}  // namespace locsim::sim
