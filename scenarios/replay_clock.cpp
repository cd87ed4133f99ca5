#include "scenarios/replay_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/geodesy.h"

namespace locsim::scenarios {

namespace {

constexpr Duration kStep{5'000'000};
constexpr Duration kLongestDelay{1'000'000'000};
constexpr double kDelayGate = 25.0;
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
    turns.push_back({a.fix.time - log.velocity_delay, b.fix.time - log.velocity_delay, angle_rad});
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

// The way from one reference fix to the next.
struct Way {
  std::size_t first = 0;
  Eigen::Vector2d moved_m = Eigen::Vector2d::Zero();
};

// What two fixes that follow each other at a usual interval are.
bool follow(const GnssLog::Entry& a, const GnssLog::Entry& b) {
  return a.reference && b.reference && to_seconds(b.fix.time - a.fix.time) <= kLongestInterval_s;
}

// Ways that have enough fixes after them for any delay, and move.
std::vector<Way> ways(const GnssLog& log) {
  const LocalFrame frame(log.entries.front().fix.position);
  std::vector<Way> found;
  for (std::size_t i = 0; i + 1 < log.entries.size(); ++i) {
    const GnssLog::Entry& a = log.entries[i];
    const GnssLog::Entry& b = log.entries[i + 1];
    if (!follow(a, b) || b.fix.velocity_enu_m_s.head<2>().norm() < kLeastSpeed_m_s) continue;
    std::size_t last = i + 1;
    while (last + 1 < log.entries.size() && follow(log.entries[last], log.entries[last + 1]) &&
           log.entries[last].fix.time < b.fix.time + kLongestDelay) {
      ++last;
    }
    if (log.entries[last].fix.time < b.fix.time + kLongestDelay) continue;
    found.push_back({i, (frame.to_map(b.fix.position) - frame.to_map(a.fix.position)).head<2>()});
  }
  return found;
}

// Sum of squares of the ways less the velocities, true `delay` before their stamps, integrated.
double unexplained_m2(const GnssLog& log, const std::vector<Way>& ways, Duration delay) {
  double sum_m2 = 0.0;
  for (const Way& way : ways) {
    const Stamp from = log.entries[way.first].fix.time + delay;
    const Stamp until = log.entries[way.first + 1].fix.time + delay;
    Eigen::Vector2d left_m = way.moved_m;
    for (std::size_t i = way.first; log.entries[i].fix.time < until; ++i) {
      const GnssFix& a = log.entries[i].fix;
      const GnssFix& b = log.entries[i + 1].fix;
      const Stamp begin = std::max(from, a.time);
      const Stamp end = std::min(until, b.time);
      if (end <= begin) continue;
      // A straight line is its value at the middle.
      const double share = 0.5 * (to_seconds(begin - a.time) + to_seconds(end - a.time)) /
                           to_seconds(b.time - a.time);
      left_m -= to_seconds(end - begin) *
                ((1.0 - share) * a.velocity_enu_m_s + share * b.velocity_enu_m_s).head<2>();
    }
    sum_m2 += left_m.squaredNorm();
  }
  return sum_m2;
}

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

VelocityDelay estimate_velocity_delay(const GnssLog& log) {
  VelocityDelay result;
  if (log.entries.empty()) return result;
  const std::vector<Way> compared = ways(log);
  result.intervals = compared.size();
  if (compared.size() < kFewestIntervals) return result;
  std::vector<double> sums_m2;
  for (Duration delay{0}; delay <= kLongestDelay; delay += kStep) {
    sums_m2.push_back(unexplained_m2(log, compared, delay));
  }
  // Two axes each.
  const auto n = 2.0 * static_cast<double>(compared.size());
  const auto best = std::ranges::min_element(sums_m2);
  result.rms_without_m = std::sqrt(sums_m2.front() / n);
  result.rms_m = result.rms_without_m;
  const bool inside = best != sums_m2.begin() && best != sums_m2.end() - 1;
  if (!inside || n * (sums_m2.front() - *best) < kDelayGate * *best) return result;
  const double bend = *(best - 1) - 2.0 * *best + *(best + 1);
  const double shift = bend > 0.0 ? 0.5 * (*(best - 1) - *(best + 1)) / bend : 0.0;
  result.delay =
      (best - sums_m2.begin()) * kStep + duration_from_seconds(shift * to_seconds(kStep));
  result.rms_m = std::sqrt(unexplained_m2(log, compared, result.delay) / n);
  return result;
}

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
