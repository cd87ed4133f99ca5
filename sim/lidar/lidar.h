#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/messages.h"
#include "core/pose.h"
#include "core/random.h"
#include "core/time.h"
#include "sim/faults/faults.h"
#include "sim/lidar/air_echoes.h"
#include "sim/lidar/firing_block.h"
#include "sim/lidar/lidar_spec.h"
#include "sim/lidar/return_model.h"
#include "sim/lidar/scene_echoes.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"
#include "sim/weather/weather.h"

namespace locsim::sim {

/// A LIDAR on the car. Every ray starts where the sensor is when it fires and meets every actor
/// where that is then; points are in the lidar frame of that same instant.
///
/// Rays go in packets of one beam in `kLanes` successive firing cycles; the packets of those
/// cycles make a block. Blocks are counted from the start of the scan and each is cast whole, so
/// points do not depend on how a scan is sliced nor on the number of threads.
class Lidar {
 public:
  /// `sensor` goes into the points and keys the noise together with `seed`; faults that name a
  /// sensor mean this number. Throws InputError for a specification outside its limits.
  Lidar(LidarSpec spec, const Pose& T_vehicle_lidar, std::uint16_t sensor, std::uint64_t seed,
        Weather weather = {}, const Faults& faults = {});

  [[nodiscard]] const LidarSpec& spec() const { return spec_; }
  [[nodiscard]] std::size_t rays_per_scan() const { return spec_.beams.size() * spec_.cycles(); }

  /// A scan without points yet, from `start` to its end.
  [[nodiscard]] LidarScan start_scan(Stamp start) const;

  /// Casts those blocks of the scan that end in (`from`, `to`] and appends their returns, in
  /// firing order; of two returns of one ray the stronger comes first. Slices that follow each
  /// other from `scan.start` to `scan.end` cast every ray once. A firing cycle within which the car
  /// is set down elsewhere has no returns. `trajectory` must reach from
  /// `scan.start` to `to`. Works in as many threads as the caller's task arena has.
  void cast(const RayScene& scene, const Trajectory& trajectory, Stamp from, Stamp to,
            LidarScan& scan);

 private:
  /// The air of one whole second.
  struct Air {
    std::int64_t second;
    std::shared_ptr<const AirEchoes> echoes;
  };
  /// What the receiver makes of a packet's echoes: one list of returns, or two.
  struct Returns {
    Lanes range_m;
    Lanes power;
  };
  struct Scratch;

  [[nodiscard]] Stamp block_end(const LidarScan& scan, std::size_t block) const;
  [[nodiscard]] Pose T_vehicle_lidar_at(Stamp time) const;
  [[nodiscard]] FiringBlock firing_block(const Trajectory& trajectory, Stamp scan_start,
                                         std::size_t index) const;
  void prepare_air(Stamp from, Stamp to);
  [[nodiscard]] const AirEchoes* air_at(Stamp time) const;
  /// Writes the block's returns to `points`, room for all its rays, and says how many.
  std::size_t cast_block(const SceneCaster& caster, const FiringBlock& block,
                         std::span<const std::uint32_t> near_actors, Stamp scan_start,
                         LidarPoint* points) const;
  [[nodiscard]] Lanes window_gain(const FiringBlock& block, std::size_t beam) const;
  void receive(const FiringBlock& block, const AirEchoes* air, Scratch& scratch) const;
  void receive_beam(const FiringBlock& block, std::size_t beam, const AirEchoes* air,
                    Scratch& scratch) const;
  void draw_drops(const FiringBlock& block, std::size_t beam, Scratch& scratch) const;
  [[nodiscard]] Echo air_echo(const AirEchoes& air, Stamp fired, std::size_t beam,
                              std::uint32_t drop_bits, float target_range_m) const;
  void measure(const FiringBlock& block, std::size_t which, Scratch& scratch) const;
  std::size_t report(const FiringBlock& block, Stamp scan_start, const Scratch& scratch,
                     LidarPoint* points) const;

  LidarSpec spec_;
  Pose T_vehicle_lidar_;
  std::uint16_t sensor_;
  Weather weather_;
  /// Of this sensor.
  std::vector<Faults::Timed<LidarBlackout>> blackouts_;
  std::vector<Faults::Timed<LidarDirt>> dirts_;
  std::vector<Faults::Timed<LidarKnock>> knocks_;
  Receiver receiver_;
  RandomStream range_noise_;
  RandomStream air_noise_;
  std::vector<BeamRay> rays_;
  std::size_t sub_rays_;
  std::vector<HeadTurn> heads_;
  std::vector<std::uint16_t> rings_;
  std::vector<float> biases_m_;
  /// Noise may bring a target beyond the limit back within it.
  float cast_range_m_;
  SceneCaster::Spread spread_;
  std::vector<Air> air_;
  std::vector<LidarPoint> slots_;
};

}  // namespace locsim::sim
