#include "maps/build/survey.h"

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <unordered_map>

#include "core/error.h"
#include "core/random.h"
#include "maps/build/corridor.h"

namespace locsim::maps::build {

namespace {

/// Samples for each resolution²: at 3, a low-discrepancy set leaves hardly a voxel of a plane out.
constexpr double kSamplesPerVoxelFace = 3.0;

/// A bit for each voxel, in cubes of 64³ made as they are met.
class VoxelBits {
 public:
  explicit VoxelBits(double voxel_m) : per_meter_(1.0 / voxel_m) {}

  /// True at the first call for the voxel of `p`.
  bool mark(const Vector3d& p) {
    const Eigen::Array3d cell = (p.array() * per_meter_).floor();
    const auto x = static_cast<std::int64_t>(cell.x());
    const auto y = static_cast<std::int64_t>(cell.y());
    const auto z = static_cast<std::int64_t>(cell.z());
    std::uint64_t& word = cube(x >> 6, y >> 6, z >> 6)[((z & 63) << 6) | (y & 63)];
    const std::uint64_t bit = 1ULL << (x & 63);
    const bool fresh = (word & bit) == 0;
    word |= bit;
    return fresh;
  }

 private:
  using Cube = std::array<std::uint64_t, 64 * 64>;

  Cube& cube(std::int64_t x, std::int64_t y, std::int64_t z) {
    constexpr std::uint64_t mask = (1ULL << 21) - 1;
    const std::uint64_t key = ((static_cast<std::uint64_t>(x) & mask) << 42) |
                              ((static_cast<std::uint64_t>(y) & mask) << 21) |
                              (static_cast<std::uint64_t>(z) & mask);
    if (last_ == nullptr || key != last_key_) {
      std::unique_ptr<Cube>& entry = cubes_[key];
      if (!entry) entry = std::make_unique<Cube>();
      last_ = entry.get();
      last_key_ = key;
    }
    return *last_;
  }

  double per_meter_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Cube>> cubes_;
  std::uint64_t last_key_ = 0;
  Cube* last_ = nullptr;
};

/// Point `index` of the R2 sequence (M. Roberts 2018), shifted, in the unit square.
Eigen::Vector2d r2_point(std::uint64_t index, const Eigen::Vector2d& shift) {
  constexpr double kA1 = 0.7548776662466927;
  constexpr double kA2 = 0.5698402909980532;
  const auto n = static_cast<double>(index);
  const Eigen::Vector2d p(shift.x() + kA1 * n, shift.y() + kA2 * n);
  return {p.x() - std::floor(p.x()), p.y() - std::floor(p.y())};
}

/// Calls `use(point)` for samples of the triangle: their number is `samples` rounded at random so
/// that its mean is kept, their places are even over its area.
template <typename Use>
void sample_triangle(const TriangleMesh& mesh, std::size_t triangle, double per_m2,
                     const RandomStream& random, std::uint64_t lane, const Use& use) {
  const Vector3d a = mesh.corner(triangle, 0);
  const Vector3d ab = mesh.corner(triangle, 1) - a;
  const Vector3d ac = mesh.corner(triangle, 2) - a;
  const double area_m2 = 0.5 * ab.cross(ac).norm();
  const auto bits = random.bits(triangle, lane);
  const auto samples = static_cast<std::uint64_t>(area_m2 * per_m2 + uniform_from_bits(bits[0]));
  const Eigen::Vector2d shift(uniform_from_bits(bits[1]), uniform_from_bits(bits[2]));
  for (std::uint64_t i = 0; i < samples; ++i) {
    Eigen::Vector2d uv = r2_point(i, shift);
    if (uv.sum() > 1.0) uv = Eigen::Vector2d::Ones() - uv;
    use(Vector3d(a + uv.x() * ab + uv.y() * ac));
  }
}

void check_mesh(const TriangleMesh& mesh) {
  for (const Vector3f& v : mesh.vertices) {
    if (!v.allFinite()) throw InputError("survey: the mesh has a vertex that is not finite");
  }
}

/// The noisy points in tiles, each relative to its tile from the start.
class TileWriter {
 public:
  explicit TileWriter(double size_m) : size_m_(size_m) {}

  void add(const Vector3d& p) {
    const auto column = static_cast<std::int64_t>(std::floor(p.x() / size_m_));
    const auto row = static_cast<std::int64_t>(std::floor(p.y() / size_m_));
    const std::uint64_t key = (static_cast<std::uint64_t>(column) << 32) ^
                              (static_cast<std::uint64_t>(row) & 0xffffffffU);
    if (tiles_.empty() || key != last_key_) {
      const auto [entry, fresh] = tile_of_.try_emplace(key, tiles_.size());
      if (fresh) {
        tiles_.push_back({{(static_cast<double>(column) + 0.5) * size_m_,
                           (static_cast<double>(row) + 0.5) * size_m_, std::floor(p.z())},
                          {}});
      }
      last_key_ = key;
      last_ = entry->second;
    }
    tiles_[last_].points.push_back((p - tiles_[last_].origin).cast<float>());
  }

  [[nodiscard]] std::vector<Tile> take() { return std::move(tiles_); }

 private:
  double size_m_;
  std::vector<Tile> tiles_;
  std::unordered_map<std::uint64_t, std::size_t> tile_of_;
  std::uint64_t last_key_ = 0;
  std::size_t last_ = 0;
};

}  // namespace

void SurveyConfig::describe(Parameters& p) {
  p.number("resolution_m", resolution_m, {0.02, 5.0});
  p.number("noise_m", noise_m, {0.0, 1.0});
  p.number("keep_within_m", keep_within_m, kNotNegative);
  p.number("tile_size_m", tile_size_m, {1.0, 1000.0});
}

PriorMap survey(std::span<const TriangleMesh* const> meshes, const SurveyConfig& config,
                const GeodeticPoint& geodetic_origin, std::uint64_t seed,
                std::span<const Vector3d> path) {
  check_parameters(config, "survey");
  std::optional<Corridor> corridor;
  if (config.keep_within_m > 0.0) {
    if (path.empty()) throw InputError("survey: keep_within_m is set, but there is no path");
    corridor.emplace(path, config.keep_within_m);
  }
  const RandomStream places(seed, "survey/place");
  const RandomStream noise(seed, "survey/noise");
  const double per_m2 = kSamplesPerVoxelFace / (config.resolution_m * config.resolution_m);
  VoxelBits taken(config.resolution_m);
  TileWriter writer(config.tile_size_m);
  std::uint64_t kept = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    check_mesh(*meshes[m]);
    for (std::size_t t = 0; t < meshes[m]->triangles.size(); ++t) {
      sample_triangle(*meshes[m], t, per_m2, places, m, [&](const Vector3d& p) {
        if (corridor && !corridor->contains(p.x(), p.y())) return;
        if (taken.mark(p)) writer.add(p + config.noise_m * noise.gaussian3(kept++));
      });
    }
  }
  return PriorMap::from_tiles(geodetic_origin, config.tile_size_m, writer.take());
}

}  // namespace locsim::maps::build
