#include "benchmarks/fidelity/gnss_drive.h"

#include <algorithm>
#include <cmath>

#include "sim/faults/faults.h"
#include "sim/gnss/gnss.h"

namespace locsim::fidelity {

namespace {

constexpr Duration kStep{10'000'000};

/// Where a car by the route's speeds is at rising times.
class Schedule {
 public:
  explicit Schedule(const sim::Route& route) : points_(route.points()) {}

  double s_at(double time_s) {
    while (i_ + 2 < points_.size() && points_[i_ + 1].time_s <= time_s) ++i_;
    const sim::RoutePoint& a = points_[i_];
    const sim::RoutePoint& b = points_[i_ + 1];
    const double length_m = b.s_m - a.s_m;
    const double speeds_m_s = a.speed_m_s + b.speed_m_s;
    if (speeds_m_s <= 0.0) {
      return a.s_m + length_m * std::clamp((time_s - a.time_s) / (b.time_s - a.time_s), 0.0, 1.0);
    }
    // What is left of the time from point to point is a stop at the first.
    const double needed_s = 2.0 * length_m / speeds_m_s;
    const double under_way_s = std::clamp(time_s - (b.time_s - needed_s), 0.0, needed_s);
    const double acceleration_m_s2 = (b.speed_m_s - a.speed_m_s) / needed_s;
    return a.s_m + a.speed_m_s * under_way_s + 0.5 * acceleration_m_s2 * under_way_s * under_way_s;
  }

 private:
  const std::vector<sim::RoutePoint>& points_;
  std::size_t i_ = 0;
};

std::vector<SatelliteRecord> satellites_of(const std::vector<sim::SignalTruth>& truth) {
  std::vector<SatelliteRecord> records;
  for (const sim::SignalTruth& t : truth) {
    const auto strongest = std::ranges::max_element(t.paths, {}, &sim::SignalPath::power_db);
    records.push_back({.id = t.sight.id,
                       .elevation_rad = t.sight.elevation_rad(),
                       .is_direct = std::ranges::any_of(t.paths,
                                                        [](const sim::SignalPath& path) {
                                                          return path.kind == sim::PathKind::direct;
                                                        }),
                       .paths = t.paths.size(),
                       .turns = t.paths.empty() ? 0 : strongest->turns,
                       .excess_m = t.paths.empty() ? 0.0 : strongest->excess_m,
                       .power_db = t.paths.empty() ? -100.0 : strongest->power_db(),
                       .is_tracked = t.tracked,
                       .code_error_m = t.code_error_m,
                       .range_rate_error_m_s = t.range_rate_error_m_s,
                       .cn0_db_hz = t.cn0_db_hz});
  }
  return records;
}

}  // namespace

sim::Trajectory drive_route(const sim::Route& route, Stamp start) {
  sim::Trajectory trajectory(start, kStep);
  Schedule schedule(route);
  // The curve's last tangent needs the pose after it.
  const auto steps = duration_from_seconds(route.duration_s()) / kStep + 3;
  for (std::int64_t i = 0; i < steps; ++i) {
    trajectory.push(route.pose(schedule.s_at(to_seconds(i * kStep))));
  }
  return trajectory;
}

GnssDrive drive_gnss(const scenarios::Scenario& scenario, const scenarios::Stage& stage,
                     const sim::RayScene& scene, const sim::Trajectory& trajectory,
                     std::uint64_t seed, Duration later) {
  const LocalFrame frame(stage.world.origin);
  const scenarios::GnssSetup& setup = scenario.sensors.gnss;
  const Vector3d antenna_m = setup.mount.position_m;
  sim::Gnss gnss(setup.spec, antenna_m, stage.world, scene, frame, scenario.gps_start() + later,
                 seed, sim::Faults(scenario.faults));
  GnssDrive drive{.period = setup.spec.period(), .epochs = {}};
  std::vector<sim::GnssOutput> outputs;
  double s_m = 0.0;
  for (Stamp time = trajectory.start() + drive.period; time <= trajectory.end();
       time += drive.period) {
    outputs.clear();
    gnss.sample(trajectory, time - drive.period, time, outputs);
    const sim::TruthState truth = trajectory.at(time);
    const Vector3d position_m = truth.T_map_vehicle * antenna_m;
    const Vector3d velocity_m_s =
        truth.velocity_m_s +
        truth.T_map_vehicle.rotation * truth.angular_rate_rad_s.cross(antenna_m);
    s_m = stage.route.project(truth.T_map_vehicle.translation, s_m).s_m;
    EpochRecord epoch{.time = time,
                      .s_m = s_m,
                      .speed_m_s = truth.velocity_m_s.norm(),
                      .satellites = satellites_of(gnss.last_truth()),
                      .fix = {}};
    for (const sim::GnssOutput& output : outputs) {
      const GnssFix& fix = output.fix;
      if (!fix.valid || fix.time != time) continue;
      epoch.fix = {.error_m = frame.to_map(fix.position) - position_m,
                   .velocity_error_m_s = fix.velocity_enu_m_s - velocity_m_s,
                   .covariance_m2 = fix.position_covariance_m2};
    }
    drive.epochs.push_back(std::move(epoch));
  }
  return drive;
}

}  // namespace locsim::fidelity
