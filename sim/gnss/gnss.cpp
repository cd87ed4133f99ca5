#include "sim/gnss/gnss.h"

#include <cmath>

#include "sim/sample_times.h"

namespace locsim::sim {

Gnss::Gnss(const GnssSpec& spec, const Vector3d& antenna_in_vehicle_m, std::uint64_t seed)
    : spec_((check_parameters(spec, "gnss"), spec)),
      antenna_in_vehicle_m_(antenna_in_vehicle_m),
      sky_(spec.elevation_mask_rad),
      position_wander_(MarkovNoise::gauss_markov(seed, "gnss/position/wander",
                                                 spec.correlation_time_s, spec.period())),
      position_white_(seed, "gnss/position/white"),
      velocity_white_(seed, "gnss/velocity/white") {}

void Gnss::sample(const Trajectory& trajectory, const SkyBlocked& is_blocked,
                  const LocalFrame& frame, Stamp from, Stamp to, std::vector<GnssFix>& out) {
  const Vector3d correlated_m(spec_.horizontal_correlated_m, spec_.horizontal_correlated_m,
                              spec_.vertical_correlated_m);
  const Vector3d white_m(spec_.horizontal_white_m, spec_.horizontal_white_m,
                         spec_.vertical_white_m);
  const Vector3d velocity_m_s(spec_.velocity_horizontal_m_s, spec_.velocity_horizontal_m_s,
                              spec_.velocity_vertical_m_s);
  const SampleTimes times{.start = trajectory.start(), .period = spec_.period()};
  for (std::int64_t k = times.first_after(from); times[k] <= to; ++k) {
    const TruthState truth = trajectory.at(times[k]);
    const Vector3d antenna_map = truth.T_map_vehicle * antenna_in_vehicle_m_;
    const SkyView view = sky_.view(antenna_map, is_blocked, times[k]);

    GnssFix& fix = out.emplace_back();
    fix.time = times[k];
    fix.satellites = static_cast<int>(std::lround(spec_.satellites_open_sky * view.visible_share));
    const bool usable =
        fix.satellites >= spec_.satellites_min && view.dilution.maxCoeff() <= spec_.dilution_max;
    fix.valid = tracks(usable, fix.time);
    if (!fix.valid) continue;

    Vector3d position_error_m = Vector3d::Zero();
    Vector3d velocity_error_m_s = Vector3d::Zero();
    if (spec_.noise) {
      const auto index = static_cast<std::uint64_t>(k);
      position_error_m =
          view.dilution.cwiseProduct(correlated_m.cwiseProduct(position_wander_.at(k)) +
                                     white_m.cwiseProduct(position_white_.gaussian3(index)));
      velocity_error_m_s =
          view.dilution.cwiseProduct(velocity_m_s.cwiseProduct(velocity_white_.gaussian3(index)));
    }
    const Vector3d lever_velocity_m_s =
        truth.T_map_vehicle.rotation * truth.angular_rate_rad_s.cross(antenna_in_vehicle_m_);
    fix.position = frame.to_geodetic(antenna_map + position_error_m);
    fix.velocity_enu_m_s = truth.velocity_m_s + lever_velocity_m_s + velocity_error_m_s;
    fix.position_covariance_m2 =
        (view.dilution.cwiseAbs2().cwiseProduct(correlated_m.cwiseAbs2() + white_m.cwiseAbs2()))
            .asDiagonal();
    fix.velocity_covariance_m2_s2 =
        view.dilution.cwiseProduct(velocity_m_s).cwiseAbs2().asDiagonal();
  }
}

bool Gnss::tracks(bool sky_is_usable, Stamp time) {
  if (!sky_is_usable) {
    tracking_ = false;
    regained_.reset();
  } else if (!tracking_) {
    if (!regained_) regained_ = time;
    tracking_ = time - *regained_ >= duration_from_seconds(spec_.reacquisition_s);
  }
  return tracking_;
}

}  // namespace locsim::sim
