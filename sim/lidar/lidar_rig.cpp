#include "sim/lidar/lidar_rig.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"

namespace locsim::sim {

LidarRig::LidarRig(std::span<const MountedLidar> lidars, std::uint64_t seed, const Weather& weather,
                   Faults faults, Stamp start)
    : faults_(std::move(faults)), jitter_(seed, "lidar/stamps"), cast_to_(start) {
  if (lidars.empty()) throw InputError("lidar: none given, needs at least one");
  period_ = lidars.front().spec.period();
  for (std::size_t i = 0; i < lidars.size(); ++i) {
    if (lidars[i].spec.period() != period_) {
      throw InputError("lidar[" + std::to_string(i) +
                       "]: rate_hz differs from that of the first; they turn together");
    }
    Lidar lidar(lidars[i].spec, lidars[i].T_vehicle_lidar, static_cast<std::uint16_t>(i), seed,
                weather, faults_);
    LidarScan scan = lidar.start_scan(start);
    units_.push_back({.lidar = std::move(lidar), .scan = std::move(scan), .last_good = {}});
  }
}

void LidarRig::cast(const RayScene& scene, const Trajectory& trajectory, Stamp to) {
  to = std::min(to, units_.front().scan.end);
  if (to <= cast_to_) return;
  for (Unit& unit : units_) unit.lidar.cast(scene, trajectory, cast_to_, to, unit.scan);
  cast_to_ = to;
}

LidarScan LidarRig::finish() {
  assert(cast_to_ == units_.front().scan.end);
  std::vector<LidarScan> scans;
  scans.reserve(units_.size());
  for (std::size_t i = 0; i < units_.size(); ++i) scans.push_back(delivered(units_[i], i));
  return merge_scans(std::move(scans));
}

LidarScan LidarRig::delivered(Unit& unit, std::size_t index) {
  const Stamp end = unit.scan.end;
  LidarScan scan = std::exchange(unit.scan, unit.lidar.start_scan(end));
  std::optional<LidarFrozen> frozen;
  bool freezes_later = false;
  for (const auto& [interval, fault] : faults_.all<LidarFrozen>()) {
    if (!fault.includes(index)) continue;
    if (!frozen && interval.contains(end)) frozen = fault;
    freezes_later = freezes_later || interval.begin > end;
  }
  // Kept only while a fault may still ask for it.
  if (!frozen && freezes_later) unit.last_good = scan;
  if (frozen) {
    const LidarScan now = std::exchange(scan, unit.last_good);
    if (frozen->new_stamps || scan.points.empty()) {
      scan.start = now.start;
      scan.end = now.end;
    }
  }
  for (const auto& [interval, fault] : faults_.all<LidarStamps>()) {
    if (!fault.includes(index) || !interval.contains(end)) continue;
    const auto draw = static_cast<std::uint64_t>(end.time_since_epoch().count());
    const Duration shift =
        duration_from_seconds(fault.offset_s + fault.jitter_s * jitter_.gaussian(draw, index));
    scan.start += shift;
    scan.end += shift;
  }
  return scan;
}

LidarScan merge_scans(std::vector<LidarScan> scans) {
  assert(!scans.empty());
  const Stamp newest = std::ranges::max(scans, {}, &LidarScan::end).start;
  std::erase_if(scans, [&](const LidarScan& scan) { return scan.end <= newest; });
  LidarScan merged{.start = scans.front().start, .end = scans.front().end, .points = {}};
  for (const LidarScan& scan : scans) {
    merged.start = std::min(merged.start, scan.start);
    merged.end = std::max(merged.end, scan.end);
  }
  for (LidarScan& scan : scans) {
    const auto later = static_cast<std::uint32_t>((scan.start - merged.start).count());
    if (later != 0) {
      for (LidarPoint& point : scan.points) point.time_ns += later;
    }
    if (merged.points.empty()) {
      merged.points = std::move(scan.points);
      continue;
    }
    const auto middle = static_cast<std::ptrdiff_t>(merged.points.size());
    merged.points.insert(merged.points.end(), scan.points.begin(), scan.points.end());
    std::ranges::inplace_merge(merged.points, merged.points.begin() + middle, {},
                               &LidarPoint::time_ns);
  }
  return merged;
}

}  // namespace locsim::sim
