#include "benchmarks/fidelity/gnss_figures.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"

namespace locsim::fidelity {

namespace {

std::size_t class_of(double cn0_db_hz) {
  const auto above = std::ranges::upper_bound(kCn0From, cn0_db_hz);
  return static_cast<std::size_t>(above - kCn0From.begin()) - 1;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? kNoFigure : sum / static_cast<double>(values.size());
}

double share_beyond(const std::vector<double>& values, double limit) {
  const auto beyond = std::ranges::count_if(values, [&](double v) { return std::abs(v) > limit; });
  return values.empty() ? kNoFigure
                        : static_cast<double>(beyond) / static_cast<double>(values.size());
}

/// What is known of the observations of one class.
struct Observations {
  std::vector<double> code_m;
  std::vector<double> rate_static_m_s;
  std::vector<double> rate_moving_m_s;
  std::size_t direct = 0;

  void add(const SatelliteRecord& satellite, bool stands) {
    code_m.push_back(satellite.code_error_m);
    (stands ? rate_static_m_s : rate_moving_m_s)
        .push_back(std::abs(satellite.range_rate_error_m_s));
    if (satellite.is_direct) ++direct;
  }
  [[nodiscard]] Cn0Class figures(std::size_t all) const {
    if (code_m.empty()) return {.count = 0, .share = 0.0};
    const auto count = static_cast<double>(code_m.size());
    return {.count = code_m.size(),
            .share = count / static_cast<double>(all),
            .median_m = quantile(code_m, 0.5),
            .p75_m = quantile(code_m, 0.75),
            .p95_m = quantile(code_m, 0.95),
            .beyond_15_m = share_beyond(code_m, 15.0),
            .beyond_50_m = share_beyond(code_m, 50.0),
            .rate_static_m_s = quantile(rate_static_m_s, 0.95),
            .rate_moving_m_s = quantile(rate_moving_m_s, 0.95),
            .direct_share = static_cast<double>(direct) / count};
  }
};

/// Breaks in the observation of each satellite of one drive.
void add_gaps(const GnssDrive& drive, std::vector<double>& gaps_s) {
  std::map<SatelliteId, Stamp> last;
  for (const EpochRecord& epoch : drive.epochs) {
    for (const SatelliteRecord& satellite : epoch.satellites) {
      if (!satellite.is_tracked) continue;
      const auto [before, is_new] = last.try_emplace(satellite.id, epoch.time);
      if (!is_new && epoch.time - before->second > drive.period * 3 / 2) {
        gaps_s.push_back(to_seconds(epoch.time - before->second));
      }
      before->second = epoch.time;
    }
  }
}

double longest_without_fix_s(const GnssDrive& drive) {
  if (drive.epochs.empty()) return 0.0;
  Stamp last = drive.epochs.front().time - drive.period;
  Duration longest{0};
  for (const EpochRecord& epoch : drive.epochs) {
    if (!epoch.fix) continue;
    longest = std::max(longest, epoch.time - last);
    last = epoch.time;
  }
  longest = std::max(longest, drive.epochs.back().time - last);
  return to_seconds(std::max(longest - drive.period, Duration{0}));
}

/// Fixes of all drives.
struct Fixes {
  std::vector<double> horizontal_m;
  std::vector<double> vertical_m;
  std::vector<double> velocity_m_s;
  std::vector<double> over_claim;

  void add(const FixRecord& fix) {
    const double horizontal = fix.error_m.head<2>().norm();
    horizontal_m.push_back(horizontal);
    vertical_m.push_back(std::abs(fix.error_m.z()));
    velocity_m_s.push_back(fix.velocity_error_m_s.head<2>().norm());
    over_claim.push_back(horizontal * horizontal / fix.covariance_m2.topLeftCorner<2, 2>().trace());
  }
};

}  // namespace

double quantile(std::vector<double> values, double level) {
  if (values.empty()) return kNoFigure;
  std::ranges::sort(values);
  const double place = level * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], place - static_cast<double>(below));
}

ErrorFigures error_figures(const std::vector<double>& amounts) {
  if (amounts.empty()) return {};
  double squares = 0.0;
  for (const double amount : amounts) squares += amount * amount;
  const double mean_square = squares / static_cast<double>(amounts.size());
  const double middle = mean(amounts);
  return {.count = amounts.size(),
          .mean = middle,
          .deviation = std::sqrt(std::max(0.0, mean_square - middle * middle)),
          .rms = std::sqrt(mean_square),
          .p50 = quantile(amounts, 0.5),
          .p95 = quantile(amounts, 0.95),
          .max = std::ranges::max(amounts)};
}

GnssFigures gnss_figures(std::span<const GnssDrive> drives) {
  GnssFigures figures;
  std::array<Observations, kCn0Classes> observations;
  std::vector<double> cn0_db_hz;
  std::vector<double> gaps_s;
  Fixes fixes;
  std::size_t above_horizon = 0;
  double longest_s = 0.0;
  for (const GnssDrive& drive : drives) {
    for (const EpochRecord& epoch : drive.epochs) {
      ++figures.epochs;
      above_horizon += epoch.satellites.size();
      for (const SatelliteRecord& satellite : epoch.satellites) {
        if (!satellite.is_tracked) continue;
        observations[class_of(satellite.cn0_db_hz)].add(satellite,
                                                        epoch.speed_m_s < kStandsBelow_m_s);
        cn0_db_hz.push_back(satellite.cn0_db_hz);
      }
      if (epoch.fix) fixes.add(*epoch.fix);
    }
    add_gaps(drive, gaps_s);
    longest_s = std::max(longest_s, longest_without_fix_s(drive));
  }
  if (figures.epochs == 0) {
    throw InputError("gnss figures: no epochs, needs a drive longer than the receiver's period");
  }
  const auto epochs = static_cast<double>(figures.epochs);
  for (std::size_t i = 0; i < kCn0Classes; ++i) {
    figures.classes[i] = observations[i].figures(cn0_db_hz.size());
  }
  for (std::size_t i = 0; i < kCn0Levels.size(); ++i) {
    figures.cn0_db_hz[i] = quantile(cn0_db_hz, kCn0Levels[i]);
  }
  figures.satellites_tracked = static_cast<double>(cn0_db_hz.size()) / epochs;
  figures.satellites_above_horizon = static_cast<double>(above_horizon) / epochs;
  figures.gaps = gaps_s.size();
  figures.gap_p50_s = quantile(gaps_s, 0.5);
  figures.gap_p90_s = quantile(gaps_s, 0.9);
  figures.gap_max_s = quantile(gaps_s, 1.0);
  figures.availability = static_cast<double>(fixes.horizontal_m.size()) / epochs;
  figures.horizontal_m = error_figures(fixes.horizontal_m);
  figures.vertical_m = error_figures(fixes.vertical_m);
  figures.horizontal_velocity_m_s = error_figures(fixes.velocity_m_s);
  figures.longest_without_fix_s = longest_s;
  figures.overconfidence = mean(fixes.over_claim);
  return figures;
}

TunnelFigures tunnel_figures(const GnssDrive& drive, double from_m, double to_m, double margin_m) {
  TunnelFigures figures;
  std::optional<Stamp> out;
  for (const EpochRecord& epoch : drive.epochs) {
    if (epoch.s_m > from_m + margin_m && epoch.s_m < to_m - margin_m) {
      ++figures.epochs_inside;
      if (epoch.fix) ++figures.fixes_inside;
    }
    if (epoch.s_m < to_m) continue;
    if (!out) out = epoch.time;
    if (epoch.fix) {
      figures.until_fix_s = to_seconds(epoch.time - *out);
      figures.first_error_m = epoch.fix->error_m.head<2>().norm();
      break;
    }
  }
  return figures;
}

}  // namespace locsim::fidelity
