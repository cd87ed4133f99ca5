#include "render/scale.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace locsim::render {
namespace {

/// A hair, so that 0.1 + 0.2 does not miss 0.3.
constexpr double slack = 1e-9;

double step_for(const Scale& scale, int count) {
  return round_up_125((scale.high - scale.low) / std::max(count, 1) * (1.0 - slack));
}

std::vector<double> sorted_finite(std::span<const double> values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](double v) { return std::isfinite(v); });
  std::sort(finite.begin(), finite.end());
  return finite;
}

}  // namespace

double round_up_125(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (value <= factor * decade * (1.0 + slack)) return factor * decade;
  }
  return 10.0 * decade;
}

double round_down_125(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {10.0, 5.0, 2.0}) {
    if (value >= factor * decade * (1.0 - slack)) return factor * decade;
  }
  return decade;
}

double Scale::fraction(double value) const {
  if (!logarithmic) return (value - low) / (high - low);
  if (value <= 0.0) return -1.0;
  return std::log(value / low) / std::log(high / low);
}

std::vector<double> Scale::ticks(int count) const {
  std::vector<double> result;
  if (logarithmic) {
    for (double v = std::pow(10.0, std::ceil(std::log10(low) - slack)); v <= high * (1.0 + slack);
         v *= 10.0) {
      result.push_back(v);
    }
    return result;
  }
  const double step = step_for(*this, count);
  for (double i = std::ceil(low / step - slack); i * step <= high + slack * step; i += 1.0) {
    result.push_back(i * step);
  }
  return result;
}

std::string Scale::label(double tick, int count) const {
  const double unit = logarithmic ? tick : step_for(*this, count);
  const int digits = std::max(0, static_cast<int>(-std::floor(std::log10(unit) + slack)));
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, std::abs(tick));
  return tick < 0.0 ? std::string("\u2212") + text : text;
}

Scale scale_for(std::span<const double> values, int ticks, bool zero_based) {
  const std::vector<double> finite = sorted_finite(values);
  if (finite.empty()) return {};
  double low = finite.front();
  double high = finite.back();
  if (zero_based) {
    low = std::min(low, 0.0);
    high = std::max(high, 0.0);
  }
  if (high - low < 1e-9 * std::max(1.0, std::abs(high))) {
    high += 0.5;
    if (!zero_based || low < 0.0) low -= 0.5;
  }
  const double step = round_up_125((high - low) / std::max(ticks, 1) * (1.0 - slack));
  return {std::floor(low / step + slack) * step, std::ceil(high / step - slack) * step, false};
}

Scale error_scale(std::span<const double> errors, double share) {
  std::vector<double> finite = sorted_finite(errors);
  if (finite.empty()) return {};
  const auto quantile = [&](double q) {
    return finite[static_cast<std::size_t>(q * static_cast<double>(finite.size() - 1) + 0.5)];
  };
  const double top = std::max(quantile(share), 1e-6);
  const double middle = std::max(quantile(0.5), 1e-6);
  if (top > 30.0 * middle) {
    const double decade = std::pow(10.0, std::floor(std::log10(std::max(quantile(0.1), 1e-6))));
    const double lowest = std::pow(10.0, std::ceil(std::log10(top) - slack) - 4.0);
    return {std::max(decade, lowest), round_up_125(top), true};
  }
  const double decade = std::pow(10.0, std::floor(std::log10(top)));
  for (const double factor : {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0}) {
    if (top <= factor * decade * (1.0 + slack)) return {0.0, factor * decade, false};
  }
  return {0.0, 10.0 * decade, false};
}

}  // namespace locsim::render
