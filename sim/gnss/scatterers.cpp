#include "sim/gnss/scatterers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>

#include "sim/gnss/direct_path.h"

namespace locsim::sim {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kDirections = 96;
constexpr double kLowest_rad = -2.0 * kPi / 180.0;
constexpr double kHighest_rad = 85.0 * kPi / 180.0;
constexpr double kSolidAngle_sr =
    2.0 * kPi * (0.99619 + 0.03490) / static_cast<double>(kDirections);
// Roofs and roads do not face the street.
constexpr double kLevel = 0.5;
constexpr double kLeastPower = 3e-5;
constexpr double kCell_m = 0.5;
// More than the floats of a ray's end: walls on the border of two cells lie in one of them.
constexpr double kCellEdge_m = 1e-3;

/// A spiral of equal solid angles between the two elevations.
std::array<Vector3d, kDirections> make_directions() {
  const double golden_rad = kPi * (3.0 - std::sqrt(5.0));
  const double low = std::sin(kLowest_rad);
  const double high = std::sin(kHighest_rad);
  std::array<Vector3d, kDirections> directions;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double n = static_cast<double>(i);
    const double up = low + (high - low) * (n + 0.5) / static_cast<double>(kDirections);
    const double level = std::sqrt(1.0 - up * up);
    directions[i] = {level * std::cos(golden_rad * n), level * std::sin(golden_rad * n), up};
  }
  return directions;
}

/// The number of the cell that a point lies in; cells repeat after half a million metres.
std::uint64_t cell_of(const Vector3d& point) {
  std::uint64_t cell = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<std::int64_t>(std::floor((point[axis] + kCellEdge_m) / kCell_m));
    cell = cell << 20U | (static_cast<std::uint64_t>(index) & 0xFFFFFU);
  }
  return cell;
}

}  // namespace

Scatterers::Scatterers(const RadioRays& rays, std::span<const RadioMaterial> radio,
                       const Vector3d& antenna, double reach_m)
    : rays_(rays) {
  static const std::array<Vector3d, kDirections> kSphere = make_directions();
  // Walls look the same in every run: their phases belong to the scene.
  static const RandomStream kPhases(0, "gnss/scatterers");
  std::vector<double> leaves_m;
  for (std::size_t first = 0; first < kDirections; first += RayBundle::kMost) {
    RayBundle bundle;
    for (std::size_t i = first; i < std::min(first + RayBundle::kMost, kDirections); ++i) {
      bundle.add(antenna, kSphere[i], reach_m);
    }
    const RadioRays::Ends ends = rays.cast(bundle, leaves_m);
    // As far as the walls: what leaves each ray goes through.
    RayBundle before = bundle;
    for (std::size_t i = 0; i < bundle.size; ++i) {
      before.rays[i].max_range_m =
          ends[i].is_met() ? std::max(ends[i].range_m - RadioRays::kOff_m, 0.0) : 0.0;
    }
    RadioRays::Shades shades = rays.standing_shades(before);
    for (std::size_t i = 0; i < bundle.size; ++i) {
      const RadioRays::End& end = ends[i];
      if (!end.is_met() || end.actor != RadioRays::kStands || std::abs(end.normal.z()) > kLevel) {
        continue;
      }
      const double s = radio[end.material].scattering;
      if (s <= 0.0) continue;
      const Vector3d met = antenna + end.range_m * bundle.rays[i].direction;
      const std::uint64_t cell = cell_of(met);
      patches_.push_back({.point = met + RadioRays::kOff_m * end.normal,
                          .normal = end.normal,
                          .arrival = bundle.rays[i].direction,
                          .range_m = end.range_m,
                          .foliage_m = RadioRays::depth_m(shades[i].leaves_m),
                          .share = s * s * kSolidAngle_sr / kPi,
                          .co = std::polar(std::sqrt(0.5), 2.0 * kPi * kPhases.uniform(cell, 0)),
                          .cross = std::polar(std::sqrt(0.5), 2.0 * kPi * kPhases.uniform(cell, 1)),
                          .material = end.material});
    }
  }
  // Rays from neighbours go the same way through the scene.
  std::ranges::sort(patches_, {}, [](const Patch& patch) {
    return std::tuple(std::atan2(patch.arrival.y(), patch.arrival.x()), patch.arrival.z());
  });
}

std::vector<SignalPath> Scatterers::find(const Vector3d& to_satellite) const {
  std::vector<SignalPath> paths;
  RayBundle bundle;
  const auto settle = [&] {
    // Paths whose ray ends somewhere go again.
    RadioRays::Shades shades = rays_.standing_shades(bundle);
    const std::size_t first = paths.size() - bundle.size;
    std::size_t kept = first;
    for (std::size_t i = 0; i < bundle.size; ++i) {
      if (shades[i].is_dark) continue;
      SignalPath& path = paths[first + i];
      path.foliage_m += RadioRays::depth_m(shades[i].leaves_m);
      const double weight = foliage_amplitude(path.foliage_m);
      path.co *= weight;
      path.cross *= weight;
      if (std::norm(path.co) + std::norm(path.cross) < kLeastPower) continue;
      paths[kept++] = path;
    }
    paths.resize(kept);
    bundle.size = 0;
  };
  for (const Patch& patch : patches_) {
    const double cosine = patch.normal.dot(to_satellite);
    const double power = cosine * patch.share;
    if (power < kLeastPower) continue;
    paths.push_back({.kind = PathKind::scattered,
                     .excess_m = patch.range_m * (1.0 - patch.arrival.dot(to_satellite)),
                     .co = std::sqrt(power) * patch.co,
                     .cross = std::sqrt(power) * patch.cross,
                     .arrival = patch.arrival,
                     .foliage_m = patch.foliage_m,
                     .turn = patch.point,
                     .grazing_rad = std::asin(std::min(cosine, 1.0)),
                     .material = patch.material,
                     .turns = 1});
    bundle.add(patch.point, to_satellite, RadioRays::kSky_m);
    if (bundle.size == RayBundle::kMost) settle();
  }
  settle();
  return paths;
}

}  // namespace locsim::sim
