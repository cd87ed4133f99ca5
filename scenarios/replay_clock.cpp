#include "scenarios/replay_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace locsim::scenarios {

namespace {

constexpr Duration kStep{5'000'000};
constexpr int kSteps = 400;
constexpr double kLeastSpeed_m_s = 2.0;
constexpr double kLongestInterval_s = 1.1;
constexpr double kLeastCorrelation = 0.5;
constexpr std::size_t kFewestIntervals = 30;

struct Turn {
  Stamp from;
  Stamp until;
  double angle_rad = 0.0;
};

std::vector<Turn> course_turns(const GnssLog& log) {
  std::vector<Turn> turns;
  for (std::size_t i = 1; i < log.entries.size(); ++i) {
    const GnssLog::Entry& a = log.entries[i - 1];
    const GnssLog::Entry& b = log.entries[i];
    const Eigen::Vector2d from = a.fix.velocity_enu_m_s.head<2>();
    const Eigen::Vector2d to = b.fix.velocity_enu_m_s.head<2>();
    if (!a.reference || !b.reference || from.norm() < kLeastSpeed_m_s ||
        to.norm() < kLeastSpeed_m_s || to_seconds(b.fix.time - a.fix.time) > kLongestInterval_s) {
      continue;
    }
    const double angle_rad = std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
    turns.push_back({a.fix.time, b.fix.time, angle_rad});
  }
  return turns;
}

// What a gyro has turned since its first sample.
class TurnedAngle {
 public:
  TurnedAngle(const ImuLog& log, const Eigen::Quaterniond& R_vehicle_imu) {
    double angle_rad = 0.0;
    for (const ImuSample& sample : log.samples) {
      if (!times_.empty()) {
        angle_rad += (R_vehicle_imu * sample.angular_rate_rad_s).z() *
                     to_seconds(sample.time - times_.back());
      }
      times_.push_back(sample.time);
      angles_rad_.push_back(angle_rad);
    }
  }
  [[nodiscard]] bool covers(Stamp from, Stamp until) const {
    return from >= times_.front() && until <= times_.back();
  }
  [[nodiscard]] double at(Stamp time) const {
    const auto after = std::ranges::lower_bound(times_, time);
    const auto i = static_cast<std::size_t>(after - times_.begin());
    if (i == 0) return angles_rad_.front();
    const double share = to_seconds(time - times_[i - 1]) / to_seconds(times_[i] - times_[i - 1]);
    return angles_rad_[i - 1] + share * (angles_rad_[i] - angles_rad_[i - 1]);
  }

 private:
  std::vector<Stamp> times_;
  std::vector<double> angles_rad_;
};

ClockOffset compare(const std::vector<Turn>& turns, const TurnedAngle& gyro, Duration offset) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Turn& turn : turns) {
    if (!gyro.covers(turn.from + offset, turn.until + offset)) continue;
    const double by_gyro = gyro.at(turn.until + offset) - gyro.at(turn.from + offset);
    n += 1.0;
    x += by_gyro;
    y += turn.angle_rad;
    xx += by_gyro * by_gyro;
    xy += by_gyro * turn.angle_rad;
    yy += turn.angle_rad * turn.angle_rad;
  }
  ClockOffset result{.offset = offset, .intervals = static_cast<std::size_t>(n)};
  const double var_x = n * xx - x * x;
  const double var_y = n * yy - y * y;
  if (result.intervals >= kFewestIntervals && var_x > 0.0 && var_y > 0.0) {
    result.correlation = (n * xy - x * y) / std::sqrt(var_x * var_y);
    result.slope = (n * xy - x * y) / var_x;
  }
  return result;
}

}  // namespace

ClockOffset estimate_clock_offset(const DriveLog& log, const Pose& T_vehicle_imu) {
  const std::vector<Turn> turns = course_turns(log.gnss);
  const TurnedAngle gyro(log.imu, T_vehicle_imu.rotation);
  std::vector<ClockOffset> tried;
  for (int k = -kSteps; k <= kSteps; ++k) tried.push_back(compare(turns, gyro, k * kStep));
  const auto best = std::ranges::max_element(tried, {}, &ClockOffset::correlation);
  if (best->correlation < kLeastCorrelation) {
    throw InputError(
        log.gnss.source +
        ": the course turns too little, or unlike the gyro, to find the clocks' offset "
        "(correlation " +
        std::to_string(best->correlation) + " over " + std::to_string(best->intervals) +
        " intervals above 2 m/s); give it with --gnss-offset");
  }
  if (best == tried.begin() || best == tried.end() - 1) {
    throw InputError(log.gnss.source +
                     ": its clock is off the IMU's by more than 2 s; give the offset with "
                     "--gnss-offset");
  }
  const double before = (best - 1)->correlation;
  const double after = (best + 1)->correlation;
  const double bend = before - 2.0 * best->correlation + after;
  const double shift = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
  return compare(turns, gyro, best->offset + duration_from_seconds(shift * to_seconds(kStep)));
}

}  // namespace locsim::scenarios
