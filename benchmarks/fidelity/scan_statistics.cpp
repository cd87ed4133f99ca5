#include "benchmarks/fidelity/scan_statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "benchmarks/fidelity/ground_grid.h"
#include "core/error.h"

namespace locsim::fidelity {

namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
/// Distances that differ less do not tell slope from offset: coordinates are good to 1e-6 m.
constexpr double kLeastSpread_m = 0.003;

double horizontal_m(const LaserReturn& r) {
  return std::hypot(static_cast<double>(r.position.x()), static_cast<double>(r.position.y()));
}

/// Steps between successive returns of one laser, over all scans.
std::vector<double> azimuth_steps(std::span<const LaserScan> scans) {
  std::vector<double> steps;
  for (const LaserScan& scan : scans) {
    for (const auto& laser : scan.lasers) {
      for (std::size_t i = 1; i < laser.size(); ++i) {
        steps.push_back(static_cast<double>(laser[i].azimuth_rad) -
                        static_cast<double>(laser[i - 1].azimuth_rad));
      }
    }
  }
  return steps;
}

}  // namespace

Beams fit_beams(std::span<const LaserScan> scans) {
  Beams beams{};
  for (std::size_t laser = 0; laser < kLasers; ++laser) {
    double n = 0.0, mean_x = 0.0, mean_z = 0.0, xx = 0.0, xz = 0.0;
    for (const LaserScan& scan : scans) {
      for (const LaserReturn& r : scan.lasers[laser]) {
        const double x = horizontal_m(r);
        const double z = r.position.z();
        n += 1.0;
        const double dx = x - mean_x;
        mean_x += dx / n;
        mean_z += (z - mean_z) / n;
        xx += dx * (x - mean_x);
        xz += dx * (z - mean_z);
      }
    }
    if (n == 0.0) continue;
    if (xx < n * kLeastSpread_m * kLeastSpread_m) {
      beams[laser].elevation_rad = std::atan2(mean_z, mean_x);
      continue;
    }
    beams[laser].elevation_rad = std::atan2(xz, xx);
    beams[laser].offset_m = mean_z - mean_x * xz / xx;
  }
  return beams;
}

Vector3d beam_direction(const LaserReturn& laser_return, const BeamLine& beam) {
  return (laser_return.position.cast<double>() - Vector3d(0.0, 0.0, beam.offset_m)).normalized();
}

double fired_per_turn(std::span<const LaserScan> scans) {
  std::vector<double> steps = azimuth_steps(scans);
  if (steps.empty()) throw InputError("scans: hold no two returns of one laser");
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  // An encoder of 0.09° gives steps of one and two counts; a missing firing gives three or four.
  const double longest_rad = 1.4 * *middle;
  double sum_rad = 0.0;
  double count = 0.0;
  for (const double step : steps) {
    if (step > longest_rad) continue;
    sum_rad += step;
    count += 1.0;
  }
  return kTurn_rad * count / sum_rad;
}

Histogram::Histogram(double low_edge, double high_edge, std::size_t bins)
    : low(low_edge), high(high_edge), share(bins, 0.0) {}

void Histogram::add(double value) {
  ++count_;
  if (value < low || value >= high) return;
  share[std::min(static_cast<std::size_t>((value - low) / width()), share.size() - 1)] += 1.0;
}

void Histogram::normalise() {
  for (double& s : share) s /= static_cast<double>(std::max<std::size_t>(count_, 1));
}

double Histogram::width() const {
  return (high - low) / static_cast<double>(share.size());
}

double Histogram::center(std::size_t bin) const {
  return low + (static_cast<double>(bin) + 0.5) * width();
}

double Histogram::below(double value) const {
  const double bins = std::clamp((value - low) / width(), 0.0, static_cast<double>(share.size()));
  return std::accumulate(share.begin(), share.begin() + static_cast<std::ptrdiff_t>(bins + 0.5),
                         0.0);
}

double Histogram::quantile(double quantile) const {
  const double wanted = quantile * std::accumulate(share.begin(), share.end(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < share.size(); ++i) {
    sum += share[i];
    if (sum >= wanted) return center(i);
  }
  return high;
}

double distance(const Histogram& a, const Histogram& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.share.size(); ++i) sum += std::abs(a.share[i] - b.share[i]);
  return 0.5 * sum;
}

double ScanStatistics::overall_share() const {
  return std::accumulate(return_share.begin(), return_share.end(), 0.0) / kLasers;
}

ScanStatistics scan_statistics(std::span<const LaserScan> scans) {
  if (scans.empty()) throw InputError("scans: there are none");
  ScanStatistics s;
  s.scans = scans.size();
  s.beams = fit_beams(scans);
  s.fired_per_turn = fired_per_turn(scans);
  const double fired = s.fired_per_turn * static_cast<double>(scans.size());
  const auto sectors = static_cast<double>(s.upper_share_by_azimuth.size());
  for (const LaserScan& scan : scans) {
    const GroundGrid ground(scan);
    s.points_per_scan += static_cast<double>(scan.size()) / static_cast<double>(scans.size());
    for (std::size_t laser = 0; laser < kLasers; ++laser) {
      s.return_share[laser] += static_cast<double>(scan.lasers[laser].size()) / fired;
      for (const LaserReturn& r : scan.lasers[laser]) {
        s.range_m.add(r.range_m);
        s.range_by_group_m[laser / 16].add(r.range_m);
        s.intensity.add(r.intensity);
        s.height_m.add(ground.height_above_m(r.position));
        if (laser < kLasers / 2) continue;
        const auto sector = static_cast<std::size_t>(r.azimuth_rad / kTurn_rad * sectors);
        s.upper_share_by_azimuth[std::min(sector, s.upper_share_by_azimuth.size() - 1)] +=
            sectors / (fired * kLasers / 2);
      }
    }
  }
  s.range_m.normalise();
  for (Histogram& h : s.range_by_group_m) h.normalise();
  s.intensity.normalise();
  s.height_m.normalise();
  return s;
}

}  // namespace locsim::fidelity
