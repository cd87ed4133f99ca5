// What the receiver makes of the echoes that a block of rays met.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "sim/lidar/lidar.h"
#include "sim/lidar/lidar_scratch.h"

namespace locsim::sim {

namespace {

constexpr std::uint64_t kSecondReturn = 1ULL << 32;
constexpr std::uint64_t kOwnDraws = 1ULL << 32;

std::uint64_t draw_index(Stamp time) {
  return static_cast<std::uint64_t>(time.time_since_epoch().count());
}

// The echo of a beam whose power all comes back within one pulse, and how far apart it does.
struct BeamEcho {
  Lanes range_m;
  Lanes power;
  /// Infinite where some of it met nothing.
  Lanes nearest_m;
  Lanes farthest_m;
};

BeamEcho beam_echo(std::span<const SurfaceEchoes> surfaces, float extinction_1_m) {
  const auto power_of = [&](const SurfaceEchoes& surface) {
    return received_power(surface.strength, surface.range_m, extinction_1_m);
  };
  const Lanes& middle_m = surfaces.front().range_m;
  BeamEcho echo{middle_m, power_of(surfaces.front()), middle_m, middle_m};
  if (surfaces.size() == 1) return echo;
  Lanes moment = Lanes::Zero();
  echo.power.setZero();
  for (const SurfaceEchoes& surface : surfaces) {
    // What met nothing has no strength to speak of.
    const Lanes power = (surface.range_m < std::numeric_limits<float>::infinity())
                            .select(power_of(surface) / static_cast<float>(surfaces.size()), 0.0F);
    echo.power += power;
    moment += (power > 0.0F).select(power * surface.range_m, 0.0F);
    echo.nearest_m = echo.nearest_m.min(surface.range_m);
    echo.farthest_m = echo.farthest_m.max(surface.range_m);
  }
  echo.range_m = moment / echo.power;
  return echo;
}

}  // namespace

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
  if (air != nullptr && beam % Scratch::kDraws == 0) draw_drops(block, beam, scratch);
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
      const std::uint32_t bits =
          scratch.drop_bits[beam % Scratch::kDraws][static_cast<std::size_t>(lane)];
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
    const auto bits = air_noise_.bits(draw_index(block.times[i]), beam / Scratch::kDraws);
    for (std::size_t k = 0; k < Scratch::kDraws; ++k) scratch.drop_bits[k][i] = bits[k];
  }
}

Echo Lidar::air_echo(const AirEchoes& air, Stamp fired, std::size_t beam, std::uint32_t drop_bits,
                     float target_range_m) const {
  std::array<std::uint32_t, 4> bits = air_noise_.bits(draw_index(fired), kOwnDraws + beam);
  bits[1] = drop_bits;
  const Echo echo = air.strongest(target_range_m, bits);
  // The receiver's gate opens at the least range.
  return echo.range_m < static_cast<float>(spec_.range_min_m) ? Echo{} : echo;
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
  std::array<Lanes, Scratch::kDraws> normals;
  normals.fill(Lanes::Zero());
  for (std::size_t b = 0; b < returns.size(); ++b) {
    const auto is_seen = returns[b].range_m > 0.0F;
    Lanes range_m = returns[b].range_m;
    if (is_noisy) {
      if (b % Scratch::kDraws == 0) {
        for (std::size_t i = 0; i < block.cycles; ++i) {
          // A firing cycle's own time and the laser's number name each ray of a whole run.
          const auto bits = range_noise_.bits(
              draw_index(block.times[i]), b / Scratch::kDraws + (which == 0 ? 0 : kSecondReturn));
          for (std::size_t k = 0; k < Scratch::kDraws; ++k) {
            normals[k](static_cast<Eigen::Index>(i)) = gaussian_from_bits(bits[k]);
          }
        }
      }
      const Lanes power = is_seen.select(returns[b].power, 1.0F);
      range_m += (variance_m2 + weak_m2 / power).sqrt() * normals[b % Scratch::kDraws];
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

}  // namespace locsim::sim
