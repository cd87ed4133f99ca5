#include "sim/vehicle/driver.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/physics.h"

namespace locsim::sim {

namespace {

constexpr double kHold_m_s2 = -3.0;
constexpr double kStanding_m_s = 0.05;
// The car halts this far before the place, give or take what it rolls.
constexpr double kHaltBefore_m = 0.1;
constexpr double kHaltWithin_m = 0.6;
constexpr double kSpeedGain_1_s = 1.2;
constexpr double kLateEnough_m = 0.05;
constexpr double kCarriedAtMost_s = 0.5;
constexpr double kExcessYawRate_rad_s = 0.2;
constexpr int kOutlookSteps = 8;
constexpr double kOffRoute_m = 15.0;
// A profile that touches zero must not stop the car for good.
constexpr double kCreep_m_s = 0.5;

bool is_usable(const DriverView& view) {
  return view.T_map_vehicle.is_finite() && std::isfinite(view.speed_m_s) &&
         std::isfinite(view.yaw_rate_rad_s) &&
         std::abs(view.T_map_vehicle.rotation.norm() - 1.0) < 0.01;
}

}  // namespace

void DriverConfig::describe(Parameters& p) {
  p.number("anticipation_s", anticipation_s, {0.0, 1.0});
  p.number("preview_s", preview_s, {0.0, 2.0});
  p.number("recovery_length_m", recovery_length_m, {0.5, 50.0});
  p.number("recovery_time_s", recovery_time_s, {0.05, 5.0});
  p.number("recovery_damping", recovery_damping, {0.2, 3.0});
  p.number("lateral_acceleration_max_m_s2", lateral_acceleration_max_m_s2, {0.5, 12.0});
  p.number("acceleration_max_m_s2", acceleration_max_m_s2, {0.2, 8.0});
  p.number("braking_max_m_s2", braking_max_m_s2, {0.5, 10.0});
  p.number("stopping_m_s2", stopping_m_s2, {0.2, 6.0});
  p.flag("keep_schedule", keep_schedule);
  p.number("schedule_gain_1_s", schedule_gain_1_s, {0.0, 1.0});
  p.number("schedule_share_max", schedule_share_max, {0.0, 0.5});
}

Driver::Driver(const DriverConfig& config, const VehicleSpec& vehicle, const Route& route)
    : config_(config), vehicle_(vehicle), route_(&route) {
  check_parameters(config, "driver");
}

Controls Driver::control(Stamp now, const std::optional<DriverView>& told) {
  note_steering(now);
  if (!told || !is_usable(*told)) {
    return {.steering_rad = last_steering_rad_, .acceleration_m_s2 = kHold_m_s2};
  }
  if (!set_off_) set_off_ = now;
  const Outlook look = outlook(now, *told);
  place_ = route_->project(look.now.translation, place_.s_m);
  if (std::abs(place_.lateral_m) > kOffRoute_m) {
    const RouteProjection anywhere = route_->project(look.now.translation);
    // Lost the thread, as after a jump of the view: take it up where the car is said to be, but
    // never before what has been driven.
    if (std::abs(anywhere.lateral_m) < 0.5 * kOffRoute_m && anywhere.s_m > place_.s_m) {
      place_ = anywhere;
    }
  }
  last_steering_rad_ = steering(look.ahead, told->speed_m_s);
  return {.steering_rad = last_steering_rad_,
          .acceleration_m_s2 = acceleration(now, told->speed_m_s)};
}

void Driver::set_down(double s_m) {
  clock_shift_s_ += route_->at(s_m).time_s - route_->at(place_.s_m).time_s;
  place_.s_m = s_m;
  halted_.reset();
  const auto& stops = route_->stops();
  next_stop_ = static_cast<std::size_t>(std::ranges::upper_bound(stops, s_m, {}, &RouteStop::s_m) -
                                        stops.begin());
}

double Driver::route_time_s(Stamp now) const {
  return to_seconds(now - *set_off_) + clock_shift_s_;
}

double Driver::turned_on(double angle_rad, double for_s) const {
  const double rate_rad_s =
      std::clamp((last_steering_rad_ - angle_rad) / std::max(for_s, vehicle_.steering_lag_s),
                 -vehicle_.steering_rate_max_rad_s, vehicle_.steering_rate_max_rad_s);
  return angle_rad + rate_rad_s * for_s;
}

double Driver::yaw_rate(double angle_rad, double speed_m_s) const {
  return speed_m_s * angle_rad /
         (vehicle_.wheelbase_m + vehicle_.understeer_rad_s2_m() * speed_m_s * speed_m_s);
}

void Driver::note_steering(Stamp now) {
  if (steered_.empty()) {
    steered_.push_back({now, 0.0});
    return;
  }
  const double since_s = std::clamp(to_seconds(now - steered_.back().time), 0.0, kCarriedAtMost_s);
  steered_.push_back({now, turned_on(steered_.back().angle_rad, since_s)});
  while (to_seconds(now - steered_.front().time) > kCarriedAtMost_s) steered_.pop_front();
}

Driver::Outlook Driver::outlook(Stamp now, const DriverView& view) const {
  Outlook look{.now = view.T_map_vehicle, .ahead = view.T_map_vehicle};
  const double age_s = std::clamp(to_seconds(view.age), 0.0, kCarriedAtMost_s);
  const Stamp taken = now - duration_from_seconds(age_s);
  // What the car turned beyond what the steering explains, it goes on turning.
  const auto then = std::ranges::lower_bound(steered_, taken, {}, &Steered::time);
  const double angle_then_rad = then == steered_.end() ? 0.0 : then->angle_rad;
  const double excess_rad_s =
      std::clamp(view.yaw_rate_rad_s - yaw_rate(angle_then_rad, view.speed_m_s),
                 -kExcessYawRate_rad_s, kExcessYawRate_rad_s);
  const auto advance = [&](Pose& pose, double angle_rad, double for_s) {
    const double turn_rad = (yaw_rate(angle_rad, view.speed_m_s) + excess_rad_s) * for_s;
    pose = pose *
           Pose{.rotation = rotation_from_rpy(0.0, 0.0, turn_rad),
                .translation = view.speed_m_s * for_s *
                               Vector3d(std::cos(0.5 * turn_rad), std::sin(0.5 * turn_rad), 0.0)};
  };
  Stamp at = taken;
  for (const Steered& steered : steered_) {
    if (steered.time <= at) continue;
    advance(look.now, steered.angle_rad, to_seconds(steered.time - at));
    at = steered.time;
  }
  look.ahead = look.now;
  double angle_rad = steered_.back().angle_rad;
  for (int i = 0; i < kOutlookSteps; ++i) {
    const double step_s = config_.anticipation_s / kOutlookSteps;
    angle_rad = turned_on(angle_rad, step_s);
    advance(look.ahead, angle_rad, step_s);
  }
  return look;
}

RoutePoint Driver::mean_lane(double s_m, double over_m) const {
  constexpr int kSamples = 8;
  RoutePoint mean;
  for (int i = 0; i < kSamples; ++i) {
    const RoutePoint p = route_->at(s_m + over_m * ((i + 0.5) / kSamples - 0.5));
    mean.yaw_rad += p.yaw_rad / kSamples;
    mean.curvature_1_m += p.curvature_1_m / kSamples;
  }
  return mean;
}

double Driver::steering(const Pose& T_map_ahead, double speed) const {
  const RouteProjection place = route_->project(T_map_ahead.translation, place_.s_m);
  const double speed_m_s = std::max(0.0, speed);
  const RoutePoint lane = mean_lane(place.s_m, speed_m_s * config_.preview_s);
  const double length_m = std::max(config_.recovery_length_m, config_.recovery_time_s * speed_m_s);
  // The rear axle drifts outwards by its slip angle, so the car points inwards by as much.
  const double slip_rad =
      vehicle_.rear_slip_rad_s2_m() * speed_m_s * speed_m_s * lane.curvature_1_m;
  const double heading_rad = wrap_angle(T_map_ahead.yaw() - lane.yaw_rad - slip_rad);
  // e'' + 2ζ/ℓ·e' + e/ℓ² = 0 over the road's length, with the angle of approach kept below 40°.
  const double damping = 2.0 * config_.recovery_damping;
  const double approach_rad = std::clamp(place.lateral_m / (damping * length_m), -0.7, 0.7);
  const double curvature_1_m =
      lane.curvature_1_m - damping / length_m * (heading_rad + approach_rad);
  const double most_1_m =
      config_.lateral_acceleration_max_m_s2 / std::max(1.0, speed_m_s * speed_m_s);
  const double wanted_1_m = std::clamp(curvature_1_m, -most_1_m, most_1_m);
  return std::clamp(std::atan(vehicle_.wheelbase_m * wanted_1_m) +
                        vehicle_.understeer_rad_s2_m() * speed_m_s * speed_m_s * wanted_1_m,
                    -vehicle_.steering_max_rad, vehicle_.steering_max_rad);
}

bool Driver::waits_at_stop(Stamp now, double speed_m_s) {
  const auto& stops = route_->stops();
  const bool is_last = next_stop_ >= stops.size();
  const double stop_m = is_last ? route_->points().back().s_m : stops[next_stop_].s_m;
  if (stop_m - place_.s_m > kHaltWithin_m) return false;
  if (speed_m_s < kStanding_m_s && !halted_) halted_ = now;
  // Creep up the last bit only while rolling.
  if (!halted_) return stop_m - place_.s_m < kHaltBefore_m;
  if (is_last) {
    finished_ = true;
    return true;
  }
  const bool is_served = to_seconds(now - *halted_) >= stops[next_stop_].dwell_s;
  const double time_s = route_time_s(now);
  const bool is_early = config_.keep_schedule && time_s < route_->duration_s() &&
                        route_->s_at_time(time_s) < stop_m + kLateEnough_m;
  if (!is_served || is_early) return true;
  halted_.reset();
  ++next_stop_;
  return false;
}

double Driver::target_speed(double time_s, double ahead_m) const {
  const double s_m = place_.s_m + ahead_m;
  double target_m_s = std::max(kCreep_m_s, route_->at(s_m).speed_m_s);
  if (config_.keep_schedule) {
    const double late_s = time_s - route_->at(place_.s_m).time_s;
    target_m_s *= 1.0 + std::clamp(config_.schedule_gain_1_s * late_s, -config_.schedule_share_max,
                                   config_.schedule_share_max);
  }
  const auto& stops = route_->stops();
  const double stop_m =
      next_stop_ < stops.size() ? stops[next_stop_].s_m : route_->points().back().s_m;
  const double left_m = std::max(0.0, stop_m - kHaltBefore_m - s_m);
  return std::min(target_m_s, std::sqrt(2.0 * config_.stopping_m_s2 * left_m));
}

double Driver::acceleration(Stamp now, double speed_m_s) {
  if (finished_ || waits_at_stop(now, speed_m_s)) return kHold_m_s2;
  const double time_s = route_time_s(now);
  // The drive lags: aim at what the profile wants once it answers.
  const double lag_m = std::max(0.3, speed_m_s * vehicle_.acceleration_lag_s);
  const double target_m_s = target_speed(time_s, lag_m);
  const double further_m_s = target_speed(time_s, lag_m + 1.0);
  const double profile_m_s2 = 0.5 * (further_m_s * further_m_s - target_m_s * target_m_s);
  const double slope_rad = rpy_from_rotation(route_->pose(place_.s_m).rotation).y();
  const double resistance_m_s2 = vehicle_.front_tyre.rolling_resistance * kGravity_m_s2 -
                                 kGravity_m_s2 * std::sin(slope_rad) +
                                 vehicle_.drag_n_s2_m2 * speed_m_s * speed_m_s / vehicle_.mass_kg;
  return std::clamp(std::clamp(profile_m_s2, -config_.stopping_m_s2 * 1.5, 2.0) +
                        kSpeedGain_1_s * (target_m_s - speed_m_s) + resistance_m_s2,
                    -config_.braking_max_m_s2, config_.acceleration_max_m_s2);
}

}  // namespace locsim::sim
