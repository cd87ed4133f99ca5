#include "sim/gnss/correlator.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/physics.h"

namespace locsim::sim {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kStepsPerChip = 1024;
constexpr int kChips = 2;

// Without limit of the band, at a delay in chips: straight pieces.
double sharp(bool is_boc, double delay) {
  if (delay >= 1.0) return 0.0;
  if (!is_boc) return 1.0 - delay;
  return delay < 0.5 ? 1.0 - 3.0 * delay : delay - 1.0;
}

// Power spectrum at a frequency in chip rates; BOC(1,1) with its subcarrier as a sine.
double spectrum(bool is_boc, double frequency) {
  if (frequency == 0.0) return is_boc ? 0.0 : 1.0;
  if (!is_boc) {
    const double x = kPi * frequency;
    return std::pow(std::sin(x) / x, 2);
  }
  const double x = kPi * frequency / 2.0;
  return std::pow(std::sin(x) * std::sin(x) / x, 2);
}

void check_bandwidth(double bandwidth_hz) {
  if (bandwidth_hz > 0.0) return;
  throw InputError("front end bandwidth is " + std::to_string(bandwidth_hz) +
                   " Hz, needs a positive one");
}

// Cosine transform over ±`half_band` chip rates by the trapezoidal rule, for delays in chips. The
// spacing of frequencies repeats the correlation at its inverse, 64 chips or more away.
class BandLimited {
 public:
  BandLimited(bool is_boc, double half_band) {
    constexpr int kFrequenciesLeast = 1024;
    const int intervals =
        std::max(kFrequenciesLeast, static_cast<int>(std::ceil(64.0 * half_band)));
    step_ = half_band / intervals;
    for (int i = 0; i <= intervals; ++i) {
      const double weight = i == 0 || i == intervals ? 0.5 : 1.0;
      densities_.push_back(weight * spectrum(is_boc, i * step_));
    }
  }

  [[nodiscard]] double at(double delay) const {
    // cos(i·x) by its recurrence.
    const double cosine = std::cos(2.0 * kPi * step_ * delay);
    double before = cosine;
    double now = 1.0;
    double sum = 0.0;
    for (const double density : densities_) {
      sum += density * now;
      before = std::exchange(now, 2.0 * cosine * now - before);
    }
    return sum;
  }

 private:
  double step_ = 0.0;
  std::vector<double> densities_;
};

}  // namespace

double Modulation::chip_m() const {
  return kSpeedOfLight_m_s / chip_rate_hz;
}

double Modulation::peak_m() const {
  return is_boc ? chip_m() / 3.0 : chip_m();
}

Modulation modulation_of(GnssSystem system) {
  switch (system) {
    case GnssSystem::gps:
      break;
    case GnssSystem::galileo:
      return {.chip_rate_hz = 1.023e6, .is_boc = true};
    case GnssSystem::glonass:
      return {.chip_rate_hz = 0.511e6};
    case GnssSystem::beidou:
      return {.chip_rate_hz = 2.046e6};
  }
  return {.chip_rate_hz = 1.023e6};
}

Correlation::Correlation(const Modulation& modulation, double bandwidth_hz)
    : steps_per_m_(kStepsPerChip / modulation.chip_m()) {
  check_bandwidth(bandwidth_hz);
  constexpr int kSteps = kChips * kStepsPerChip;
  table_.assign(kSteps + 2, 0.0);
  const auto fill = [&](const auto& correlation) {
    const double peak = correlation(0.0);
    for (int i = 0; i < kSteps; ++i) {
      table_[static_cast<std::size_t>(i)] =
          correlation(static_cast<double>(i) / kStepsPerChip) / peak;
    }
  };
  if (std::isinf(bandwidth_hz)) {
    // Corners are on the table's points: straight pieces between these are exact.
    fill([&](double delay) { return sharp(modulation.is_boc, delay); });
  } else {
    const BandLimited limited(modulation.is_boc, bandwidth_hz / 2.0 / modulation.chip_rate_hz);
    fill([&](double delay) { return limited.at(delay); });
  }
}

double Correlation::at(double delay_m) const {
  const double position = std::abs(delay_m) * steps_per_m_;
  if (!(position < static_cast<double>(table_.size() - 2))) return 0.0;
  const auto cell = static_cast<std::size_t>(position);
  return table_[cell] + (position - static_cast<double>(cell)) * (table_[cell + 1] - table_[cell]);
}

std::shared_ptr<const Correlation> shared_correlation(const Modulation& modulation,
                                                      double bandwidth_hz) {
  check_bandwidth(bandwidth_hz);
  static std::mutex mutex;
  static std::map<std::pair<Modulation, double>, std::shared_ptr<const Correlation>> made;
  const std::lock_guard lock(mutex);
  auto& correlation = made[{modulation, bandwidth_hz}];
  if (!correlation) correlation = std::make_shared<const Correlation>(modulation, bandwidth_hz);
  return correlation;
}

}  // namespace locsim::sim
