#include "sim/imu/rest_stretches.h"

#include <algorithm>
#include <cmath>

namespace locsim::sim {

namespace {

// Standard deviation of the three axes together in each window of `width` samples of a stretch.
std::vector<double> rolling_deviation(std::span<const ImuSample> samples, std::size_t width,
                                      Vector3d ImuSample::*signal) {
  std::vector<double> deviations;
  if (samples.size() < width) return deviations;
  // Taken from the first sample, so that gravity does not eat the digits.
  const Vector3d offset = samples.front().*signal;
  Vector3d sum = Vector3d::Zero();
  double squares = 0.0;
  const auto n = static_cast<double>(width);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vector3d in = samples[i].*signal - offset;
    sum += in;
    squares += in.squaredNorm();
    if (i + 1 < width) continue;
    deviations.push_back(std::sqrt(std::max(squares - sum.squaredNorm() / n, 0.0) / (n - 1.0)));
    const Vector3d out = samples[i + 1 - width].*signal - offset;
    sum -= out;
    squares -= out.squaredNorm();
  }
  return deviations;
}

double limit_from(const std::vector<std::vector<double>>& deviations, double times_quietest,
                  double most) {
  constexpr std::size_t kTwentieth = 20;
  std::vector<double> all;
  for (const auto& part : deviations) all.insert(all.end(), part.begin(), part.end());
  if (all.empty()) return most;
  const auto quiet = all.begin() + static_cast<std::ptrdiff_t>(all.size() / kTwentieth);
  std::nth_element(all.begin(), quiet, all.end());
  return std::min(times_quietest * *quiet, most);
}

}  // namespace

std::size_t Rest::samples() const {
  std::size_t count = 0;
  for (const Stretch& stretch : stretches) count += stretch.size();
  return count;
}

std::size_t Rest::longest() const {
  return static_cast<std::size_t>(std::ranges::max_element(stretches, {}, &Stretch::size) -
                                  stretches.begin());
}

Rest find_rest(std::span<const ImuSample> samples, std::span<const Stretch> without_gaps,
               double rate_hz, const RestLimits& limits) {
  const auto width =
      std::max<std::size_t>(2, static_cast<std::size_t>(std::lround(limits.window_s * rate_hz)));
  std::vector<std::vector<double>> gyro;
  std::vector<std::vector<double>> accelerometer;
  for (const Stretch& part : without_gaps) {
    const auto within = samples.subspan(part.begin, part.size());
    gyro.push_back(rolling_deviation(within, width, &ImuSample::angular_rate_rad_s));
    accelerometer.push_back(rolling_deviation(within, width, &ImuSample::specific_force_m_s2));
  }

  Rest rest;
  rest.gyro_limit_rad_s = limit_from(gyro, limits.times_quietest, limits.gyro_most_rad_s);
  rest.accelerometer_limit_m_s2 =
      limit_from(accelerometer, limits.times_quietest, limits.accelerometer_most_m_s2);
  const double shortest = limits.shortest_s * rate_hz;
  const auto settle = static_cast<std::size_t>(std::lround(limits.settle_s * rate_hz));
  for (std::size_t p = 0; p < without_gaps.size(); ++p) {
    const Stretch& part = without_gaps[p];
    Stretch current;
    const auto close = [&] {
      if (current.begin > part.begin) current.begin += settle;
      if (current.end < part.end) current.end -= std::min(settle, current.end);
      if (current.end > current.begin && static_cast<double>(current.size()) >= shortest) {
        rest.stretches.push_back(current);
      }
    };
    for (std::size_t i = 0; i < gyro[p].size(); ++i) {
      const bool quiet = gyro[p][i] <= rest.gyro_limit_rad_s &&
                         accelerometer[p][i] <= rest.accelerometer_limit_m_s2;
      if (!quiet) continue;
      const std::size_t begin = part.begin + i;
      if (begin > current.end || current.size() == 0) {
        if (current.size() > 0) close();
        current.begin = begin;
      }
      current.end = begin + width;
    }
    if (current.size() > 0) close();
  }
  return rest;
}

}  // namespace locsim::sim
