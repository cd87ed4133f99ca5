#include "benchmarks/fidelity/street_figures.h"

#include <algorithm>
#include <cmath>

namespace locsim::fidelity {

namespace {

/// Steeper than 45°.
constexpr float kSteep = 0.7071F;
/// Fewer returns say nothing of a laser's bias, fewer rays nothing of a reflection.
constexpr std::size_t kFewestForBias = 200;
constexpr std::size_t kFewestRays = 100;
/// So steep that an error of the azimuth hardly changes the range.
constexpr float kSquare = 0.9F;
/// Facades are what lasers that do not point to the ground see as planes.
constexpr std::uint8_t kFirstFacadeLaser = 50;

double median_of(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Sums up what one class of rays sends back.
class Reflector {
 public:
  void add(bool is_seen, double cosine, double intensity) {
    ++rays_;
    cosines_.push_back(cosine);
    if (!is_seen) return;
    if (intensity == 0.0) ++zeros_;
    intensities_.push_back(intensity);
  }
  [[nodiscard]] std::size_t rays() const { return rays_; }
  [[nodiscard]] Reflection reflection(double from, double to) {
    const auto seen = static_cast<double>(intensities_.size());
    return {.from = from,
            .to = to,
            .rays = rays_,
            .seen_share = seen / static_cast<double>(rays_),
            .median_cosine = median_of(cosines_),
            .median_intensity = median_of(intensities_),
            .zero_share = static_cast<double>(zeros_) / std::max(seen, 1.0)};
  }

 private:
  std::size_t rays_ = 0;
  std::size_t zeros_ = 0;
  std::vector<double> cosines_;
  std::vector<double> intensities_;
};

/// One reflection for each pair of successive `edges` in which `value(ray)` lies often enough.
template <typename Ray, typename Value, typename Add>
std::vector<Reflection> classes(std::span<const Ray> rays, std::span<const double> edges,
                                const Value& value, const Add& add) {
  std::vector<Reflector> reflectors(edges.size() - 1);
  for (const Ray& ray : rays) {
    const auto above = std::ranges::upper_bound(edges, static_cast<double>(value(ray)));
    if (above == edges.begin() || above == edges.end()) continue;
    add(reflectors[static_cast<std::size_t>(above - edges.begin()) - 1], ray);
  }
  std::vector<Reflection> reflections;
  for (std::size_t i = 0; i < reflectors.size(); ++i) {
    if (reflectors[i].rays() < kFewestRays) continue;
    reflections.push_back(reflectors[i].reflection(edges[i], edges[i + 1]));
  }
  return reflections;
}

void add_ground(std::span<const GroundRay> rays, StreetFigures& figures) {
  constexpr std::array kEdges_m = {4.0,  6.0,  8.0,  10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 22.0,
                                   24.0, 26.0, 28.0, 32.0, 36.0, 40.0, 45.0, 50.0, 55.0, 60.0};
  figures.ground_by_range = classes(
      rays, std::span<const double>(kEdges_m), [](const GroundRay& r) { return r.range_m; },
      [](Reflector& to, const GroundRay& r) { to.add(r.is_seen, r.cos_incidence, r.intensity); });
  std::array<std::vector<double>, kLasers> seen_m;
  std::array<std::size_t, kLasers> rays_of{};
  for (const GroundRay& r : rays) {
    ++rays_of[r.laser];
    if (r.is_seen) seen_m[r.laser].push_back(r.range_m);
  }
  for (std::size_t laser = 0; laser < kLasers; ++laser) {
    std::vector<double>& ranges = seen_m[laser];
    if (ranges.size() < kFewestRays) continue;
    figures.ground_seen_by_laser[laser] =
        static_cast<double>(ranges.size()) / static_cast<double>(rays_of[laser]);
    const auto nth = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() * 99 / 100);
    std::nth_element(ranges.begin(), nth, ranges.end());
    figures.ground_end_m[laser] = *nth;
  }
}

void add_facades(std::span<const Residual> planes, StreetFigures& figures) {
  constexpr std::array kCosines = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
  constexpr std::array kEdges_m = {6.0, 9.0, 12.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0};
  std::vector<Residual> at_one_range;
  std::vector<Residual> steep;
  for (const Residual& r : planes) {
    if (r.laser < kFirstFacadeLaser) continue;
    if (r.range_m >= 20.0F && r.range_m < 25.0F) at_one_range.push_back(r);
    if (r.cos_incidence > kSteep) steep.push_back(r);
  }
  const auto add = [](Reflector& to, const Residual& r) {
    to.add(true, r.cos_incidence, r.intensity);
  };
  figures.facade_by_cosine = classes(
      std::span<const Residual>(at_one_range), std::span<const double>(kCosines),
      [](const Residual& r) { return r.cos_incidence; }, add);
  figures.facade_by_range = classes(
      std::span<const Residual>(steep), std::span<const double>(kEdges_m),
      [](const Residual& r) { return r.range_m; }, add);
}

void add_noise(std::span<const Residual> planes, std::span<const Residual> lasers,
               std::span<const Residual> neighbours, StreetFigures& figures) {
  constexpr std::array kEdges_m = {3.0, 6.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 80.0};
  constexpr std::array kCosines = {0.05, 0.1, 0.2, 0.4, 0.7071, 1.0001};
  figures.plane_noise = noise_of(planes);
  figures.laser_noise = noise_of(lasers);
  for (std::size_t laser = 0; laser < kLasers; ++laser) {
    const auto is_own = [laser](const Residual& r) { return r.laser == laser; };
    figures.plane_noise_by_laser[laser] = noise_where(planes, is_own);
    figures.laser_noise_by_laser[laser] = noise_where(lasers, is_own);
    const Noise bias = noise_where(neighbours, [laser](const Residual& r) {
      return r.laser == laser && r.cos_incidence > kSquare;
    });
    if (bias.count >= kFewestForBias) figures.bias_by_laser[laser] = bias;
  }
  for (std::size_t i = 0; i + 1 < kEdges_m.size(); ++i) {
    const auto is_there = [&](const Residual& r) {
      return r.range_m >= kEdges_m[i] && r.range_m < kEdges_m[i + 1];
    };
    figures.noise_by_range.push_back(
        {.from = kEdges_m[i],
         .to = kEdges_m[i + 1],
         .planes = noise_where(
             planes, [&](const Residual& r) { return is_there(r) && r.cos_incidence > kSteep; }),
         .laser = noise_where(lasers, is_there)});
  }
  for (std::size_t i = 0; i + 1 < kCosines.size(); ++i) {
    figures.noise_by_cosine.push_back(
        {.from = kCosines[i],
         .to = kCosines[i + 1],
         .planes = noise_where(planes,
                               [&](const Residual& r) {
                                 return r.range_m < 20.0F && r.cos_incidence >= kCosines[i] &&
                                        r.cos_incidence < kCosines[i + 1];
                               }),
         .laser = {}});
  }
}

}  // namespace

double StreetFigures::beam_bias_m() const {
  double square = 0.0;
  double count = 0.0;
  for (const Noise& bias : bias_by_laser) {
    if (bias.count == 0) continue;
    square += bias.median_m * bias.median_m;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(square / count / 1.5) : 0.0;
}

StreetFigures street_figures(std::span<const LaserScan> scans, std::size_t stride) {
  StreetFigures figures;
  figures.statistics = scan_statistics(scans);
  const Beams& beams = figures.statistics.beams;
  std::vector<GroundRay> ground;
  std::vector<Residual> planes, lasers, neighbours;
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const LaserScan& scan : scans) {
    append(ground, ground_rays(scan, beams, figures.statistics.fired_per_turn));
    append(planes, plane_residuals(scan, beams, PlaneFrom::all_three, stride));
    append(neighbours, plane_residuals(scan, beams, PlaneFrom::neighbours, stride));
    append(lasers, laser_residuals(scan, stride));
  }
  add_ground(ground, figures);
  add_facades(planes, figures);
  add_noise(planes, lasers, neighbours, figures);
  return figures;
}

}  // namespace locsim::fidelity
