#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/messages.h"
#include "core/pose.h"
#include "core/random.h"
#include "core/time.h"
#include "sim/lidar/firing_block.h"
#include "sim/lidar/lidar_spec.h"
#include "sim/ray_scene.h"
#include "sim/trajectory.h"

namespace locsim::sim {

/// A spinning LIDAR on the car. Every ray starts where the sensor is when it fires and meets every
/// actor where that is then; points are in the lidar frame of that same instant.
///
/// Rays go in packets of one beam in `kLanes` successive firing cycles; the packets of those
/// cycles make a block. Blocks are counted from the start of the scan and each is cast whole, so
/// points do not depend on how a scan is sliced nor on the number of threads.
class Lidar {
 public:
  /// `sensor` goes into the points and keys the noise together with `seed`. Throws InputError for
  /// a specification outside its limits.
  Lidar(LidarSpec spec, const Pose& T_vehicle_lidar, std::uint16_t sensor, std::uint64_t seed);

  [[nodiscard]] const LidarSpec& spec() const { return spec_; }
  [[nodiscard]] std::size_t rays_per_scan() const { return spec_.beams.size() * spec_.cycles(); }

  /// A scan without points yet, from `start` to the end of its revolution.
  [[nodiscard]] LidarScan start_scan(Stamp start) const;

  /// Casts those blocks of the scan that end in (`from`, `to`] and appends their returns, in
  /// firing order. Slices that follow each other from `scan.start` to `scan.end` cast every ray
  /// once. `trajectory` must reach from `scan.start` to `to`. Works in as many threads as the
  /// caller's task arena has.
  void cast(const RayScene& scene, const Trajectory& trajectory, Stamp from, Stamp to,
            LidarScan& scan);

 private:
  struct Block;
  [[nodiscard]] Stamp block_end(const LidarScan& scan, std::size_t block) const;
  /// Writes the block's returns to `points`, room for all its rays, and says how many.
  std::size_t cast_block(const RayScene& scene, const Trajectory& trajectory,
                         std::span<const std::uint32_t> near_actors, Stamp scan_start,
                         std::size_t block, LidarPoint* points) const;
  void meet_standing(const RayScene& scene, const Block& block, std::vector<Echoes>& echoes) const;
  void meet_actor(const RayScene& scene, std::uint32_t actor, const Block& block,
                  std::vector<Echoes>& echoes) const;
  std::size_t report(const Block& block, Stamp scan_start, const std::vector<Echoes>& echoes,
                     LidarPoint* points) const;

  LidarSpec spec_;
  Pose T_vehicle_lidar_;
  std::uint16_t sensor_;
  RandomStream range_noise_;
  std::vector<BeamDirection> beams_;
  std::vector<HeadAngle> heads_;
  std::vector<std::uint16_t> rings_;
  /// Noise may bring a target beyond the limit back within it.
  float cast_range_m_;
  double azimuth_spread_rad_ = 0.0;
  std::vector<LidarPoint> slots_;
};

}  // namespace locsim::sim
