#include "scenarios/sky_report.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/geodesy.h"
#include "scenarios/gnss_text.h"
#include "sim/gnss/antenna.h"
#include "sim/gnss/constellation.h"
#include "sim/gnss/fresnel.h"
#include "sim/gnss/signal_paths.h"

namespace locsim::scenarios {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kCell_rad = 0.5 * kDegree;
// As the paths of signals are sought.
constexpr double kSky_m = 1000.0;
constexpr double kOffLeaf_m = 0.01;
constexpr int kLeavesMost = 200;

SkyCover cover_along(const sim::RayScene& scene, const std::vector<bool>& is_foliage,
                     const SkyPlace& place, const Vector3d& direction) {
  SkyCover cover = SkyCover::clear;
  double walked_m = 0.0;
  for (int leaf = 0; leaf < kLeavesMost && walked_m < kSky_m; ++leaf) {
    const auto hit = scene.cast(place.antenna_map + walked_m * direction, direction, place.time,
                                kSky_m - walked_m);
    if (!hit) break;
    if (!is_foliage[hit->material]) return SkyCover::blocked;
    cover = SkyCover::foliage;
    walked_m += hit->range_m + kOffLeaf_m;
  }
  return cover;
}

SkyCells cells_around(const sim::RayScene& scene, const SkyPlace& place) {
  std::vector<bool> is_foliage;
  for (const Material& material : scene.materials()) {
    is_foliage.push_back(sim::radio_material(material.name).is_foliage);
  }
  SkyCells cells;
  for (std::size_t j = 0; j < SkyCells::kElevations; ++j) {
    const double elevation_rad = (static_cast<double>(j) + 0.5) * kCell_rad;
    for (std::size_t i = 0; i < SkyCells::kAzimuths; ++i) {
      const double azimuth_rad = (static_cast<double>(i) + 0.5) * kCell_rad;
      const Vector3d direction(std::sin(azimuth_rad) * std::cos(elevation_rad),
                               std::cos(azimuth_rad) * std::cos(elevation_rad),
                               std::sin(elevation_rad));
      cells.set(i, j, cover_along(scene, is_foliage, place, direction));
    }
  }
  return cells;
}

SkyStatus status_of(std::span<const sim::SignalPath> paths) {
  if (paths.empty()) return SkyStatus::blocked;
  const sim::SignalPath& first = paths.front();
  if (first.kind == sim::PathKind::reflected) return SkyStatus::reflected;
  if (first.kind == sim::PathKind::scattered) return SkyStatus::scattered;
  if (first.kind == sim::PathKind::diffracted) return SkyStatus::diffracted;
  return first.foliage_m > 0.0 ? SkyStatus::foliage : SkyStatus::direct;
}

SkySatellite describe_satellite(const sim::SatelliteSight& sight,
                                std::span<const sim::SignalPath> paths,
                                std::span<const Material> materials,
                                const sim::AntennaSpec& antenna) {
  SkySatellite satellite{.id = sight.id,
                         .azimuth_rad = sight.azimuth_rad(),
                         .elevation_rad = sight.elevation_rad(),
                         .status = status_of(paths)};
  const double open = std::norm(sim::received({.arrival = sight.direction}, antenna));
  double together = 0.0;
  double strongest = 0.0;
  for (const sim::SignalPath& path : paths) {
    const double power = std::norm(sim::received(path, antenna));
    together += power;
    if (path.kind != sim::PathKind::reflected) continue;
    ++satellite.reflections;
    if (power <= strongest) continue;
    strongest = power;
    satellite.strongest = {.excess_m = path.excess_m,
                           .power_db = 10.0 * std::log10(power / open),
                           .material = materials[path.material].name,
                           .grazing_rad = path.grazing_rad};
  }
  if (together > 0.0) {
    satellite.cn0_db_hz =
        10.0 * std::log10(sim::zenith_cn0_hz(antenna, sight.id.system) * together);
  }
  return satellite;
}

}  // namespace

std::vector<double> SkyCells::mask_rad() const {
  constexpr std::size_t kDegrees = 360;
  constexpr std::size_t kEach = kAzimuths / kDegrees;
  std::vector<double> mask(kDegrees, 0.0);
  for (std::size_t i = 0; i < kAzimuths; ++i) {
    for (std::size_t j = kElevations; j-- > 0;) {
      if (at(i, j) != SkyCover::blocked) continue;
      double& highest = mask[i / kEach];
      highest = std::max(highest, static_cast<double>(j + 1) * kCell_rad);
      break;
    }
  }
  return mask;
}

double SkyCells::share(SkyCover cover, std::size_t from, std::size_t to) const {
  double covered = 0.0;
  double whole = 0.0;
  for (std::size_t j = 0; j < kElevations; ++j) {
    const double weight = std::cos((static_cast<double>(j) + 0.5) * kCell_rad);
    for (std::size_t i = from; i < to; ++i) {
      whole += weight;
      if (at(i, j) == cover) covered += weight;
    }
  }
  return whole > 0.0 ? covered / whole : 0.0;
}

std::string sky_status_text(SkyStatus status) {
  switch (status) {
    case SkyStatus::direct:
      return "direct";
    case SkyStatus::foliage:
      return "foliage";
    case SkyStatus::diffracted:
      return "diffracted";
    case SkyStatus::reflected:
      return "reflected only";
    case SkyStatus::scattered:
      return "scattered only";
    case SkyStatus::blocked:
      break;
  }
  return "blocked";
}

int SkyReport::count(SkyStatus status) const {
  return static_cast<int>(std::ranges::count(satellites, status, &SkySatellite::status));
}

SkyReport look_at_sky(const sim::World& world, const sim::RayScene& scene, const SkyPlace& place,
                      std::vector<GnssSystem> systems, const sim::AntennaSpec& antenna) {
  SkyReport report{.place = place, .cells = cells_around(scene, place)};
  std::vector<sim::SatelliteSight> sights =
      sim::Constellation(std::move(systems))
          .in_view(LocalFrame(world.origin), place.antenna_map, place.gps_time, 0.0);
  std::ranges::sort(sights, {}, [](const sim::SatelliteSight& sight) { return sight.id.name(); });
  std::vector<Vector3d> directions;
  for (const sim::SatelliteSight& sight : sights) directions.push_back(sight.direction);
  const auto paths = sim::PathFinder(world, scene).find(place.antenna_map, directions, place.time);
  for (std::size_t i = 0; i < sights.size(); ++i) {
    report.satellites.push_back(
        describe_satellite(sights[i], paths[i], scene.materials(), antenna));
  }
  return report;
}

SkyReport sky_report(const Scenario& scenario, const Stage& stage, double at_s) {
  const double end_s = stage.route.duration_s();
  if (!(at_s >= 0.0 && at_s <= end_s)) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "--at is %g s; the drive is scheduled from 0 to %.1f s: choose a time within it",
                  at_s, end_s);
    throw InputError(scenario.name + ": " + text);
  }
  const Pose T_map_vehicle = stage.route.pose(stage.route.s_at_time(at_s));
  const Stamp time = stamp_from_seconds(at_s);
  const SkyPlace place{.antenna_map = T_map_vehicle * scenario.sensors.gnss.mount.position_m,
                       .time = time,
                       .gps_time = scenario.gps_start() + time.time_since_epoch()};
  const sim::RayScene scene(stage.world, stage.actors);
  const sim::GnssSpec& spec = scenario.sensors.gnss.spec;
  SkyReport report = look_at_sky(stage.world, scene, place, spec.systems.list(), spec.antenna);
  const double heading_rad = std::numbers::pi / 2.0 - T_map_vehicle.yaw();
  report.heading_rad = heading_rad < 0.0 ? heading_rad + 2.0 * std::numbers::pi : heading_rad;
  return report;
}

std::string utc_text(sim::GpsTime time) {
  const CalendarTime utc = calendar_time(time - leap_seconds());
  char text[96];
  std::snprintf(text, sizeof text, "%04d-%02d-%02d %02d:%02d:%02d UTC", utc.year, utc.month,
                utc.day, utc.hour, utc.minute,
                static_cast<int>(utc.rest / std::chrono::seconds(1)));
  return text;
}

}  // namespace locsim::scenarios
