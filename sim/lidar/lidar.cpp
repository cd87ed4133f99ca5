#include "sim/lidar/lidar.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "sim/lidar/lidar_scratch.h"

namespace locsim::sim {

namespace {

constexpr double kNoiseReach_sigma = 7.0;  // beyond what 32 random bits can draw
constexpr double kSlack_m = 1.0;           // the way of a car within one block, generously

std::size_t blocks_of(std::size_t cycles) {
  return (cycles + kLanes - 1) / kLanes;
}

std::int64_t whole_second(Stamp time) {
  return std::chrono::floor<std::chrono::seconds>(time.time_since_epoch()).count();
}

template <typename Kind>
std::vector<Faults::Timed<Kind>> of_sensor(const Faults& faults, std::size_t sensor) {
  std::vector<Faults::Timed<Kind>> all = faults.all<Kind>();
  std::erase_if(all, [&](const auto& timed) { return !timed.fault.includes(sensor); });
  return all;
}

}  // namespace

Lidar::Lidar(LidarSpec spec, const Pose& T_vehicle_lidar, std::uint16_t sensor, std::uint64_t seed,
             Weather weather, const Faults& faults)
    : spec_((check_parameters(spec, "lidar"), std::move(spec))),
      T_vehicle_lidar_(T_vehicle_lidar),
      sensor_(sensor),
      weather_(std::move(weather)),
      blackouts_(of_sensor<LidarBlackout>(faults, sensor)),
      dirts_(of_sensor<LidarDirt>(faults, sensor)),
      knocks_(of_sensor<LidarKnock>(faults, sensor)),
      receiver_(spec_),
      range_noise_(seed, "lidar/" + std::to_string(sensor) + "/range"),
      air_noise_(seed, "lidar/" + std::to_string(sensor) + "/air"),
      rays_(beam_rays(spec_)),
      sub_rays_(static_cast<std::size_t>(spec_.sub_rays)),
      rings_(spec_.rings()),
      biases_m_(spec_.beams.size()),
      cast_range_m_(static_cast<float>(
          spec_.range_max_m + 5.0 * spec_.beam_bias_m +
          kNoiseReach_sigma * std::hypot(spec_.range_noise_m, spec_.weak_range_noise_m))) {
  if (spec_.repeats()) heads_ = head_turns(spec_);
  const RandomStream unit(seed, "lidar/" + std::to_string(sensor) + "/bias");
  for (std::size_t b = 0; b < biases_m_.size(); ++b) {
    if (spec_.effects.beam_bias) {
      biases_m_[b] = static_cast<float>(spec_.beam_bias_m * unit.gaussian(b));
    }
    spread_.azimuth_rad =
        std::max(spread_.azimuth_rad, std::abs(spec_.beams[b].azimuth_offset_rad));
  }
  const double cone_rad = std::max(spec_.divergence_rad[0], spec_.divergence_rad[1]);
  // A lifted mirror turns azimuths, too, the more the steeper.
  spread_.azimuth_rad += cone_rad + std::abs(spec_.turn_rate_rad_s()) * to_seconds(spec_.cycle) +
                         (spec_.nod_amplitude_rad > 0.0 ? std::numbers::pi : 0.0);
  spread_.elevation_rad = cone_rad + spec_.nod_amplitude_rad;
}

LidarScan Lidar::start_scan(Stamp start) const {
  LidarScan scan{.start = start, .end = start + spec_.period(), .points = {}};
  scan.points.reserve(rays_per_scan());
  return scan;
}

Stamp Lidar::block_end(const LidarScan& scan, std::size_t block) const {
  return scan.start +
         spec_.cycle * static_cast<std::int64_t>(std::min((block + 1) * kLanes, spec_.cycles()));
}

Pose Lidar::T_vehicle_lidar_at(Stamp time) const {
  Pose pose = T_vehicle_lidar_;
  for (const auto& [interval, knock] : knocks_) {
    if (interval.contains(time)) pose = pose * knock.offset();
  }
  return pose;
}

FiringBlock Lidar::firing_block(const Trajectory& trajectory, Stamp scan_start,
                                std::size_t index) const {
  FiringBlock block;
  block.first_cycle = index * kLanes;
  block.cycles = std::min<std::size_t>(kLanes, spec_.cycles() - block.first_cycle);
  // A knock comes between blocks.
  const Pose T_vehicle_lidar =
      T_vehicle_lidar_at(scan_start + spec_.cycle * static_cast<std::int64_t>(block.first_cycle));
  for (std::size_t i = 0; i <= block.cycles; ++i) {
    block.times[i] = scan_start + spec_.cycle * static_cast<std::int64_t>(block.first_cycle + i);
    block.T_map_lidar[i] = trajectory.pose_at(block.times[i]) * T_vehicle_lidar;
    if (i > 0) block.is_torn[i - 1] = trajectory.jumps_within(block.times[i - 1], block.times[i]);
    if (i == block.cycles) break;
    block.heads[i] =
        heads_.empty() ? head_turn_at(spec_, block.times[i]) : heads_[block.first_cycle + i];
  }
  return block;
}

void Lidar::prepare_air(Stamp from, Stamp to) {
  if (!spec_.effects.weather || weather_.is_clear()) return;
  const std::int64_t first = whole_second(from);
  std::erase_if(air_, [&](const Air& air) { return air.second < first; });
  for (std::int64_t second = first; second <= whole_second(to); ++second) {
    if (air_at(Stamp{std::chrono::seconds{second}}) != nullptr) continue;
    const Atmosphere now = weather_.at(Stamp{std::chrono::seconds{second}});
    air_.push_back({second, std::make_shared<const AirEchoes>(now, spec_)});
  }
}

const AirEchoes* Lidar::air_at(Stamp time) const {
  const std::int64_t second = whole_second(time);
  for (const Air& air : air_) {
    if (air.second == second) return air.echoes.get();
  }
  return nullptr;
}

void Lidar::cast(const RayScene& scene, const Trajectory& trajectory, Stamp from, Stamp to,
                 LidarScan& scan) {
  std::size_t first = 0;
  const std::size_t blocks = blocks_of(spec_.cycles());
  while (first < blocks && block_end(scan, first) <= from) ++first;
  std::size_t last = first;
  while (last < blocks && block_end(scan, last) <= to) ++last;
  if (first == last) return;

  const Stamp begin = first == 0 ? scan.start : block_end(scan, first - 1);
  const Stamp end = block_end(scan, last - 1);
  const Vector3d center = trajectory.pose_at(begin).translation;
  double way_m = 0.0;
  for (std::size_t block = first; block < last; ++block) {
    const Vector3d place = trajectory.pose_at(block_end(scan, block)).translation;
    way_m = std::max(way_m, (place - center).norm());
  }
  double arm_m = T_vehicle_lidar_.translation.norm();
  for (const auto& [interval, knock] : knocks_) arm_m += knock.shift_m.norm();
  const double reach_m = cast_range_m_ + way_m + arm_m + kSlack_m;
  const std::vector<std::uint32_t> near = scene.actors_near(center, reach_m, begin, end);
  prepare_air(begin, end);

  const std::vector<Optics> optics = optics_of(scene.materials(), spec_.effects);
  const SceneCaster caster(scene, rays_, optics, spread_, cast_range_m_, receiver_.limit());
  const std::size_t room = kLanes * spec_.beams.size() * (receiver_.is_dual() ? 2 : 1);
  slots_.resize((last - first) * room);
  std::vector<std::size_t> counts(last - first);
  tbb::parallel_for(first, last, [&](std::size_t index) {
    counts[index - first] = cast_block(caster, firing_block(trajectory, scan.start, index), near,
                                       scan.start, slots_.data() + (index - first) * room);
  });
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const LidarPoint* const points = slots_.data() + i * room;
    scan.points.insert(scan.points.end(), points, points + counts[i]);
  }
}

std::size_t Lidar::cast_block(const SceneCaster& caster, const FiringBlock& block,
                              std::span<const std::uint32_t> near_actors, Stamp scan_start,
                              LidarPoint* points) const {
  // A block is cast by one thread from first to last; its memory serves the thread's next one.
  thread_local Scratch scratch;
  scratch.window_gains.clear();
  caster.cast(block, near_actors, scratch.scene);
  const std::size_t lists = receiver_.is_dual() ? 2 : 1;
  for (std::size_t which = 0; which < lists; ++which) {
    scratch.returns[which].resize(spec_.beams.size());
  }
  receive(block, air_at(block.times[0]), scratch);
  for (std::size_t which = 0; which < lists; ++which) measure(block, which, scratch);
  return report(block, scan_start, scratch, points);
}

std::size_t Lidar::report(const FiringBlock& block, Stamp scan_start, const Scratch& scratch,
                          LidarPoint* points) const {
  const std::size_t lists = receiver_.is_dual() ? 2 : 1;
  LidarPoint* next = points;
  for (std::size_t i = 0; i < block.cycles; ++i) {
    if (block.is_torn[i]) continue;
    if (std::ranges::any_of(blackouts_, [&](const Faults::Timed<LidarBlackout>& blackout) {
          return blackout.interval.contains(block.times[i]);
        })) {
      continue;
    }
    const auto lane = static_cast<Eigen::Index>(i);
    const Duration since_start = block.times[i] - scan_start;
    for (std::size_t b = 0; b < spec_.beams.size(); ++b) {
      for (std::size_t which = 0; which < lists; ++which) {
        const Returns& returns = scratch.returns[which][b];
        const float range_m = returns.range_m(lane);
        if (range_m == 0.0F) continue;
        const BeamRay& ray = rays_[b * sub_rays_];
        const Vector3f p = block.heads[i] * Vector3f(range_m * ray.direction + ray.origin_m);
        *next++ = {.x_m = p.x(),
                   .y_m = p.y(),
                   .z_m = p.z(),
                   .intensity = std::min(returns.power(lane) * range_m * range_m, 1.0F),
                   .time_ns = static_cast<std::uint32_t>(
                       (since_start + spec_.beams[b].firing_time).count()),
                   .ring = rings_[b],
                   .sensor = sensor_};
      }
    }
  }
  return static_cast<std::size_t>(next - points);
}

}  // namespace locsim::sim
