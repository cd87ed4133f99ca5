#include "localization/dynamic_icp/candidate_search.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "localization/icp/map_registration.h"

namespace locsim::localization {

namespace {

constexpr double kBelow_m = 30.0;
constexpr double kAbove_m = 60.0;
constexpr int kFull = 4;
constexpr std::size_t kPointsMin = 30;
/// Peaks are picked among so many of the best places.
constexpr std::size_t kPeakPool = 20'000;
/// Cells beside each other that are scored in one go: a vector register's.
constexpr int kLanes = 16;
/// So many of `kFull` fit into a byte.
constexpr std::size_t kBatch = 255 / kFull;

/// Cells about the search's centre with `kFull` where the map has a surface, less beside it, in
/// layers of one height. Its outermost cells are empty. Local frame of the map.
class Volume {
 public:
  Volume(const LocalMap& map, const Vector3d& center, double half_width_m, double cell_m)
      : cell_m_(cell_m), half_(static_cast<int>(std::ceil(half_width_m / cell_m)) + 2) {
    corner_ = center.head<2>().array() - (half_ + 0.5) * cell_m;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    const auto within = [&](const Vector3d& mean) {
      return mean.z() > center.z() - kBelow_m && mean.z() < center.z() + kAbove_m &&
             (mean.head<2>() - center.head<2>()).array().abs().maxCoeff() < half_width_m;
    };
    map.for_each(0, [&](const Vector3d& mean, const Surfel&) {
      if (!within(mean)) return;
      low = std::min(low, mean.z());
      high = std::max(high, mean.z());
    });
    if (!(low <= high)) low = high = center.z();
    bottom_m_ = low - 2.0 * cell_m;
    heights_ = static_cast<int>((high - bottom_m_) / cell_m) + 3;
    const auto side = static_cast<std::size_t>(columns());
    cells_.assign(side * side * static_cast<std::size_t>(heights_) + kLanes, 0);
    map.for_each(0, [&](const Vector3d& mean, const Surfel&) {
      if (within(mean)) fill_about(mean);
    });
  }

  /// The cell of the lowest layer `x` east and `y` north of the centre's, and those east of it;
  /// `shift` from there is a cell too while it stays within the half width.
  [[nodiscard]] const std::uint8_t* at(int x, int y) const {
    return &cells_[static_cast<std::size_t>(index(x + half_, y + half_, 0))];
  }
  /// Difference of index for a shift.
  [[nodiscard]] std::int64_t shift(int x, int y, int layer) const { return index(x, y, layer); }
  /// Of a height above the lowest layer; beyond all it is the nearest.
  [[nodiscard]] int layer(double cells_above_bottom) const {
    return static_cast<int>(std::clamp(std::floor(cells_above_bottom), 0.0, heights_ - 1.0));
  }
  [[nodiscard]] double bottom_m() const { return bottom_m_; }

 private:
  [[nodiscard]] int columns() const { return 2 * half_ + 1; }
  [[nodiscard]] std::int64_t index(int x, int y, int layer) const {
    return (static_cast<std::int64_t>(layer) * columns() + y) * columns() + x;
  }

  void fill_about(const Vector3d& mean) {
    const int x = static_cast<int>((mean.x() - corner_.x()) / cell_m_);
    const int y = static_cast<int>((mean.y() - corner_.y()) / cell_m_);
    const int z = static_cast<int>((mean.z() - bottom_m_) / cell_m_);
    for (int k = -1; k <= 1; ++k) {
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          std::uint8_t& cell = cells_[static_cast<std::size_t>(index(x + i, y + j, z + k))];
          const int steps = std::abs(i) + std::abs(j) + std::abs(k);
          cell = std::max(cell, static_cast<std::uint8_t>(kFull >> steps));
        }
      }
    }
  }

  double cell_m_;
  int half_;
  Eigen::Vector2d corner_;
  double bottom_m_ = 0.0;
  int heights_ = 0;
  std::vector<std::uint8_t> cells_;
};

/// A place on the ground to try.
struct Place {
  int x;
  int y;
  double ground_m;
};

std::vector<Place> places_of(const LocalMap& map, const Vector3d& center, const SearchArea& area,
                             double cell_m) {
  const int reach = static_cast<int>(std::ceil(area.radius_m() / cell_m));
  const Eigen::Matrix2d inverse = area.shape_m2.inverse();
  std::vector<Place> places;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const Eigen::Vector2d offset(x * cell_m, y * cell_m);
      if (offset.dot(inverse * offset) <= 1.0) places.push_back({x, y, 0.0});
    }
  }
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    const Vector3d offset(places[i].x * cell_m, places[i].y * cell_m, 0.0);
    places[i].ground_m = map.ground_height_m(center + offset);
  });
  std::erase_if(places, [](const Place& place) { return !std::isfinite(place.ground_m); });
  return places;
}

/// `count` of the points that stand above the ground (which lies at height 0), or of all where too
/// few do.
std::vector<Vector3f> pick(std::span<const Vector3f> points, const CandidateSearchConfig& config) {
  std::vector<Vector3f> high;
  std::ranges::copy_if(points, std::back_inserter(high), [&](const Vector3f& p) {
    return static_cast<double>(p.z()) > config.above_ground_m;
  });
  const std::span<const Vector3f> from = high.size() >= kPointsMin ? high : points;
  const std::size_t count = std::min(from.size(), static_cast<std::size_t>(config.points));
  std::vector<Vector3f> picked;
  for (std::size_t i = 0; i < count; ++i) picked.push_back(from[i * from.size() / count]);
  return picked;
}

/// Up to `kLanes` places beside each other whose ground has one height.
struct Strip {
  std::size_t first;
  int count;
  const std::uint8_t* cells;
  /// Index of the ground's height, by half cells.
  std::size_t ground;
};

struct Strips {
  std::vector<Strip> strips;
  /// Of the lowest ground, and the number of heights.
  int lowest = 0;
  std::size_t grounds = 0;
};

Strips strips_of(std::span<const Place> places, const Volume& volume, double cell_m) {
  std::vector<int> grounds;
  for (const Place& place : places) {
    grounds.push_back(
        static_cast<int>(std::lround(2.0 * (place.ground_m - volume.bottom_m()) / cell_m)));
  }
  const auto [low, high] = std::ranges::minmax(grounds);
  Strips made{.strips = {}, .lowest = low, .grounds = static_cast<std::size_t>(high - low) + 1};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto ground = static_cast<std::size_t>(grounds[i] - low);
    if (!made.strips.empty()) {
      Strip& last = made.strips.back();
      const Place& first = places[last.first];
      if (last.ground == ground && last.count < kLanes && places[i].y == first.y &&
          places[i].x == first.x + last.count) {
        ++last.count;
        continue;
      }
    }
    made.strips.push_back({i, 1, volume.at(places[i].x, places[i].y), ground});
  }
  return made;
}

/// Of every heading (outer) and place.
std::vector<std::uint16_t> score_all(const Volume& volume, std::span<const Place> places,
                                     std::span<const Vector3f> points,
                                     std::span<const double> turns, double cell_m) {
  const Strips strips = strips_of(places, volume, cell_m);
  std::vector<std::uint16_t> scores(turns.size() * places.size());
  tbb::parallel_for(std::size_t{0}, turns.size(), [&](std::size_t turn) {
    const Eigen::Rotation2Dd rotation(turns[turn]);
    std::vector<std::int64_t> shifts;
    shifts.reserve(strips.grounds * points.size());
    for (std::size_t ground = 0; ground < strips.grounds; ++ground) {
      const double ground_cells = 0.5 * (strips.lowest + static_cast<int>(ground));
      for (const Vector3f& p : points) {
        const Vector3d in_cells = p.cast<double>() / cell_m;
        const Eigen::Vector2d turned = rotation * in_cells.head<2>();
        shifts.push_back(volume.shift(static_cast<int>(std::lround(turned.x())),
                                      static_cast<int>(std::lround(turned.y())),
                                      volume.layer(in_cells.z() + ground_cells)));
      }
    }
    for (const Strip& strip : strips.strips) {
      const std::span<const std::int64_t> of_ground =
          std::span(shifts).subspan(strip.ground * points.size(), points.size());
      std::array<std::uint16_t, kLanes> sums{};
      for (std::size_t from = 0; from < of_ground.size(); from += kBatch) {
        std::array<std::uint8_t, kLanes> part{};
        for (const std::int64_t shift :
             of_ground.subspan(from, std::min(kBatch, of_ground.size() - from))) {
          const std::uint8_t* const cells = strip.cells + shift;
          for (std::size_t i = 0; i < kLanes; ++i) {
            part[i] = static_cast<std::uint8_t>(part[i] + cells[i]);
          }
        }
        for (std::size_t i = 0; i < kLanes; ++i) {
          sums[i] = static_cast<std::uint16_t>(sums[i] + part[i]);
        }
      }
      std::copy_n(sums.begin(), strip.count,
                  scores.begin() + static_cast<std::ptrdiff_t>(turn * places.size() + strip.first));
    }
  });
  return scores;
}

/// Indices of the `count` highest, the highest first; of equal ones the first first.
std::vector<std::uint32_t> highest(std::span<const std::uint16_t> scores, std::size_t count) {
  const std::size_t most = std::ranges::max(scores);
  std::vector<std::size_t> starts(most + 2, 0);
  // Of a score: how many have it, then how many have more.
  for (const std::uint16_t score : scores) ++starts[score];
  std::size_t more = 0;
  for (std::size_t score = most + 1; score-- > 0;) more += std::exchange(starts[score], more);
  std::vector<std::uint32_t> order(std::min(count, scores.size()));
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const std::size_t at = starts[scores[i]]++;
    if (at < order.size()) order[at] = static_cast<std::uint32_t>(i);
  }
  return order;
}

std::vector<double> turns_of(const SearchArea& area, double step_rad) {
  std::vector<double> turns;
  if (area.heading_rad >= std::numbers::pi - 0.5 * step_rad) {
    const int count = static_cast<int>(std::ceil(2.0 * std::numbers::pi / step_rad));
    for (int i = 0; i < count; ++i) turns.push_back(2.0 * std::numbers::pi * i / count);
  } else {
    const int reach = static_cast<int>(std::ceil(area.heading_rad / step_rad));
    for (int i = -reach; i <= reach; ++i) {
      turns.push_back(reach > 0 ? area.heading_rad * i / reach : 0.0);
    }
  }
  return turns;
}

}  // namespace

double SearchArea::radius_m() const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(shape_m2);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[1]));
}

void CandidateSearchConfig::describe(Parameters& p) {
  p.number("cell_m", cell_m, {0.25, 5.0});
  p.degrees("heading_step_deg", heading_step_rad, {0.5, 45.0});
  p.integer("points", points, {30, 5000});
  p.number("above_ground_m", above_ground_m, {-10.0, 20.0});
  p.integer("candidates_max", candidates_max, {1, 5000});
  p.number("apart_m", apart_m, {0.1, 50.0});
  p.degrees("apart_deg", apart_rad, {0.1, 180.0});
}

std::vector<Candidate> find_candidates(const LocalMap& map, std::span<const Vector3f> points,
                                       const SearchArea& area,
                                       const CandidateSearchConfig& config) {
  // The scan with gravity downwards, its heading that of the guess, ground at height 0.
  std::vector<Vector3f> level(points.begin(), points.end());
  for (Vector3f& p : level) p = area.guess.rotation.cast<float>() * p;
  const double scan_ground_m = ground_height_m(level, Vector3f::Zero());
  if (!std::isfinite(scan_ground_m)) return {};
  for (Vector3f& p : level) p.z() -= static_cast<float>(scan_ground_m);
  const std::vector<Vector3f> few = pick(level, config);

  const Vector3d center = area.guess.translation - map.origin();
  Vector3d on_ground = center;
  const std::vector<Place> places = places_of(map, center, area, config.cell_m);
  if (places.empty() || few.empty()) return {};
  on_ground.z() = places[places.size() / 2].ground_m;
  double reach_m = 0.0;
  for (const Vector3f& p : few) {
    reach_m = std::max(reach_m, static_cast<double>(p.head<2>().norm()));
  }
  const Volume volume(map, on_ground, area.radius_m() + reach_m + 2.0 * config.cell_m,
                      config.cell_m);

  const std::vector<double> turns = turns_of(area, config.heading_step_rad);
  const std::vector<std::uint16_t> scores = score_all(volume, places, few, turns, config.cell_m);
  struct Peak {
    Eigen::Vector2d offset;
    double turn_rad;
  };
  std::vector<Peak> peaks;
  std::vector<Candidate> candidates;
  for (const std::uint32_t index : highest(scores, kPeakPool)) {
    if (candidates.size() == static_cast<std::size_t>(config.candidates_max)) break;
    const Place& place = places[index % places.size()];
    const double turn = turns[index / places.size()];
    const Eigen::Vector2d offset = config.cell_m * Eigen::Vector2d(place.x, place.y);
    const auto is_near = [&](const Peak& peak) {
      return (peak.offset - offset).norm() < config.apart_m &&
             std::abs(wrap_angle(peak.turn_rad - turn)) < config.apart_rad;
    };
    if (std::ranges::any_of(peaks, is_near)) continue;
    peaks.push_back({offset, turn});
    Candidate candidate;
    candidate.T_map_vehicle.rotation = so3::exp({0.0, 0.0, turn}) * area.guess.rotation;
    candidate.T_map_vehicle.translation =
        map.origin() +
        Vector3d(center.x() + offset.x(), center.y() + offset.y(), place.ground_m - scan_ground_m);
    candidate.score =
        static_cast<double>(scores[index]) / (kFull * static_cast<double>(few.size()));
    candidates.push_back(candidate);
  }
  return candidates;
}

}  // namespace locsim::localization
