#include "benchmarks/relocalization/basin.h"

#include <tbb/parallel_for.h>

#include <cstdio>

#include "benchmarks/relocalization/plain_icp.h"

namespace locsim::relocalization {

namespace {

/// Over the road: walls, trunks and poles, no cars.
constexpr float kLow_m = 2.2F;
constexpr float kHigh_m = 4.0F;
constexpr double kShown_m = 75.0;

std::vector<Eigen::Vector2f> walls_about(const maps::PriorMap& map, const Vector3d& center) {
  maps::Crop crop;
  map.crop(center, kShown_m, crop);
  std::vector<Eigen::Vector2f> walls;
  for (const Vector3f& p : crop.points) {
    const Vector3f from_center = p + (crop.origin - center).cast<float>();
    if (from_center.z() > kLow_m && from_center.z() < kHigh_m) {
      walls.emplace_back(from_center.head<2>());
    }
  }
  return walls;
}

}  // namespace

std::vector<Basin> find_basins(const StartTown& town, std::uint64_t seed, int places, double step_m,
                               const localization::DynamicIcpConfig& config) {
  std::vector<Basin> basins;
  PlainIcp plain(town.map(), kBasinSigma_m / kClaimedShare);
  for (const Berth& berth : town.draw_berths(places)) {
    Basin basin{.truth = town.pose(berth), .walls = {}, .points = {}};
    basin.walls = walls_about(town.map(), basin.truth.translation);
    const std::vector<Vector3f> scan = town.scan(berth);
    localization::DynamicIcp icp(town.map(), config);
    const int reach = static_cast<int>(kBasinRadius_m / step_m);
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const Eigen::Vector2d offset = step_m * Eigen::Vector2d(i, j);
        if (offset.norm() > kBasinRadius_m) continue;
        Start start = draw_start(seed, basin.points.size(), 2.0 * kBasinSigma_m, false);
        start.offset_m = offset;
        BasinPoint point{.offset_m = offset};
        point.dynamic = try_dynamic(icp, town, berth, scan, start, 2, 1).first.outcome;
        start.is_heading_known = true;
        start.yaw_error_rad = 0.0;
        point.icp_once = plain.once(basin.truth, scan, start).outcome;
        basin.points.push_back(point);
      }
    }
    basins.push_back(std::move(basin));
    std::fprintf(stderr, "basin %zu of %d\n", basins.size(), places);
  }
  return basins;
}

}  // namespace locsim::relocalization
