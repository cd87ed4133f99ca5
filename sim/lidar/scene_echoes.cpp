#include "sim/lidar/scene_echoes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace locsim::sim {

namespace {

constexpr double kSlack_rad = 1e-3;
/// Panes that light is followed through: both of a car, and of a house behind it.
constexpr int kMostPanes = 4;
/// Behind a pane the search goes on this far from it, clear of its own plane.
constexpr float kBehindPane_m = 1e-3F;

// Which directions of the lidar frame may meet a sphere.
struct Cap {
  double azimuth_rad;
  double elevation_rad;
  double half_azimuth_rad;
  double half_elevation_rad;
  double distance_m;
};

Cap cap_of(const Vector3d& center, double radius_m) {
  const double level_m = center.head<2>().norm();
  const double distance_m = center.norm();
  const auto half_angle = [&](double d) {
    return d > radius_m ? std::asin(radius_m / d) + kSlack_rad : std::numbers::pi;
  };
  return {.azimuth_rad = std::atan2(center.y(), center.x()),
          .elevation_rad = std::atan2(center.z(), level_m),
          .half_azimuth_rad = half_angle(level_m),
          .half_elevation_rad = half_angle(distance_m),
          .distance_m = distance_m - radius_m};
}

RTCIntersectContext coherent_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

Vector3f normal_of(const RTCRayHit16& packet, int lane) {
  return Vector3f(packet.hit.Ng_x[lane], packet.hit.Ng_y[lane], packet.hit.Ng_z[lane]).normalized();
}

// The same of sixteen surfaces, their optics column by column.
struct OpticsLanes {
  Lanes lambert = Lanes::Zero();
  Lanes rough = Lanes::Zero();
  Lanes flat = Lanes::Zero();

  void set(int lane, const Optics& optics) {
    lambert(lane) = optics.lambert;
    rough(lane) = optics.rough;
    flat(lane) = optics.flat;
  }
  [[nodiscard]] Lanes strength(const Lanes& cosines) const {
    return strength_of(lambert, rough, flat, cosines);
  }
};

void set_ray(RTCRayHit16& packet, int lane, const Vector3f& origin, const Vector3f& direction,
             float near_m, float far_m) {
  packet.ray.org_x[lane] = origin.x();
  packet.ray.org_y[lane] = origin.y();
  packet.ray.org_z[lane] = origin.z();
  packet.ray.dir_x[lane] = direction.x();
  packet.ray.dir_y[lane] = direction.y();
  packet.ray.dir_z[lane] = direction.z();
  packet.ray.tnear[lane] = near_m;
  packet.ray.tfar[lane] = far_m;
  packet.ray.time[lane] = 0.0F;
  packet.ray.mask[lane] = ~0U;
  packet.ray.flags[lane] = 0U;
  packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

}  // namespace

void SceneEchoes::reset(std::size_t packets) {
  surfaces.resize(packets);
  further_.clear();
  first_.assign(packets * kLanes, -1);
}

void SceneEchoes::add_further(std::uint32_t packet, int lane, float range_m, float strength) {
  std::int32_t& first = first_[packet * kLanes + static_cast<std::size_t>(lane)];
  further_.push_back({.range_m = range_m, .strength = strength, .next = first});
  first = static_cast<std::int32_t>(further_.size()) - 1;
}

void SceneEchoes::weaken(std::size_t packet, const Lanes& gain) {
  surfaces[packet].strength *= gain;
  for (int lane = 0; lane < kLanes; ++lane) {
    for (std::int32_t i = first_of(packet, lane); i >= 0;) {
      FurtherEcho& echo = further_[static_cast<std::size_t>(i)];
      echo.strength *= gain(lane);
      i = echo.next;
    }
  }
}

void SceneCaster::cast(const FiringBlock& block, std::span<const std::uint32_t> near_actors,
                       SceneEchoes& echoes) const {
  echoes.reset(rays_.size());
  thread_local std::vector<PaneHit> panes;
  panes.clear();
  const BlockMotion motion({block.T_map_lidar.data(), block.cycles + 1}, block.head_turns());
  meet_standing(block, motion, echoes, panes);
  for (const std::uint32_t actor : near_actors) meet_actor(actor, block, echoes, panes);
  // A pane behind an actor that came later is not met.
  std::erase_if(panes, [&](const PaneHit& pane) {
    return pane.range_m != echoes.surfaces[pane.ray].range_m(pane.lane);
  });
  if (!panes.empty()) follow(block, motion, near_actors, panes, echoes);
}

void SceneCaster::meet_standing(const FiringBlock& block, const BlockMotion& motion,
                                SceneEchoes& echoes, std::vector<PaneHit>& panes) const {
  RTCIntersectContext context = coherent_context();
  const Lanes limit_m = Lanes::Constant(range_m_);
  const auto lanes = static_cast<int>(block.cycles);
  for (std::uint32_t r = 0; r < rays_.size(); ++r) {
    RTCRayHit16 packet;
    motion.fill(rays_[r], limit_m, packet);
    rtcIntersect16(motion.valid(), scene_.standing_scene(), &context, &packet);
    OpticsLanes optics;
    Lanes& range_m = echoes.surfaces[r].range_m;
    range_m.setConstant(std::numeric_limits<float>::infinity());
    for (int lane = 0; lane < lanes; ++lane) {
      const unsigned geometry = packet.hit.geomID[lane];
      if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
      range_m(lane) = packet.ray.tfar[lane];
      const Optics& surface = optics_[scene_.standing_material(geometry, packet.hit.primID[lane])];
      optics.set(lane, surface);
      if (surface.refractive_index > 0.0F) {
        panes.push_back({.ray = r,
                         .lane = lane,
                         .range_m = range_m(lane),
                         .normal = normal_of(packet, lane),
                         .refractive_index = surface.refractive_index});
      }
    }
    echoes.surfaces[r].strength = optics.strength(cos_incidence(packet));
  }
}

void SceneCaster::meet_actor(std::uint32_t index, const FiringBlock& block, SceneEchoes& echoes,
                             std::vector<PaneHit>& panes) const {
  const Actor& actor = scene_.actors()[index];
  // The actor's sphere along its way through the lidar frame, straight within a block.
  const RayScene::Sphere& bounds = scene_.bounds(index);
  const auto T_actor_lidar = [&](std::size_t i) {
    return actor.pose_at(block.times[i]).inverse() * block.T_map_lidar[i];
  };
  const Vector3d at_start = T_actor_lidar(0).inverse() * bounds.center;
  const Vector3d at_end = T_actor_lidar(block.cycles).inverse() * bounds.center;
  const double origin_m = rays_.front().origin_m.norm();
  const Cap cap = cap_of(0.5 * (at_start + at_end),
                         bounds.radius_m + 0.5 * (at_end - at_start).norm() + origin_m);
  if (cap.distance_m > range_m_) return;
  const HeadTurn& first = block.heads[0];
  const HeadTurn& last = block.heads[block.cycles - 1];
  const double first_rad = std::atan2(first.sin_azimuth, first.cos_azimuth);
  const double turn_rad = wrap_angle(std::atan2(last.sin_azimuth, last.cos_azimuth) - first_rad);
  if (std::abs(wrap_angle(cap.azimuth_rad - first_rad - 0.5 * turn_rad)) >
      cap.half_azimuth_rad + 0.5 * std::abs(turn_rad) + spread_.azimuth_rad) {
    return;
  }

  std::array<Pose, kLanes + 1> poses;
  for (std::size_t i = 0; i <= block.cycles; ++i) poses[i] = T_actor_lidar(i);
  const BlockMotion motion({poses.data(), block.cycles + 1}, block.head_turns());
  RTCIntersectContext context = coherent_context();
  for (std::uint32_t r = 0; r < rays_.size(); ++r) {
    const double elevation_rad = std::asin(static_cast<double>(rays_[r].direction.z()));
    if (std::abs(elevation_rad - cap.elevation_rad) >
        cap.half_elevation_rad + spread_.elevation_rad) {
      continue;
    }
    SurfaceEchoes& surface = echoes.surfaces[r];
    RTCRayHit16 packet;
    motion.fill(rays_[r], surface.range_m.min(range_m_), packet);
    rtcIntersect16(motion.valid(), scene_.actor_scene(index), &context, &packet);
    for (int lane = 0; lane < static_cast<int>(block.cycles); ++lane) {
      if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      const Optics& optics = optics_[scene_.actor_material(index, packet.hit.primID[lane])];
      const Vector3f normal = normal_of(packet, lane);
      const Vector3f direction(packet.ray.dir_x[lane], packet.ray.dir_y[lane],
                               packet.ray.dir_z[lane]);
      surface.range_m(lane) = packet.ray.tfar[lane];
      surface.strength(lane) = strength_of(optics, std::abs(normal.dot(direction)));
      if (optics.refractive_index > 0.0F) {
        const Stamp time = block.times[static_cast<std::size_t>(lane)];
        panes.push_back(
            {.ray = r,
             .lane = lane,
             .range_m = surface.range_m(lane),
             .normal = (actor.pose_at(time).rotation * normal.cast<double>()).cast<float>(),
             .refractive_index = optics.refractive_index});
      }
    }
  }
}

void SceneCaster::follow(const FiringBlock& block, const BlockMotion& motion,
                         std::span<const std::uint32_t> near_actors,
                         const std::vector<PaneHit>& panes, SceneEchoes& echoes) const {
  thread_local Light light;
  thread_local Light onward;
  light.clear();
  for (const PaneHit& pane : panes) {
    const BlockMotion::Ray ray = motion.ray(rays_[pane.ray], pane.lane);
    send_on(pane, ray.origin_m + pane.range_m * ray.direction, ray.direction, pane.range_m, 1.0F, 0,
            light, echoes.surfaces[pane.ray].strength(pane.lane));
  }
  const std::vector<ActorPlace> actors = places_of(block, near_actors);
  while (!light.through.empty() || !light.mirrored.empty()) {
    onward.clear();
    follow_all(block, actors, light.through, onward, echoes);
    follow_all(block, actors, light.mirrored, onward, echoes);
    std::swap(light, onward);
  }
}

void SceneCaster::follow_all(const FiringBlock& block, std::span<const ActorPlace> actors,
                             std::span<const Segment> segments, Light& onward,
                             SceneEchoes& echoes) const {
  std::array<Met, kLanes> met;
  for (std::size_t i = 0; i < segments.size(); i += kLanes) {
    const auto group = segments.subspan(i, std::min<std::size_t>(kLanes, segments.size() - i));
    meet(block, actors, group, met);
    for (std::size_t k = 0; k < group.size(); ++k) {
      if (std::isinf(met[k].range_m)) continue;
      const Segment& segment = group[k];
      const float path_m = segment.path_m + met[k].range_m;
      float strength = strength_of(met[k].optics, met[k].cos_incidence);
      if (met[k].optics.refractive_index > 0.0F && segment.panes_passed < kMostPanes) {
        send_on({.ray = segment.ray,
                 .lane = segment.lane,
                 .range_m = met[k].range_m,
                 .normal = met[k].normal,
                 .refractive_index = met[k].optics.refractive_index},
                segment.origin + met[k].range_m * segment.direction, segment.direction, path_m,
                segment.gain, segment.panes_passed, onward, strength);
      }
      echoes.add_further(segment.ray, segment.lane, path_m, segment.gain * strength);
    }
  }
}

void SceneCaster::send_on(const PaneHit& pane, const Vector3f& point, const Vector3f& direction,
                          float path_m, float gain, int panes_passed, Light& light,
                          float& own_strength) const {
  const float along = pane.normal.dot(direction);
  const PaneOptics optics = pane_optics(pane.refractive_index, std::abs(along));
  own_strength += optics.glint;
  const auto send = [&](std::vector<Segment>& segments, const Vector3f& onward, float share,
                        int passed) {
    // There and back: the share counts twice.
    const float left = gain * share * share;
    const float reach_m =
        least_power_ > 0.0F ? std::min(range_m_, std::sqrt(left / least_power_)) : range_m_;
    if (reach_m <= path_m + kBehindPane_m) return;
    segments.push_back({.ray = pane.ray,
                        .lane = pane.lane,
                        .origin = point,
                        .direction = onward,
                        .path_m = path_m,
                        .gain = left,
                        .reach_m = reach_m,
                        .panes_passed = passed});
  };
  send(light.through, direction, optics.transmitted, panes_passed + 1);
  // The mirror of a mirror is too faint to matter.
  if (panes_passed > 0) return;
  send(light.mirrored, (direction - 2.0F * along * pane.normal).normalized(), optics.mirrored,
       kMostPanes);
}

std::vector<SceneCaster::ActorPlace> SceneCaster::places_of(
    const FiringBlock& block, std::span<const std::uint32_t> near_actors) const {
  std::vector<ActorPlace> places;
  places.reserve(near_actors.size());
  for (const std::uint32_t index : near_actors) {
    const Actor& actor = scene_.actors()[index];
    const RayScene::Sphere& bounds = scene_.bounds(index);
    const Vector3d first = actor.pose_at(block.times[0]) * bounds.center;
    const Vector3d last = actor.pose_at(block.times[block.cycles]) * bounds.center;
    const double radius_m = bounds.radius_m + (last - first).norm();
    places.push_back({index, first.cast<float>(), static_cast<float>(radius_m)});
  }
  return places;
}

void SceneCaster::meet(const FiringBlock& block, std::span<const ActorPlace> actors,
                       std::span<const Segment> segments, std::span<Met> met) const {
  alignas(64) std::array<int, kLanes> valid{};
  RTCRayHit16 packet;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    valid[k] = -1;
    set_ray(packet, static_cast<int>(k), segments[k].origin, segments[k].direction, kBehindPane_m,
            segments[k].reach_m - segments[k].path_m);
  }
  RTCIntersectContext context = coherent_context();
  rtcIntersect16(valid.data(), scene_.standing_scene(), &context, &packet);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const auto lane = static_cast<int>(k);
    met[k].range_m = std::numeric_limits<float>::infinity();
    if (packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID) {
      met[k].range_m = packet.ray.tfar[lane];
      met[k].normal = normal_of(packet, lane);
      met[k].cos_incidence = std::abs(met[k].normal.dot(segments[k].direction));
      met[k].optics =
          optics_[scene_.standing_material(packet.hit.geomID[lane], packet.hit.primID[lane])];
    }
    meet_actors(block, actors, segments[k], met[k]);
  }
}

void SceneCaster::meet_actors(const FiringBlock& block, std::span<const ActorPlace> actors,
                              const Segment& segment, Met& met) const {
  const Stamp time = block.times[static_cast<std::size_t>(segment.lane)];
  for (const ActorPlace& place : actors) {
    const float limit_m = std::min(met.range_m, segment.reach_m - segment.path_m);
    const Vector3f to_center = place.center - segment.origin;
    const float along_m = std::clamp(to_center.dot(segment.direction), 0.0F, limit_m);
    if ((to_center - along_m * segment.direction).norm() > place.radius_m) continue;
    const std::optional<RayScene::ActorHit> hit =
        scene_.cast_at_actor(place.actor, segment.origin.cast<double>(),
                             segment.direction.cast<double>(), time, kBehindPane_m, limit_m);
    if (!hit) continue;
    met.range_m = hit->range_m;
    met.normal = hit->normal;
    met.cos_incidence = std::abs(hit->normal.dot(segment.direction));
    met.optics = optics_[hit->material];
  }
}

}  // namespace locsim::sim
