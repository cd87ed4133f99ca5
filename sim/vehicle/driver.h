#pragma once

#include <deque>
#include <optional>

#include "core/parameters.h"
#include "core/time.h"
#include "sim/vehicle/controls.h"
#include "sim/vehicle/vehicle_spec.h"
#include "sim/world/route.h"

namespace locsim::sim {

/// Where the driver is told that the car is.
struct DriverView {
  Pose T_map_vehicle;
  double speed_m_s = 0.0;
  double yaw_rate_rad_s = 0.0;
  /// How old all this is; the driver carries it on by what it has steered since.
  Duration age{0};
};

struct DriverConfig {
  /// How far ahead the driver acts, for what the steering lags [s].
  double anticipation_s = 0.2;
  /// The curvature ahead is taken as its mean over this time, half of it before: the wheels take
  /// that long to turn [s].
  double preview_s = 0.4;
  /// An offset decays over this length of road, the longer of the two: at standstill and per
  /// speed.
  double recovery_length_m = 3.0;
  double recovery_time_s = 0.6;
  /// Share of critical damping of that decay.
  double recovery_damping = 1.0;
  /// Steering never asks for more lateral acceleration than this.
  double lateral_acceleration_max_m_s2 = 6.0;
  double acceleration_max_m_s2 = 2.5;
  double braking_max_m_s2 = 4.0;
  /// Deceleration with which the driver comes to a stop.
  double stopping_m_s2 = 1.5;
  /// Make good what is lost or gained on `RoutePoint::time_s`.
  bool keep_schedule = true;
  /// Speed changed per second of lateness, over speed; and the most.
  double schedule_gain_1_s = 0.06;
  double schedule_share_max = 0.12;

  void describe(Parameters& p);
};

/// Follows a route: steers by the curvature ahead and by offset and heading from the lane's
/// middle, keeps the route's speeds and stops. Knows nothing but what it is told.
class Driver {
 public:
  /// `route` must outlive the driver. Throws InputError where `config` is out of range.
  Driver(const DriverConfig& config, const VehicleSpec& vehicle, const Route& route);

  /// To be called every 10 ms or so, at growing `now`. The route's clock starts at the first
  /// view. Without a view (none, or one that is not finite) the car brakes to standstill and
  /// holds. The answer is always finite and within the vehicle's limits.
  [[nodiscard]] Controls control(Stamp now, const std::optional<DriverView>& view);

  /// The car has been set down at `s_m` of the route: the schedule and the stops go on from there,
  /// as late as the car was, stops passed over are not made up for, and stops ahead are made again.
  void set_down(double s_m);

  /// When the first view came.
  [[nodiscard]] std::optional<Stamp> set_off_at() const { return set_off_; }
  /// True once the car stands at the end of the route.
  [[nodiscard]] bool finished() const { return finished_; }

 private:
  // The front wheels by the driver's own reckoning, in the past half second.
  struct Steered {
    Stamp time;
    double angle_rad = 0.0;
  };
  void note_steering(Stamp now);
  [[nodiscard]] double turned_on(double angle_rad, double for_s) const;
  [[nodiscard]] double yaw_rate(double angle_rad, double speed_m_s) const;
  // The view as it is by now, and as it will be after what the driver anticipates.
  struct Outlook {
    Pose now;
    Pose ahead;
  };
  [[nodiscard]] Outlook outlook(Stamp now, const DriverView& view) const;
  // Course and curvature as means over `over_m` about s.
  [[nodiscard]] RoutePoint mean_lane(double s_m, double over_m) const;
  [[nodiscard]] double steering(const Pose& T_map_ahead, double speed_m_s) const;
  [[nodiscard]] double acceleration(Stamp now, double speed_m_s);
  /// On the route's clock.
  [[nodiscard]] double route_time_s(Stamp now) const;
  [[nodiscard]] bool waits_at_stop(Stamp now, double speed_m_s);
  [[nodiscard]] double target_speed(double time_s, double ahead_m) const;

  DriverConfig config_;
  VehicleSpec vehicle_;
  const Route* route_;
  std::deque<Steered> steered_;
  std::optional<Stamp> set_off_;
  std::optional<Stamp> halted_;
  RouteProjection place_;
  /// Set down further along the route, the car is ahead of the time since it set off.
  double clock_shift_s_ = 0.0;
  std::size_t next_stop_ = 0;
  double last_steering_rad_ = 0.0;
  bool finished_ = false;
};

}  // namespace locsim::sim
