#include "sim/lidar/lidar.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace locsim::sim {

namespace {

constexpr double kNoiseReach_sigma = 7.0;  // beyond what 32 random bits can draw
constexpr double kSlack_m = 1.0;           // the way of a car within one block, generously
constexpr std::size_t kDraws = 4;          // random numbers by one call
constexpr std::uint64_t kSecondReturn = 1ULL << 32;
constexpr std::uint64_t kOwnDraws = 1ULL << 32;

std::size_t blocks_of(std::size_t cycles) {
  return (cycles + kLanes - 1) / kLanes;
}

std::uint64_t draw_index(Stamp time) {
  return static_cast<std::uint64_t>(time.time_since_epoch().count());
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

// The echo of a beam whose power all comes back within one pulse, and how far apart it does.
struct BeamEcho {
  Lanes range_m;
  Lanes power;
  /// Infinite where some of it met nothing.
  Lanes nearest_m;
  Lanes farthest_m;
};

Lanes powers_of(const SurfaceEchoes& surface, float extinction_1_m) {
  Lanes power = surface.strength / (surface.range_m * surface.range_m);
  if (extinction_1_m > 0.0F) power *= (-2.0F * extinction_1_m * surface.range_m).exp();
  return power;
}

BeamEcho beam_echo(std::span<const SurfaceEchoes> surfaces, float extinction_1_m) {
  const Lanes& middle_m = surfaces.front().range_m;
  BeamEcho echo{middle_m, powers_of(surfaces.front(), extinction_1_m), middle_m, middle_m};
  if (surfaces.size() == 1) return echo;
  Lanes moment = Lanes::Zero();
  echo.power.setZero();
  for (const SurfaceEchoes& surface : surfaces) {
    // What met nothing has no strength to speak of.
    const Lanes power =
        (surface.range_m < std::numeric_limits<float>::infinity())
            .select(powers_of(surface, extinction_1_m) / static_cast<float>(surfaces.size()), 0.0F);
    echo.power += power;
    moment += (power > 0.0F).select(power * surface.range_m, 0.0F);
    echo.nearest_m = echo.nearest_m.min(surface.range_m);
    echo.farthest_m = echo.farthest_m.max(surface.range_m);
  }
  echo.range_m = moment / echo.power;
  return echo;
}

}  // namespace

// What the threads that cast blocks write, one each.
struct Lidar::Scratch {
  SceneEchoes scene;
  /// A packet a beam, the chosen return and, in dual mode, the second.
  std::array<std::vector<Returns>, 2> returns;
  std::vector<Echo> echoes;
  /// What the window lets through there and back, a packet a beam; none where it is clean.
  std::vector<Lanes> window_gains;
  /// Whether rays meet drops, for four beams.
  std::array<std::array<std::uint32_t, kLanes>, kDraws> drop_bits;
};

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

// Share of the light that passes the window there and back.
Lanes Lidar::window_gain(const FiringBlock& block, std::size_t beam) const {
  Lanes gain = Lanes::Ones();
  for (const auto& [interval, dirt] : dirts_) {
    for (std::size_t i = 0; i < block.cycles; ++i) {
      if (!interval.contains(block.times[i])) continue;
      const Vector3f direction = block.heads[i] * rays_[beam * sub_rays_].direction;
      if (dirt.covers(std::atan2(direction.y(), direction.x()))) {
        gain(static_cast<Eigen::Index>(i)) *=
            static_cast<float>(dirt.transmission * dirt.transmission);
      }
    }
  }
  return gain;
}

void Lidar::receive(const FiringBlock& block, const AirEchoes* air, Scratch& scratch) const {
  const auto is_on = [&](const Faults::Timed<LidarDirt>& dirt) {
    return dirt.interval.begin < block.times[block.cycles] && dirt.interval.end > block.times[0];
  };
  if (std::ranges::any_of(dirts_, is_on)) {
    for (std::size_t beam = 0; beam < spec_.beams.size(); ++beam) {
      scratch.window_gains.push_back(window_gain(block, beam));
      for (std::size_t s = 0; s < sub_rays_; ++s) {
        scratch.scene.weaken(beam * sub_rays_ + s, scratch.window_gains.back());
      }
    }
  }
  for (std::size_t beam = 0; beam < spec_.beams.size(); ++beam) {
    receive_beam(block, beam, air, scratch);
  }
}

void Lidar::receive_beam(const FiringBlock& block, std::size_t beam, const AirEchoes* air,
                         Scratch& scratch) const {
  const std::span<const SurfaceEchoes> surfaces(&scratch.scene.surfaces[beam * sub_rays_],
                                                sub_rays_);
  const float extinction_1_m = air == nullptr ? 0.0F : air->extinction_1_m();
  const BeamEcho whole = beam_echo(surfaces, extinction_1_m);
  Returns& main = scratch.returns[0][beam];
  main.power = whole.power;
  main.range_m =
      (whole.power > 0.0F && whole.power >= receiver_.limit()).select(whole.range_m, 0.0F);
  if (receiver_.is_dual()) scratch.returns[1][beam].range_m.setZero();

  // All others get the whole list of their echoes.
  if (air == nullptr && !scratch.scene.has_further() && sub_rays_ == 1) return;
  if (air != nullptr && beam % kDraws == 0) draw_drops(block, beam, scratch);
  for (int lane = 0; lane < static_cast<int>(block.cycles); ++lane) {
    const bool has_further = [&] {
      for (std::size_t s = 0; s < sub_rays_; ++s) {
        if (scratch.scene.has_further(beam * sub_rays_ + s, lane)) return true;
      }
      return false;
    }();
    const bool is_split = sub_rays_ > 1 && whole.farthest_m(lane) - whole.nearest_m(lane) >
                                               receiver_.pulse_length_m();
    Echo of_air;
    if (air != nullptr) {
      const std::uint32_t bits = scratch.drop_bits[beam % kDraws][static_cast<std::size_t>(lane)];
      if (air->may_answer(bits)) {
        of_air = air_echo(*air, block.times[static_cast<std::size_t>(lane)], beam, bits,
                          whole.nearest_m(lane));
        if (!scratch.window_gains.empty()) of_air.power *= scratch.window_gains[beam](lane);
      }
    }
    if (!has_further && !is_split && of_air.power == 0.0F) continue;

    scratch.echoes.assign(1, of_air);
    const auto add = [&](float range_m, float strength) {
      if (std::isinf(range_m)) return;
      const float share = strength / static_cast<float>(sub_rays_);
      scratch.echoes.push_back({range_m, received_power(share, range_m, extinction_1_m)});
    };
    for (std::size_t s = 0; s < sub_rays_; ++s) {
      add(surfaces[s].range_m(lane), surfaces[s].strength(lane));
      scratch.scene.for_further(beam * sub_rays_ + s, lane, add);
    }
    const ReportedEchoes reported = receiver_.report(scratch.echoes);
    main.range_m(lane) = reported[0].range_m;
    main.power(lane) = reported[0].power;
    if (receiver_.is_dual()) {
      scratch.returns[1][beam].range_m(lane) = reported[1].range_m;
      scratch.returns[1][beam].power(lane) = reported[1].power;
    }
  }
}

// Few rays meet a drop: whether one does is drawn for four beams at once.
void Lidar::draw_drops(const FiringBlock& block, std::size_t beam, Scratch& scratch) const {
  for (std::size_t i = 0; i < block.cycles; ++i) {
    const auto bits = air_noise_.bits(draw_index(block.times[i]), beam / kDraws);
    for (std::size_t k = 0; k < kDraws; ++k) scratch.drop_bits[k][i] = bits[k];
  }
}

Echo Lidar::air_echo(const AirEchoes& air, Stamp fired, std::size_t beam, std::uint32_t drop_bits,
                     float target_range_m) const {
  std::array<std::uint32_t, 4> bits = air_noise_.bits(draw_index(fired), kOwnDraws + beam);
  bits[1] = drop_bits;
  const AirEchoes::Echo echo = air.strongest(target_range_m, bits);
  // The receiver's gate opens at the least range.
  if (echo.range_m < static_cast<float>(spec_.range_min_m)) return {};
  return {.range_m = echo.range_m, .power = echo.power};
}

// Turns ranges into what the sensor says of them.
void Lidar::measure(const FiringBlock& block, std::size_t which, Scratch& scratch) const {
  std::vector<Returns>& returns = scratch.returns[which];
  const bool is_noisy =
      spec_.effects.noise && (spec_.range_noise_m > 0.0 || spec_.weak_range_noise_m > 0.0);
  const auto variance_m2 = static_cast<float>(spec_.range_noise_m * spec_.range_noise_m);
  const auto weak_m2 = static_cast<float>(spec_.weak_range_noise_m * spec_.weak_range_noise_m) *
                       detection_limit(spec_);
  const auto step_m = static_cast<float>(spec_.effects.quantisation ? spec_.range_step_m : 0.0);
  std::array<Lanes, kDraws> normals;
  normals.fill(Lanes::Zero());
  for (std::size_t b = 0; b < returns.size(); ++b) {
    const auto is_seen = returns[b].range_m > 0.0F;
    Lanes range_m = returns[b].range_m;
    if (is_noisy) {
      if (b % kDraws == 0) {
        for (std::size_t i = 0; i < block.cycles; ++i) {
          // A firing cycle's own time and the laser's number name each ray of a whole run.
          const auto bits = range_noise_.bits(draw_index(block.times[i]),
                                              b / kDraws + (which == 0 ? 0 : kSecondReturn));
          for (std::size_t k = 0; k < kDraws; ++k) {
            normals[k](static_cast<Eigen::Index>(i)) = gaussian_from_bits(bits[k]);
          }
        }
      }
      const Lanes power = is_seen.select(returns[b].power, 1.0F);
      range_m += (variance_m2 + weak_m2 / power).sqrt() * normals[b % kDraws];
    }
    range_m += biases_m_[b];
    // Ranges are positive: cutting off after adding a half rounds them. None lies far enough out
    // to be beyond an int.
    range_m = range_m.max(0.0F).min(2.0F * cast_range_m_);
    if (step_m > 0.0F) range_m = step_m * (range_m / step_m + 0.5F).cast<int>().cast<float>();
    returns[b].range_m = (is_seen && range_m >= static_cast<float>(spec_.range_min_m) &&
                          range_m <= static_cast<float>(spec_.range_max_m))
                             .select(range_m, 0.0F)
                             .eval();
  }
}

std::size_t Lidar::report(const FiringBlock& block, Stamp scan_start, const Scratch& scratch,
                          LidarPoint* points) const {
  const std::size_t lists = receiver_.is_dual() ? 2 : 1;
  LidarPoint* next = points;
  for (std::size_t i = 0; i < block.cycles; ++i) {
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
