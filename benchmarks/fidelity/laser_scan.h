#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "core/messages.h"

namespace locsim::fidelity {

/// Lasers of an HDL-64E.
inline constexpr std::size_t kLasers = 64;

/// A point of a KITTI file: all that is known of a return, `lidar` frame.
struct RawPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  /// 0…1.
  float intensity = 0.0F;
};

/// Reads one scan of KITTI's raw data: float32 x, y, z, intensity, little endian; zeros may follow.
/// Throws InputError where the file cannot be read or ends within a point.
[[nodiscard]] std::vector<RawPoint> read_kitti_scan(const std::filesystem::path& file);

/// A simulated scan in the order of a KITTI file: laser by laser from the highest, each from
/// azimuth 0 counter-clockwise, and nothing else kept. Returns farther than `range_max_m` are left
/// out: KITTI's files end at 80 m.
[[nodiscard]] std::vector<RawPoint> in_kitti_order(const LidarScan& scan,
                                                   double range_max_m = 80.0);

/// A return of a known laser.
struct LaserReturn {
  Vector3f position = Vector3f::Zero();
  float intensity = 0.0F;
  /// From the sensor's origin.
  float range_m = 0.0F;
  /// Counter-clockwise from x, 0…2π.
  float azimuth_rad = 0.0F;
};

/// One turn, laser by laser.
struct LaserScan {
  /// Index 0 is the lowest laser; azimuths ascend.
  std::array<std::vector<LaserReturn>, kLasers> lasers;

  [[nodiscard]] std::size_t size() const;
};

/// Finds each point's laser: within a laser azimuths ascend from 0 to 2π, so the next laser starts
/// where the azimuth falls. Points at the origin are padding and are dropped. Throws InputError
/// where that does not give 64 lasers whose median elevations descend.
[[nodiscard]] LaserScan recover_lasers(std::span<const RawPoint> points);

/// All scans (`*.bin`) of a folder in the order of their names, every laser found. Throws
/// InputError where there are none.
[[nodiscard]] std::vector<LaserScan> read_drive(const std::filesystem::path& folder);

}  // namespace locsim::fidelity
