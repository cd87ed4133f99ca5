#include "sim/world/main_street.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "sim/world/street_index.h"

namespace locsim::sim {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// The street before the route's start and after its end, and the straights it starts and ends on.
constexpr double kOutsideM = 70.0;
constexpr double kStraightEndM = 25.0;
constexpr double kMaxHeadingRad = 75.0 * kDegree;
constexpr double kTurnRampM = 8.0;
constexpr double kBendRampM = 20.0;
// Hills take up to this share of the slope allowed: the rest is for camber and blending.
constexpr double kHillShare = 0.85;

/// Appends straights and bends; the state is the street's end.
class Pen {
 public:
  Pen(double main_course_rad, double heading_rad, double lane_offset_m)
      : main_course_(main_course_rad), heading_(heading_rad), lane_offset_(lane_offset_m) {
    push(0.0);
  }

  /// Course against the main direction [rad].
  [[nodiscard]] double heading() const { return heading_; }
  [[nodiscard]] double lane_m() const { return points_.back().lane_m; }
  [[nodiscard]] std::size_t last() const { return points_.size() - 1; }
  [[nodiscard]] std::vector<MainStreetPoint>& points() { return points_; }

  void straight(double length_m) { bend(0.0, length_m, 0.0); }

  /// Turns by `angle_rad` with least radius `radius_m`; curvature rises and falls over `ramp_m`.
  void turn(double angle_rad, double radius_m, double ramp_m) {
    const double ramp = std::min(ramp_m, 0.6 * std::abs(angle_rad) * radius_m);
    bend(std::copysign(1.0 / radius_m, angle_rad), std::abs(angle_rad) * radius_m + ramp, ramp);
  }

 private:
  void bend(double curvature, double length_m, double ramp_m) {
    const int steps = static_cast<int>(std::ceil(length_m / MainStreet::kStepM));
    const double step = length_m / steps;
    const auto at = [&](double d) {
      return curvature == 0.0 ? 0.0 : curvature * smoothstep(std::min(d, length_m - d) / ramp_m);
    };
    for (int i = 0; i < steps; ++i) {
      const double half_turn = 0.5 * step * at((i + 0.5) * step);
      const double course = main_course_ + heading_ + half_turn;
      position_ += step * Vector3d(std::cos(course), std::sin(course), 0.0);
      heading_ += 2.0 * half_turn;
      station_ += step;
      push(at((i + 1) * step));
    }
  }

  void push(double curvature) {
    MainStreetPoint point{.station_m = station_,
                          .lane_m = 0.0,
                          .position = position_,
                          .yaw_rad = main_course_ + heading_,
                          .curvature_1_m = curvature};
    if (!points_.empty()) {
      const MainStreetPoint& last = points_.back();
      const double mean = 0.5 * (last.curvature_1_m + curvature);
      point.lane_m = last.lane_m + (station_ - last.station_m) * (1.0 + lane_offset_ * mean);
    }
    points_.push_back(point);
  }

  double main_course_;
  double heading_;
  double lane_offset_;
  double station_ = 0.0;
  Vector3d position_ = Vector3d::Zero();
  std::vector<MainStreetPoint> points_;
};

/// Sums of waves over the street, scaled so that the steepest place has the slope wanted.
void raise_hills(RandomSequence& random, double max_slope, std::vector<MainStreetPoint>& points) {
  struct Wave {
    double number, phase, height;
  };
  std::array<Wave, 3> waves;
  constexpr std::array<std::array<double, 2>, 3> kLengths = {
      {{160.0, 260.0}, {300.0, 500.0}, {600.0, 1000.0}}};
  for (std::size_t k = 0; k < waves.size(); ++k) {
    const double length = random.uniform(kLengths[k][0], kLengths[k][1]);
    waves[k] = {2.0 * std::numbers::pi / length, random.uniform(0.0, 2.0 * std::numbers::pi),
                length * random.uniform(0.3, 1.0)};
  }
  double steepest = 0.0;
  for (MainStreetPoint& point : points) {
    double slope = 0.0;
    for (const Wave& wave : waves) {
      const double angle = wave.number * point.station_m + wave.phase;
      point.position.z() += wave.height * std::sin(angle);
      slope += wave.height * wave.number * std::cos(angle);
    }
    steepest = std::max(steepest, std::abs(slope));
  }
  const double scale = kHillShare * max_slope * random.uniform(0.75, 1.0) / steepest;
  for (MainStreetPoint& point : points) point.position.z() *= scale;
}

/// The origin goes to the middle of the extent, at the lowest height.
void center(std::vector<MainStreetPoint>& points) {
  Vector3d low = points.front().position;
  Vector3d high = low;
  for (const auto& point : points) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  const Vector3d middle(0.5 * (low.x() + high.x()), 0.5 * (low.y() + high.y()), low.z());
  for (auto& point : points) point.position -= middle;
}

void add_bend(RandomSequence& random, Pen& pen) {
  double angle = random.uniform(12.0, 40.0) * kDegree;
  if (random.chance(0.5)) angle = -angle;
  if (std::abs(pen.heading() + angle) > kMaxHeadingRad) angle = -angle;
  pen.turn(angle, random.uniform(42.0, 150.0), kBendRampM);
}

/// Turns off towards the main direction where that stays within bounds; else, straight on.
Junction add_junction(RandomSequence& random, double turn_share, double lane_offset_m, Pen& pen) {
  const double angle = std::copysign(random.uniform(80.0, 95.0) * kDegree, -pen.heading());
  const double lane_radius = random.uniform(10.5, 14.0);
  const bool turns = random.chance(turn_share) && std::abs(pen.heading() + angle) < kMaxHeadingRad;
  const std::size_t entry = pen.last();
  if (!turns) return {entry, entry};
  pen.turn(angle, lane_radius - std::copysign(lane_offset_m, angle), kTurnRampM);
  return {entry, pen.last()};
}

}  // namespace

MainStreet make_main_street(const TownLayoutConfig& config, std::uint64_t seed) {
  RandomSequence random(seed, "town/main_street");
  const double main_course = random.uniform(-std::numbers::pi, std::numbers::pi);
  const double side = random.chance(0.5) ? 1.0 : -1.0;
  const double heading = side * random.uniform(35.0, 50.0) * kDegree;
  const double lane_offset = 0.5 * config.lane_width_m;
  Pen pen(main_course, heading, lane_offset);
  MainStreet street;
  pen.straight(kOutsideM);
  street.start = pen.last();
  const double start_lane = pen.lane_m();
  const double end_lane = start_lane + config.length_m - kStraightEndM;

  bool bend_next = false;
  while (pen.lane_m() < end_lane) {
    pen.straight(random.uniform(70.0, 150.0));
    if (bend_next) {
      add_bend(random, pen);
    } else {
      street.junctions.push_back(add_junction(random, config.turn_share, lane_offset, pen));
    }
    bend_next = !bend_next && random.chance(0.7);
  }
  pen.straight(kStraightEndM);
  street.end = pen.last();
  pen.straight(kOutsideM);

  street.points = std::move(pen.points());
  for (MainStreetPoint& point : street.points) point.lane_m -= start_lane;
  raise_hills(random, config.max_slope, street.points);
  center(street.points);
  return street;
}

}  // namespace locsim::sim
