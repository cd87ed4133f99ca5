#include "benchmarks/fidelity/laser_scan.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "core/error.h"

namespace locsim::fidelity {

namespace {

/// Nothing nearer is a return of an HDL-64E.
constexpr float kNearest_m = 0.3F;
/// Azimuths of one laser ascend; float rounding may turn them back by this much.
constexpr float kSlack_rad = 1e-3F;

float azimuth_rad(float x_m, float y_m) {
  constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
  const float azimuth = std::atan2(y_m, x_m);
  return azimuth < 0.0F ? azimuth + kTurn : azimuth;
}

double median_elevation_rad(const std::vector<LaserReturn>& laser) {
  std::vector<double> elevations;
  elevations.reserve(laser.size());
  for (const LaserReturn& r : laser) {
    elevations.push_back(std::asin(std::clamp(r.position.z() / r.range_m, -1.0F, 1.0F)));
  }
  const auto middle = elevations.begin() + static_cast<std::ptrdiff_t>(elevations.size() / 2);
  std::nth_element(elevations.begin(), middle, elevations.end());
  return *middle;
}

}  // namespace

std::vector<RawPoint> read_kitti_scan(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) throw InputError(file.string() + ": cannot be read; give the path of a KITTI scan");
  std::vector<char> bytes(static_cast<std::size_t>(stream.tellg()));
  stream.seekg(0);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream) throw InputError(file.string() + ": ends before its size; copy it again");
  std::vector<RawPoint> points(bytes.size() / sizeof(RawPoint));
  const std::size_t whole = points.size() * sizeof(RawPoint);
  const bool is_padded = std::all_of(bytes.begin() + static_cast<std::ptrdiff_t>(whole),
                                     bytes.end(), [](char byte) { return byte == 0; });
  if (points.empty() || !is_padded) {
    throw InputError(file.string() + ": has " + std::to_string(bytes.size()) +
                     " bytes, needs a multiple of 16 (float32 x, y, z, intensity)");
  }
  std::memcpy(points.data(), bytes.data(), whole);
  return points;
}

std::vector<RawPoint> in_kitti_order(const LidarScan& scan, double range_max_m) {
  std::vector<const LidarPoint*> order;
  order.reserve(scan.points.size());
  for (const LidarPoint& p : scan.points) {
    if (p.position().norm() <= range_max_m) order.push_back(&p);
  }
  std::ranges::stable_sort(order, [](const LidarPoint* a, const LidarPoint* b) {
    if (a->ring != b->ring) return a->ring > b->ring;
    return azimuth_rad(a->x_m, a->y_m) < azimuth_rad(b->x_m, b->y_m);
  });
  std::vector<RawPoint> points;
  points.reserve(order.size());
  for (const LidarPoint* p : order) points.push_back({p->x_m, p->y_m, p->z_m, p->intensity});
  return points;
}

std::size_t LaserScan::size() const {
  return std::accumulate(
      lasers.begin(), lasers.end(), std::size_t{0},
      [](std::size_t sum, const std::vector<LaserReturn>& laser) { return sum + laser.size(); });
}

LaserScan recover_lasers(std::span<const RawPoint> points) {
  std::vector<std::vector<LaserReturn>> runs;
  float last_rad = std::numeric_limits<float>::infinity();
  for (const RawPoint& p : points) {
    const Vector3f position(p.x_m, p.y_m, p.z_m);
    const float range_m = position.norm();
    if (range_m < kNearest_m) continue;
    const float azimuth = azimuth_rad(p.x_m, p.y_m);
    if (azimuth < last_rad - kSlack_rad) runs.emplace_back();
    runs.back().push_back({.position = position,
                           .intensity = p.intensity,
                           .range_m = range_m,
                           .azimuth_rad = azimuth});
    last_rad = azimuth;
  }
  if (runs.size() != kLasers) {
    throw InputError("scan: its azimuths fall " + std::to_string(runs.size()) +
                     " times, needs 64: one laser after another, each from azimuth 0 on");
  }
  LaserScan scan;
  double last_elevation_rad = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kLasers; ++i) {
    const double elevation_rad = median_elevation_rad(runs[i]);
    if (elevation_rad >= last_elevation_rad) {
      throw InputError("scan: laser " + std::to_string(i) +
                       " does not lie below the one before it; needs the highest laser first");
    }
    last_elevation_rad = elevation_rad;
    scan.lasers[kLasers - 1 - i] = std::move(runs[i]);
  }
  return scan;
}

std::vector<LaserScan> read_drive(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".bin") files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    throw InputError(folder.string() + ": holds no scans; name a folder with KITTI's .bin files");
  }
  std::ranges::sort(files);
  std::vector<LaserScan> scans;
  scans.reserve(files.size());
  for (const auto& file : files) scans.push_back(recover_lasers(read_kitti_scan(file)));
  return scans;
}

}  // namespace locsim::fidelity
