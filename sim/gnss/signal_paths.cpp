#include "sim/gnss/signal_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "sim/gnss/bounces.h"
#include "sim/gnss/direct_path.h"
#include "sim/gnss/fresnel_zone.h"
#include "sim/gnss/mirror_plane.h"
#include "sim/gnss/scatterers.h"

namespace locsim::sim {

namespace {

constexpr double kNormalTolerance = 0.998;
// A reflector that keeps to its plane so closely is a plane.
constexpr double kFlat_m = 0.005;
// Two of what Reflectors merges.
constexpr double kPlaneTolerance_m = 0.15;
// Of a Fresnel zone's points, those that are tried first.
constexpr std::size_t kProbes = 4;

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

Vector3d velocity_at(const Actor& actor, const Vector3d& point, Stamp time) {
  constexpr Duration kStep{1'000'000};
  const Vector3d in_actor = actor.pose_at(time).inverse() * point;
  return (actor.pose_at(time + kStep) * in_actor - actor.pose_at(time - kStep) * in_actor) /
         (2.0 * to_seconds(kStep));
}

}  // namespace

double SignalPath::power_db() const {
  return 10.0 * std::log10(std::norm(co) + std::norm(cross));
}

bool PathFinder::Plane::has(const Mirror& mirror, const Vector3d& turn) const {
  return mirror.bearer == bearer && mirror.surface->normal.dot(normal) > kNormalTolerance &&
         std::abs(normal.dot(turn - point)) < kRelief_m;
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

Mirrors PathFinder::mirrors(std::vector<const Reflector*> standing, const Vector3d& antenna,
                            Stamp time) const {
  std::vector<std::pair<Reflector, std::uint32_t>> moving;
  for (const std::uint32_t i : scene_.actors_near(antenna, kReach_m, time, time)) {
    const Actor& actor = scene_.actors()[i];
    const Pose T_map_actor = actor.pose_at(time);
    for (const Reflector* one :
         shapes_[actor.shape].near(T_map_actor.inverse() * antenna, kReach_m)) {
      moving.emplace_back(moved(*one, T_map_actor), i);
    }
  }
  return {antenna, kReach_m, std::move(standing), std::move(moving)};
}

std::vector<SignalPath> PathFinder::reflections(const RadioRays& rays, const Mirrors& mirrors,
                                                const Vector3d& antenna,
                                                const Vector3d& to_satellite, Stamp time) const {
  std::vector<SignalPath> paths;
  // Cubes, roundings and relief cut a surface into several reflectors: it answers once.
  std::vector<Plane> known;
  for (const Mirror& mirror : mirrors.facing(to_satellite)) {
    const Reflector& surface = *mirror.surface;
    Plane plane{surface.normal, surface.center, mirror.bearer};
    const Specular rough(plane.normal, plane.point, antenna, to_satellite);
    const auto is_this = [&](const Plane& other) { return other.has(mirror, rough.turn); };
    if (std::ranges::any_of(known, is_this)) continue;
    if (surface.unevenness_m > kFlat_m) {
      // The plane of the triangle that is met is the better one.
      const Vector3d arrival = (rough.turn - antenna) / rough.range_m;
      const RadioRays::End end = rays.cast(
          antenna, arrival, rough.range_m + kPlaneTolerance_m / rough.sine + RadioRays::kOff_m);
      const Vector3d met = antenna + std::min(end.range_m, RadioRays::kSky_m) * arrival;
      if (end.actor != mirror.bearer || !end.is_met() ||
          end.normal.dot(plane.normal) < kNormalTolerance ||
          std::abs(plane.normal.dot(met - plane.point)) > kPlaneTolerance_m) {
        continue;
      }
      plane.normal = end.normal;
      plane.point = met;
    }
    known.push_back(plane);
    auto path = reflect(rays, plane, surface.material, antenna, to_satellite);
    if (!path) continue;
    if (mirror.bearer != RadioRays::kStands) {
      path->surface_velocity_m_s = velocity_at(scene_.actors()[mirror.bearer], path->turn, time);
    }
    paths.push_back(*path);
  }
  return paths;
}

std::optional<SignalPath> PathFinder::reflect(const RadioRays& rays, const Plane& plane,
                                              MaterialId material, const Vector3d& antenna,
                                              const Vector3d& to_satellite) const {
  const Specular at(plane.normal, plane.point, antenna, to_satellite);
  if (at.off_m <= 0.0 || at.sine <= 1e-3 || at.range_m > kReach_m) return std::nullopt;
  const FresnelZone zone(plane.normal, at.turn, to_satellite, at.range_m);
  MirrorPlane mirror(radio_, plane.normal, plane.point, plane.bearer, at.sine, kNormalTolerance);
  SignalPath path{.kind = PathKind::reflected,
                  .excess_m = 2.0 * at.off_m * at.sine,
                  .co = 0.0,
                  .arrival = (at.turn - antenna) / at.range_m,
                  .turn = at.turn,
                  .grazing_rad = mirror.grazing_rad(),
                  .material = material,
                  .turns = 1};
  std::vector<double> leaves_before_m;
  std::vector<double> leaves_behind_m;
  for (const auto& [first, last] :
       {std::pair<std::size_t, std::size_t>{0, kProbes}, {kProbes, FresnelZone::kPoints}}) {
    RayBundle to_plane;
    for (std::size_t i = first; i < last; ++i) {
      const Vector3d way = zone.point(i) - antenna;
      const double range_m = way.norm();
      // Relief behind the plane is farther by its depth over the sine of the angle it is seen at.
      to_plane.add(antenna, way / range_m, range_m * (1.0 + kRelief_m / at.off_m));
    }
    const RadioRays::Ends met = rays.cast(to_plane, leaves_before_m);
    std::array<MirrorPlane::Met, RayBundle::kMost> patches;
    RayBundle to_sky;
    for (std::size_t i = 0; i < to_plane.size; ++i) {
      const auto patch = mirror.met(to_plane.rays[i], met[i]);
      if (!patch) continue;
      patches[to_sky.size] = *patch;
      to_sky.add(patch->point + RadioRays::kOff_m * plane.normal, to_satellite, RadioRays::kSky_m);
    }
    const RadioRays::Shades shades = rays.shades(to_sky);
    bool is_dark = true;
    for (std::size_t i = 0; i < to_sky.size; ++i) {
      if (shades[i].is_dark) continue;
      is_dark = false;
      std::ranges::copy(shades[i].leaves_m, std::back_inserter(leaves_behind_m));
      const CircularReflection reflection = mirror.reflection(patches[i]);
      path.co += reflection.co;
      path.cross += reflection.cross;
    }
    if (is_dark && first == 0) return std::nullopt;
  }
  path.foliage_m = RadioRays::depth_m(leaves_before_m) + RadioRays::depth_m(leaves_behind_m);
  const double weight =
      foliage_amplitude(path.foliage_m) / static_cast<double>(FresnelZone::kPoints);
  path.co *= weight;
  path.cross *= weight;
  if (std::norm(path.co) + std::norm(path.cross) < kLeastMirroredPower) return std::nullopt;
  return path;
}

std::vector<SignalPath> PathFinder::find(const Vector3d& antenna_map, const Vector3d& to_satellite,
                                         Stamp time) const {
  return find(antenna_map, std::span(&to_satellite, 1), time).front();
}

std::vector<std::vector<SignalPath>> PathFinder::find(const Vector3d& antenna_map,
                                                      std::span<const Vector3d> to_satellites,
                                                      Stamp time) const {
  std::vector<const Reflector*> standing = standing_.near(antenna_map, kReach_m);
  const RadioRays rays(scene_, radio_, antenna_map, RadioRays::kSky_m, time);
  const Scatterers scatterers(rays, radio_, antenna_map, kReach_m);
  const Bounces bounces(rays, radio_, wall_normals(standing), kReach_m);
  const Mirrors around = mirrors(std::move(standing), antenna_map, time);
  std::vector<std::vector<SignalPath>> found(to_satellites.size());
  for (std::size_t i = 0; i < to_satellites.size(); ++i) {
    const Vector3d& to_satellite = to_satellites[i];
    found[i] = reflections(rays, around, antenna_map, to_satellite, time);
    std::ranges::copy(bounces.find(antenna_map, to_satellite), std::back_inserter(found[i]));
    std::ranges::copy(scatterers.find(to_satellite), std::back_inserter(found[i]));
    if (const auto path = direct_path(rays, antenna_map, to_satellite, RadioRays::kSky_m)) {
      found[i].insert(found[i].begin(), *path);
    }
  }
  return found;
}

}  // namespace locsim::sim
