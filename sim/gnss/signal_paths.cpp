#include "sim/gnss/signal_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace locsim::sim {

namespace {

// Nothing of a world that is 10° up stands higher than this reaches.
constexpr double kSky_m = 1000.0;
// Off a surface before looking on from it: more than a float of the map frame.
constexpr double kOff_m = 0.01;
// What a ray finds against where its plane was thought: reflectors' planes agree to 0.1 m.
constexpr double kPlaneTolerance_m = 0.15;
constexpr double kNormalTolerance = 0.999;

// Single trees take 10 to 20 dB at 869 MHz (Vogel and Goldhirsh 1986), 1.3 dB/m of crown, and a
// third more in dB at 1.6 GHz.
constexpr double kFoliage_db_m = 1.7;
constexpr double kFoliageMost_db = 20.0;
// Leaves further apart belong to different crowns; a single one counts as a thin crown.
constexpr double kCrownGap_m = 2.0;
constexpr double kLeaf_m = 0.3;
constexpr int kLeavesMost = 200;

// Fresnel parameter beyond which the knife edge leaves less than −20 dB.
constexpr double kDeepShadow_v = 2.25;
constexpr double kOutOfShadow_v = -0.78;

/// Unit directions across a ray: upwards, right, left.
std::array<Vector3d, 3> sides_of(const Vector3d& direction) {
  const Vector3d flat = direction.cross(Vector3d::UnitZ());
  const Vector3d right = flat.norm() > 1e-6 ? flat.normalized() : Vector3d(Vector3d::UnitX());
  return {right.cross(direction), right, -right};
}

double foliage_amplitude(double foliage_m) {
  return std::pow(10.0, -std::min(kFoliage_db_m * foliage_m, kFoliageMost_db) / 20.0);
}

/// Where an edge cuts the view to one side of a ray.
struct Edge {
  double tangent = 0.0;
  double range_m = 0.0;

  [[nodiscard]] double v() const { return tangent * std::sqrt(2.0 * range_m / kL1Wavelength_m); }
};

/// Narrows an edge between a tangent where `range_at` says what is met and one where nothing is.
template <class RangeAt>
Edge narrow(double blocked, double range_m, double clear, const RangeAt& range_at) {
  for (int i = 0; i < 6; ++i) {
    const double middle = 0.5 * (blocked + clear);
    if (const std::optional<double> met_m = range_at(middle)) {
      blocked = middle;
      range_m = *met_m;
    } else {
      clear = middle;
    }
  }
  return {.tangent = 0.5 * (blocked + clear), .range_m = range_m};
}

std::vector<RadioMaterial> radio_materials(const World& world) {
  std::vector<RadioMaterial> radio;
  for (const Material& material : world.materials) radio.push_back(radio_material(material.name));
  return radio;
}

std::vector<bool> mirrors_of(const std::vector<RadioMaterial>& radio) {
  std::vector<bool> is_mirror;
  for (const RadioMaterial& material : radio) is_mirror.push_back(!material.is_foliage);
  return is_mirror;
}

Reflectors standing_reflectors(const World& world, const std::vector<bool>& is_mirror) {
  const std::array<const TriangleMesh*, 3> meshes = {&world.ground, &world.structures,
                                                     &world.parked_cars};
  return {meshes, is_mirror};
}

}  // namespace

double SignalPath::power_db() const {
  return 10.0 * std::log10(std::norm(co) + std::norm(cross));
}

PathFinder::PathFinder(const World& world, const RayScene& scene)
    : scene_(scene),
      radio_(radio_materials(world)),
      standing_(standing_reflectors(world, mirrors_of(radio_))) {
  for (const TriangleMesh& shape : world.actor_shapes) {
    const TriangleMesh* one = &shape;
    shapes_.emplace_back(std::span(&one, 1), mirrors_of(radio_));
  }
}

PathFinder::Leg PathFinder::walk(const Vector3d& origin, const Vector3d& direction,
                                 double max_range_m, Stamp time) const {
  Leg leg;
  double walked_m = 0.0;
  while (walked_m < max_range_m && static_cast<int>(leg.leaves_m.size()) < kLeavesMost) {
    auto hit = scene_.cast(origin + walked_m * direction, direction, time, max_range_m - walked_m);
    if (!hit) break;
    hit->range_m += walked_m;
    if (!radio_[hit->material].is_foliage) {
      leg.end = hit;
      break;
    }
    leg.leaves_m.push_back(hit->range_m);
    walked_m = hit->range_m + kOff_m;
  }
  return leg;
}

double PathFinder::foliage_m(const Vector3d& origin, const Vector3d& direction, double max_range_m,
                             Stamp time) const {
  // Leaves are few and crowns mostly air: a bundle about as wide as the first Fresnel zone finds
  // what of a crown lies around the ray.
  constexpr double kBundle = 0.06;
  const std::array<Vector3d, 3> side = sides_of(direction);
  std::vector<double> leaves_m = walk(origin, direction, max_range_m, time).leaves_m;
  for (int i = 0; i < 6; ++i) {
    const double angle = std::numbers::pi / 3.0 * i;
    const Vector3d aside = std::cos(angle) * side[0] + std::sin(angle) * side[1];
    const Leg leg = walk(origin, (direction + kBundle * aside).normalized(), max_range_m, time);
    leaves_m.insert(leaves_m.end(), leg.leaves_m.begin(), leg.leaves_m.end());
  }
  std::ranges::sort(leaves_m);
  double depth_m = 0.0;
  for (std::size_t i = 0; i < leaves_m.size(); ++i) {
    const bool is_same_crown = i > 0 && leaves_m[i] - leaves_m[i - 1] < kCrownGap_m;
    depth_m += is_same_crown ? leaves_m[i] - leaves_m[i - 1] : kLeaf_m;
  }
  return depth_m;
}

std::optional<SignalPath> PathFinder::direct(const Vector3d& antenna, const Vector3d& to_satellite,
                                             Stamp time) const {
  const Leg leg = walk(antenna, to_satellite, kSky_m, time);
  const std::array<Vector3d, 3> sides = sides_of(to_satellite);
  const auto range_towards = [&](const Vector3d& across) {
    return [&, across](double tangent) -> std::optional<double> {
      const Vector3d aside = (to_satellite + tangent * across).normalized();
      const Leg seen = walk(antenna, aside, kSky_m, time);
      if (!seen.end) return std::nullopt;
      return seen.end->range_m;
    };
  };
  SignalPath path{.arrival = to_satellite,
                  .foliage_m = foliage_m(antenna, to_satellite, kSky_m, time)};
  if (!leg.end) {
    // An edge beside the ray takes something as long as the ray passes close to it.
    double worst_db = 0.0;
    const std::array<Vector3d, 4> around = {sides[0], sides[1], sides[2], -sides[0]};
    for (const Vector3d& across : around) {
      const auto range_at = range_towards(across);
      double clear = 0.0;
      for (const double tangent : {0.01, 0.02, 0.04, 0.08}) {
        if (const auto met_m = range_at(tangent)) {
          const Edge edge = narrow(tangent, *met_m, clear, range_at);
          worst_db = std::max(worst_db, knife_edge_loss_db(-edge.v()));
          break;
        }
        clear = tangent;
      }
    }
    path.co = foliage_amplitude(path.foliage_m) * std::pow(10.0, -worst_db / 20.0);
    return path;
  }
  path.kind = PathKind::diffracted;
  std::array<double, 3> amplitude{};
  double strongest = 0.0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto range_at = range_towards(sides[i]);
    double blocked = 0.0;
    double range_m = leg.end->range_m;
    constexpr int kSteps = 8;
    for (int step = 1; step <= kSteps; ++step) {
      // Squared: dense near the ray, where thin things stand.
      const double share = static_cast<double>(step) / kSteps;
      const double tangent =
          share * share * kDeepShadow_v / std::sqrt(2.0 * leg.end->range_m / kL1Wavelength_m);
      if (const auto met_m = range_at(tangent)) {
        blocked = tangent;
        range_m = *met_m;
        continue;
      }
      const Edge edge = narrow(blocked, range_m, tangent, range_at);
      if (edge.v() > kDeepShadow_v) break;
      amplitude[i] = std::pow(10.0, -knife_edge_loss_db(edge.v()) / 20.0);
      if (amplitude[i] > strongest) {
        strongest = amplitude[i];
        const Vector3d to_edge = edge.range_m * (to_satellite + edge.tangent * sides[i]);
        path.turn = antenna + to_edge;
        path.arrival = to_edge.normalized();
        path.excess_m = to_edge.norm() - to_edge.dot(to_satellite);
      }
      break;
    }
  }
  // Round both sides of a pole the halves add up to nearly the whole.
  const double total = std::max(amplitude[0], std::min(1.0, amplitude[1] + amplitude[2]));
  if (total <= 0.0) return std::nullopt;
  path.co = total * foliage_amplitude(path.foliage_m);
  return path;
}

std::vector<PathFinder::Mirror> PathFinder::mirrors(const Vector3d& antenna, Stamp time) const {
  std::vector<Mirror> found;
  for (const Reflector& surface : standing_.near(antenna, kReach_m)) found.push_back({surface});
  for (const std::uint32_t i : scene_.actors_near(antenna, kReach_m, time, time)) {
    const Actor& actor = scene_.actors()[i];
    const Pose T_map_actor = actor.pose_at(time);
    const Vector3d antenna_in_actor = T_map_actor.inverse() * antenna;
    for (Reflector surface : shapes_[actor.shape].near(antenna_in_actor, kReach_m)) {
      Eigen::AlignedBox3d bounds;
      for (int corner = 0; corner < 8; ++corner) {
        bounds.extend(T_map_actor * Vector3d(surface.bounds.corner(
                                        static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
      }
      surface.bounds = bounds;
      surface.center = T_map_actor * surface.center;
      surface.normal = T_map_actor.rotation * surface.normal;
      found.push_back({.surface = surface, .actor = i});
    }
  }
  return found;
}

std::optional<SignalPath> PathFinder::reflect(const Mirror& mirror, const Vector3d& antenna,
                                              const Vector3d& to_satellite, Stamp time) const {
  Vector3d normal = mirror.surface.normal;
  Vector3d on_plane = mirror.surface.center;
  // Twice: the plane of the reflector finds the triangle, and its own plane the point.
  double tolerance_m = kPlaneTolerance_m;
  for (int pass = 0;; ++pass) {
    const double off_m = normal.dot(antenna - on_plane);
    const double sine = normal.dot(to_satellite);
    if (off_m <= 0.0 || sine <= 1e-3 || off_m > sine * kReach_m) return std::nullopt;
    // The antenna's image sees the satellite through the point.
    const Vector3d image = antenna - 2.0 * off_m * normal;
    const double range_m = off_m / sine;
    const Vector3d point = image + range_m * to_satellite;
    if (pass == 0 && mirror.surface.bounds.exteriorDistance(point) > kPlaneTolerance_m) {
      return std::nullopt;
    }
    const Vector3d arrival = (point - antenna) / range_m;
    const Leg leg = walk(antenna, arrival, range_m + tolerance_m / sine + kOff_m, time);
    if (!leg.end || leg.end->material != mirror.surface.material ||
        (leg.end->surface == Surface::actor ? leg.end->actor : kStands) != mirror.actor ||
        leg.end->normal.dot(normal) < kNormalTolerance) {
      return std::nullopt;
    }
    const Vector3d met = antenna + leg.end->range_m * arrival;
    if (std::abs(normal.dot(met - on_plane)) > tolerance_m) return std::nullopt;
    if (pass == 0) {
      normal = leg.end->normal;
      on_plane = met;
      continue;
    }
    const Vector3d outside = point + kOff_m * normal;
    if (walk(outside, to_satellite, kSky_m, time).end) return std::nullopt;
    SignalPath path{.kind = PathKind::reflected,
                    .excess_m = 2.0 * off_m * sine,
                    .arrival = arrival,
                    .turn = point,
                    .grazing_rad = std::asin(std::min(sine, 1.0)),
                    .material = mirror.surface.material};
    path.foliage_m = foliage_m(antenna, arrival, range_m - kOff_m, time) +
                     foliage_m(outside, to_satellite, kSky_m, time);
    const double through = foliage_amplitude(path.foliage_m);
    const CircularReflection reflection =
        reflect_circular(radio_[path.material], path.grazing_rad, kL1Wavelength_m);
    path.co = through * reflection.co;
    path.cross = through * reflection.cross;
    if (mirror.actor != kStands) {
      const Actor& actor = scene_.actors()[mirror.actor];
      constexpr Duration kStep{1'000'000};
      const Vector3d in_actor = actor.pose_at(time).inverse() * point;
      path.surface_velocity_m_s =
          (actor.pose_at(time + kStep) * in_actor - actor.pose_at(time - kStep) * in_actor) /
          (2.0 * to_seconds(kStep));
    }
    return path;
  }
}

std::vector<SignalPath> PathFinder::find(const Vector3d& antenna_map, const Vector3d& to_satellite,
                                         Stamp time) const {
  return find(antenna_map, std::span(&to_satellite, 1), time).front();
}

std::vector<std::vector<SignalPath>> PathFinder::find(const Vector3d& antenna_map,
                                                      std::span<const Vector3d> to_satellites,
                                                      Stamp time) const {
  const std::vector<Mirror> around = mirrors(antenna_map, time);
  std::vector<std::vector<SignalPath>> found(to_satellites.size());
  for (std::size_t i = 0; i < to_satellites.size(); ++i) {
    std::vector<SignalPath>& paths = found[i];
    if (const auto path = direct(antenna_map, to_satellites[i], time)) paths.push_back(*path);
    for (const Mirror& mirror : around) {
      const auto path = reflect(mirror, antenna_map, to_satellites[i], time);
      if (!path) continue;
      // A surface cut between cubes or roundings answers once for each of its reflectors.
      constexpr double kSame_m = 0.05;
      const bool is_known = std::ranges::any_of(paths, [&](const SignalPath& known) {
        return known.kind == PathKind::reflected && (known.turn - path->turn).norm() < kSame_m;
      });
      if (!is_known) paths.push_back(*path);
    }
  }
  return found;
}

}  // namespace locsim::sim
