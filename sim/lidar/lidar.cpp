#include "sim/lidar/lidar.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

namespace locsim::sim {

namespace {

constexpr double kNoiseReach_sigma = 7.0;  // beyond what 32 random bits can draw
constexpr double kSlack_m = 1.0;           // the way of a car within one block, generously
constexpr double kSlack_rad = 1e-3;

std::size_t blocks_of(std::size_t cycles) {
  return (cycles + kLanes - 1) / kLanes;
}

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

}  // namespace

// What the rays of one block have in common.
struct Lidar::Block {
  std::size_t first_cycle;
  std::size_t cycles;
  std::array<Stamp, kLanes + 1> times;
  std::array<Pose, kLanes + 1> T_map_lidar;

  [[nodiscard]] std::span<const Pose> poses() const { return {T_map_lidar.data(), cycles + 1}; }
};

Lidar::Lidar(LidarSpec spec, const Pose& T_vehicle_lidar, std::uint16_t sensor, std::uint64_t seed)
    : spec_((check_parameters(spec, "lidar"), std::move(spec))),
      T_vehicle_lidar_(T_vehicle_lidar),
      sensor_(sensor),
      range_noise_(seed, "lidar/" + std::to_string(sensor) + "/range"),
      beams_(beam_directions(spec_)),
      heads_(head_angles(spec_)),
      rings_(spec_.rings()),
      cast_range_m_(
          static_cast<float>(spec_.range_max_m + kNoiseReach_sigma * spec_.range_noise_m)) {
  for (const LidarBeam& beam : spec_.beams) {
    azimuth_spread_rad_ = std::max(azimuth_spread_rad_, std::abs(beam.azimuth_offset_rad));
  }
}

LidarScan Lidar::start_scan(Stamp start) const {
  LidarScan scan{.start = start, .end = start + spec_.period(), .points = {}};
  scan.points.reserve(rays_per_scan());
  return scan;
}

Stamp Lidar::block_end(const LidarScan& scan, std::size_t block) const {
  return scan.start +
         spec_.cycle * static_cast<std::int64_t>(std::min((block + 1) * kLanes, heads_.size()));
}

void Lidar::cast(const RayScene& scene, const Trajectory& trajectory, Stamp from, Stamp to,
                 LidarScan& scan) {
  std::size_t first = 0;
  const std::size_t blocks = blocks_of(heads_.size());
  while (first < blocks && block_end(scan, first) <= from) ++first;
  std::size_t last = first;
  while (last < blocks && block_end(scan, last) <= to) ++last;
  if (first == last) return;

  const Stamp begin = first == 0 ? scan.start : block_end(scan, first - 1);
  const Vector3d center = trajectory.pose_at(begin).translation;
  double way_m = 0.0;
  for (std::size_t block = first; block < last; ++block) {
    const Vector3d place = trajectory.pose_at(block_end(scan, block)).translation;
    way_m = std::max(way_m, (place - center).norm());
  }
  const double reach_m = cast_range_m_ + way_m + T_vehicle_lidar_.translation.norm() + kSlack_m;
  const std::vector<std::uint32_t> near =
      scene.actors_near(center, reach_m, begin, block_end(scan, last - 1));

  const std::size_t room = kLanes * beams_.size();
  slots_.resize((last - first) * room);
  std::vector<std::size_t> counts(last - first);
  tbb::parallel_for(first, last, [&](std::size_t block) {
    counts[block - first] = cast_block(scene, trajectory, near, scan.start, block,
                                       slots_.data() + (block - first) * room);
  });
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const LidarPoint* const points = slots_.data() + i * room;
    scan.points.insert(scan.points.end(), points, points + counts[i]);
  }
}

std::size_t Lidar::cast_block(const RayScene& scene, const Trajectory& trajectory,
                              std::span<const std::uint32_t> near_actors, Stamp scan_start,
                              std::size_t index, LidarPoint* points) const {
  Block block;
  block.first_cycle = index * kLanes;
  block.cycles = std::min<std::size_t>(kLanes, heads_.size() - block.first_cycle);
  for (std::size_t i = 0; i <= block.cycles; ++i) {
    block.times[i] = scan_start + spec_.cycle * static_cast<std::int64_t>(block.first_cycle + i);
    block.T_map_lidar[i] = trajectory.pose_at(block.times[i]) * T_vehicle_lidar_;
  }
  std::vector<Echoes> echoes(beams_.size());
  meet_standing(scene, block, echoes);
  for (const std::uint32_t actor : near_actors) meet_actor(scene, actor, block, echoes);
  return report(block, scan_start, echoes, points);
}

void Lidar::meet_standing(const RayScene& scene, const Block& block,
                          std::vector<Echoes>& echoes) const {
  const BlockMotion motion(block.poses(), {heads_.data() + block.first_cycle, block.cycles});
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  const Lanes limit_m = Lanes::Constant(cast_range_m_);
  for (std::size_t b = 0; b < beams_.size(); ++b) {
    RTCRayHit16 packet;
    motion.fill(beams_[b], limit_m, packet);
    rtcIntersect16(motion.valid(), scene.standing_scene(), &context, &packet);
    echoes[b].cos_incidence = cos_incidence(packet);
    for (int lane = 0; lane < kLanes; ++lane) {
      const unsigned geometry = packet.hit.geomID[lane];
      const bool is_met = geometry != RTC_INVALID_GEOMETRY_ID;
      echoes[b].range_m(lane) =
          is_met ? packet.ray.tfar[lane] : std::numeric_limits<float>::infinity();
      echoes[b].reflectivity(lane) =
          is_met ? scene.standing_reflectivity(geometry, packet.hit.primID[lane]) : 0.0F;
    }
  }
}

void Lidar::meet_actor(const RayScene& scene, std::uint32_t index, const Block& block,
                       std::vector<Echoes>& echoes) const {
  const Actor& actor = scene.actors()[index];
  const auto T_actor_lidar = [&](std::size_t i) {
    return actor.pose_at(block.times[i]).inverse() * block.T_map_lidar[i];
  };
  // The actor's sphere along its way through the lidar frame, straight within a block.
  const RayScene::Sphere& bounds = scene.bounds(index);
  const Vector3d at_start = T_actor_lidar(0).inverse() * bounds.center;
  const Vector3d at_end = T_actor_lidar(block.cycles).inverse() * bounds.center;
  const Cap cap =
      cap_of(0.5 * (at_start + at_end), bounds.radius_m + 0.5 * (at_end - at_start).norm());
  if (cap.distance_m > cast_range_m_) return;
  const double turn_rad = 2.0 * std::numbers::pi * spec_.rate_hz * to_seconds(spec_.cycle);
  const double half_turn_rad = 0.5 * turn_rad * static_cast<double>(block.cycles);
  const HeadAngle& head = heads_[block.first_cycle];
  const double middle_rad =
      std::atan2(head.sin, head.cos) + (spec_.clockwise ? -half_turn_rad : half_turn_rad);
  if (std::abs(wrap_angle(cap.azimuth_rad - middle_rad)) >
      cap.half_azimuth_rad + half_turn_rad + azimuth_spread_rad_) {
    return;
  }

  std::array<Pose, kLanes + 1> poses;
  for (std::size_t i = 0; i <= block.cycles; ++i) poses[i] = T_actor_lidar(i);
  const BlockMotion motion({poses.data(), block.cycles + 1},
                           {heads_.data() + block.first_cycle, block.cycles});
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t b = 0; b < beams_.size(); ++b) {
    if (std::abs(spec_.beams[b].elevation_rad - cap.elevation_rad) > cap.half_elevation_rad) {
      continue;
    }
    RTCRayHit16 packet;
    motion.fill(beams_[b], echoes[b].range_m.min(cast_range_m_), packet);
    rtcIntersect16(motion.valid(), scene.actor_scene(index), &context, &packet);
    const Lanes cosines = cos_incidence(packet);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      echoes[b].range_m(lane) = packet.ray.tfar[lane];
      echoes[b].cos_incidence(lane) = cosines(lane);
      echoes[b].reflectivity(lane) = scene.actor_reflectivity(index, packet.hit.primID[lane]);
    }
  }
}

std::size_t Lidar::report(const Block& block, Stamp scan_start, const std::vector<Echoes>& echoes,
                          LidarPoint* points) const {
  constexpr std::size_t kDraws = 4;
  const auto range_min_m = static_cast<float>(spec_.range_min_m);
  const auto range_max_m = static_cast<float>(spec_.range_max_m);
  std::vector<Returns> returns(beams_.size());
  std::ranges::transform(echoes, returns.begin(),
                         [&](const Echoes& e) { return detect(e, range_max_m); });
  LidarPoint* next = points;
  for (std::size_t i = 0; i < block.cycles; ++i) {
    const auto lane = static_cast<Eigen::Index>(i);
    const HeadAngle head = heads_[block.first_cycle + i];
    const Duration since_start = block.times[i] - scan_start;
    // A firing cycle's own time and the laser's number name each ray of a whole run.
    const auto cycle_ns = static_cast<std::uint64_t>(block.times[i].time_since_epoch().count());
    std::array<std::uint32_t, kDraws> bits{};
    for (std::size_t b = 0; b < beams_.size(); ++b) {
      if (b % kDraws == 0 && spec_.range_noise_m > 0.0) {
        bits = range_noise_.bits(cycle_ns, b / kDraws);
      }
      float range_m = returns[b].range_m(lane);
      if (range_m == 0.0F) continue;
      if (spec_.range_noise_m > 0.0) {
        range_m += static_cast<float>(spec_.range_noise_m *
                                      inverse_normal_cdf(uniform_from_bits(bits[b % kDraws])));
      }
      if (range_m < range_min_m || range_m > range_max_m) continue;
      const Vector3f& u = beams_[b].direction;
      *next++ = {
          .x_m = range_m * (head.cos * u.x() - head.sin * u.y()),
          .y_m = range_m * (head.sin * u.x() + head.cos * u.y()),
          .z_m = range_m * u.z(),
          .intensity = returns[b].intensity(lane),
          .time_ns = static_cast<std::uint32_t>((since_start + spec_.beams[b].firing_time).count()),
          .ring = rings_[b],
          .sensor = sensor_};
    }
  }
  return static_cast<std::size_t>(next - points);
}

}  // namespace locsim::sim
