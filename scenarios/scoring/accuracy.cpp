#include "scenarios/scoring/accuracy.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace locsim::scenarios {

namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

// What can be scored: the claimed estimates, if they stand for half of the drive.
std::span<const ErrorSample> scored_estimates(const EstimateErrors& errors) {
  Duration stands{};
  for (const ErrorSample& sample : errors.claimed()) stands += sample.stands;
  return 2 * stands >= errors.drive_time() ? errors.claimed() : std::span<const ErrorSample>{};
}

template <typename Value>
std::vector<double> collect(std::span<const ErrorSample> samples, Value value) {
  std::vector<double> values;
  values.reserve(samples.size());
  for (const ErrorSample& sample : samples) values.push_back(value(sample));
  return values;
}

std::optional<double> in_degrees(std::optional<double> value_rad) {
  if (value_rad) *value_rad *= kDegreesPerRadian;
  return value_rad;
}

std::optional<double> normalised_error_squared(const Vector3d& error, const Matrix3d& covariance) {
  const Eigen::LLT<Matrix3d> factor(covariance);
  if (factor.info() != Eigen::Success) return std::nullopt;
  return error.dot(factor.solve(error)) / 3.0;
}

}  // namespace

double nearest_rank(std::vector<double> values, double share) {
  // ⌈share·n⌉, where 0.95·20 must not become 19.000000000000004.
  const double count = share * static_cast<double>(values.size()) - 1e-9;
  const auto rank = static_cast<std::ptrdiff_t>(std::max(1.0, std::ceil(count)));
  std::ranges::nth_element(values, values.begin() + rank - 1);
  return values[static_cast<std::size_t>(rank - 1)];
}

ErrorStatistics error_statistics(std::vector<double> values) {
  if (values.empty()) return {};
  double sum_of_squares = 0.0;
  for (const double value : values) sum_of_squares += value * value;
  return {.rmse = std::sqrt(sum_of_squares / static_cast<double>(values.size())),
          .p95 = nearest_rank(values, 0.95),
          .max = *std::ranges::max_element(values)};
}

Accuracy accuracy(const EstimateErrors& errors) {
  const std::span<const ErrorSample> samples = scored_estimates(errors);
  const auto rmse_of = [&](auto value) { return error_statistics(collect(samples, value)).rmse; };
  return {.position_m =
              error_statistics(collect(samples, [](const ErrorSample& s) { return s.error_m(); })),
          .position_2d_m = error_statistics(collect(
              samples, [](const ErrorSample& s) { return s.position_error_m.head<2>().norm(); })),
          .yaw_rmse_deg = in_degrees(rmse_of([](const ErrorSample& s) { return s.yaw_error_rad; })),
          .attitude_rmse_deg =
              in_degrees(rmse_of([](const ErrorSample& s) { return s.rotation_error_rad; }))};
}

Consistency consistency(const EstimateErrors& errors) {
  const std::span<const ErrorSample> samples = scored_estimates(errors);
  if (samples.empty()) return {};
  double position_sum = 0.0;
  double rotation_sum = 0.0;
  for (const ErrorSample& sample : samples) {
    const Vector6d xi = se3::log(sample.T_map_estimated.inverse() * sample.T_map_true);
    const auto position =
        normalised_error_squared(xi.head<3>(), sample.covariance.topLeftCorner<3, 3>());
    const auto rotation =
        normalised_error_squared(xi.tail<3>(), sample.covariance.bottomRightCorner<3, 3>());
    if (!position || !rotation) return {};
    position_sum += *position;
    rotation_sum += *rotation;
  }
  const auto count = static_cast<double>(samples.size());
  return {.position = position_sum / count, .rotation = rotation_sum / count};
}

}  // namespace locsim::scenarios
