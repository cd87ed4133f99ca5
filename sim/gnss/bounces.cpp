#include "sim/gnss/bounces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iterator>
#include <optional>
#include <utility>

#include "sim/gnss/direct_path.h"
#include "sim/gnss/fresnel_zone.h"
#include "sim/gnss/mirror_plane.h"

namespace locsim::sim {

namespace {

constexpr std::size_t kNormalsMost = 6;
constexpr double kLevel = 0.2;
// 1°.
constexpr double kSameNormal = 0.99985;
// As floats have it: less than a millimetre at the end of reach.
constexpr double kSameDirection = 1e-6;
// Walls that throw to and fro.
constexpr double kFacing = -0.9;
constexpr double kLeastSine = 0.02;
constexpr std::size_t kPoints = 8;
constexpr std::size_t kTurnsMost = 3;

Vector3d mirrored(const Vector3d& direction, const Vector3d& normal) {
  return direction - 2.0 * direction.dot(normal) * normal;
}

/// Directions of a ray that leaves the antenna, after each wall; the last is the satellite's.
struct Way {
  std::array<Vector3d, kTurnsMost + 1> directions;
  std::array<double, kTurnsMost> sines{};
};

/// Nothing where a wall would be met from behind or along itself.
std::optional<Way> way_of(std::span<const Vector3d> normals, const Vector3d& to_satellite) {
  Way way;
  way.directions[normals.size()] = to_satellite;
  for (std::size_t i = normals.size(); i-- > 0;) {
    way.sines[i] = way.directions[i + 1].dot(normals[i]);
    if (way.sines[i] < kLeastSine) return std::nullopt;
    way.directions[i] = mirrored(way.directions[i + 1], normals[i]);
  }
  return way;
}

/// What of a field keeps its sense of rotation, and what has it turned.
struct Field {
  std::complex<double> co = 1.0;
  std::complex<double> cross = 0.0;

  void reflect(const CircularReflection& by) {
    const Field before = *this;
    co = by.co * before.co + by.cross * before.cross;
    cross = by.cross * before.co + by.co * before.cross;
  }
};

}  // namespace

std::vector<Vector3d> wall_normals(std::span<const Reflector* const> surfaces) {
  struct Facing {
    Vector3d normal = Vector3d::Zero();
    double area_m2 = 0.0;
  };
  std::vector<Facing> all;
  for (const Reflector* surface : surfaces) {
    if (std::abs(surface->normal.z()) > kLevel) continue;
    const auto same = std::ranges::find_if(
        all, [&](const Facing& known) { return known.normal.dot(surface->normal) > kSameNormal; });
    if (same == all.end()) {
      all.push_back({surface->normal, surface->area_m2});
    } else {
      same->area_m2 += surface->area_m2;
    }
  }
  std::ranges::stable_sort(all, std::ranges::greater{}, &Facing::area_m2);
  all.resize(std::min(all.size(), kNormalsMost));
  std::vector<Vector3d> normals;
  for (const Facing& facing : all) normals.push_back(facing.normal);
  return normals;
}

Bounces::Bounces(const RadioRays& rays, std::span<const RadioMaterial> radio,
                 std::vector<Vector3d> normals, double reach_m)
    : rays_(rays), radio_(radio), normals_(std::move(normals)), reach_m_(reach_m) {}

std::vector<SignalPath> Bounces::find(const Vector3d& antenna, const Vector3d& to_satellite) const {
  std::vector<SignalPath> paths;
  const auto keep = [&](Sequence sequence) {
    if (const auto path = follow(sequence, antenna, to_satellite)) paths.push_back(*path);
  };
  for (std::size_t i = 0; i < normals_.size(); ++i) {
    for (std::size_t j = 0; j < normals_.size(); ++j) {
      if (i == j) continue;
      keep(std::array{i, j});
      if (normals_[i].dot(normals_[j]) < kFacing) keep(std::array{i, j, i});
    }
  }
  return paths;
}

std::optional<SignalPath> Bounces::follow(Sequence sequence, const Vector3d& antenna,
                                          const Vector3d& to_satellite) const {
  const std::size_t turns = sequence.size();
  std::array<Vector3d, kTurnsMost> normals;
  for (std::size_t i = 0; i < turns; ++i) normals[i] = normals_[sequence[i]];
  auto way = way_of(std::span(normals).first(turns), to_satellite);
  if (!way) return std::nullopt;

  // The middle ray finds the planes; once more along what their own normals say.
  std::array<Vector3d, kTurnsMost> points;
  MaterialId material = 0;
  for (int pass = 0; pass < 2; ++pass) {
    Vector3d from = antenna;
    bool is_as_supposed = true;
    for (std::size_t i = 0; i < turns; ++i) {
      const RadioRays::End end = rays_.cast(from, way->directions[i], reach_m_);
      if (!end.is_met() || end.actor != RadioRays::kStands ||
          end.normal.dot(normals_[sequence[i]]) < kSameNormal) {
        return std::nullopt;
      }
      points[i] = from + end.range_m * way->directions[i];
      is_as_supposed = is_as_supposed && (end.normal - normals[i]).norm() < kSameDirection;
      normals[i] = end.normal;
      from = points[i] + RadioRays::kOff_m * end.normal;
      if (i == 0) material = end.material;
    }
    way = way_of(std::span(normals).first(turns), to_satellite);
    if (!way) return std::nullopt;
    if (is_as_supposed) break;
  }

  // Images of the antenna, one wall after another.
  Vector3d image = antenna;
  for (std::size_t i = 0; i < turns; ++i) {
    image -= 2.0 * normals[i].dot(image - points[i]) * normals[i];
  }
  SignalPath path{.kind = PathKind::reflected,
                  .excess_m = (antenna - image).dot(to_satellite),
                  .co = 0.0,
                  .arrival = way->directions[0],
                  .turn = points[0],
                  .grazing_rad = std::asin(std::min(way->sines[0], 1.0)),
                  .material = material,
                  .turns = static_cast<int>(turns)};

  double length_m = (points[0] - antenna).norm();
  for (std::size_t i = 1; i < turns; ++i) length_m += (points[i] - points[i - 1]).norm();
  const FresnelZone zone(normals[0], points[0], way->directions[1], length_m);
  RayBundle bundle;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const Vector3d to_wall = zone.point(k) - antenna;
    bundle.add(antenna, to_wall.normalized(), to_wall.norm() + reach_m_);
  }
  std::array<Field, kPoints> fields;
  for (std::size_t i = 0; i < turns; ++i) {
    std::vector<double> leaves_m;
    const RadioRays::Ends met = rays_.cast(bundle, leaves_m);
    path.foliage_m += RadioRays::depth_m(leaves_m);
    MirrorPlane mirror(radio_, normals[i], points[i], RadioRays::kStands, way->sines[i],
                       kSameNormal);
    RayBundle next;
    for (std::size_t k = 0; k < bundle.size; ++k) {
      const auto patch = mirror.met(bundle.rays[k], met[k]);
      if (!patch) continue;
      Field field = fields[k];
      field.reflect(mirror.reflection(*patch));
      fields[next.size] = field;
      const bool is_last = i + 1 == turns;
      next.add(patch->point + RadioRays::kOff_m * normals[i], way->directions[i + 1],
               is_last ? RadioRays::kSky_m : reach_m_);
    }
    bundle = next;
  }
  std::vector<double> leaves_m;
  const RadioRays::Shades shades = rays_.shades(bundle);
  for (std::size_t k = 0; k < bundle.size; ++k) {
    if (shades[k].is_dark) continue;
    std::ranges::copy(shades[k].leaves_m, std::back_inserter(leaves_m));
    path.co += fields[k].co;
    path.cross += fields[k].cross;
  }
  path.foliage_m += RadioRays::depth_m(leaves_m);
  const double weight = foliage_amplitude(path.foliage_m) / static_cast<double>(kPoints);
  path.co *= weight;
  path.cross *= weight;
  if (std::norm(path.co) + std::norm(path.cross) < kLeastMirroredPower) return std::nullopt;
  return path;
}

}  // namespace locsim::sim
