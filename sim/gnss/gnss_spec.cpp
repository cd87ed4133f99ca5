#include "sim/gnss/gnss_spec.h"

#include <string>

namespace locsim::sim {

namespace {

constexpr Bounds kSigma_m{.min = 1e-4, .max = 1000.0};
constexpr Bounds kAcceleration{.min = 1e-3, .max = 100.0};

}  // namespace

void GnssErrors::describe(Parameters& p) {
  p.flag("signal_in_space", signal_in_space);
  p.flag("ionosphere", ionosphere);
  p.flag("troposphere", troposphere);
  p.flag("scene", scene);
  p.flag("thermal", thermal);
  p.flag("receiver_clock", receiver_clock);
}

void GnssSystems::describe(Parameters& p) {
  p.flag("gps", gps);
  p.flag("glonass", glonass);
  p.flag("galileo", galileo);
  p.flag("beidou", beidou);
  if (list().empty()) p.fail("gps", "is false as all others are, needs at least one system");
}

std::vector<GnssSystem> GnssSystems::list() const {
  std::vector<GnssSystem> systems;
  if (gps) systems.push_back(GnssSystem::gps);
  if (glonass) systems.push_back(GnssSystem::glonass);
  if (galileo) systems.push_back(GnssSystem::galileo);
  if (beidou) systems.push_back(GnssSystem::beidou);
  return systems;
}

void AntennaSpec::describe(Parameters& p) {
  p.number("gain_db", gain_db, {.min = -40.0, .max = 20.0});
  p.number("cross_rejection_db", cross_rejection_db, {.min = 0.0, .max = 60.0});
  p.number("below_rejection_db", below_rejection_db, {.min = 0.0, .max = 60.0});
}

void TrackingSpec::describe(Parameters& p) {
  p.number("front_end_bandwidth_hz", front_end_bandwidth_hz, {.min = 1e6, .max = 1e8});
  p.number("correlator_spacing_chips", correlator_spacing_chips, {.min = 0.02, .max = 1.0});
  p.number("coherent_s", coherent_s, {.min = 0.001, .max = 0.02});
  p.number("dll_bandwidth_hz", dll_bandwidth_hz, {.min = 0.01, .max = 10.0});
  p.number("fll_bandwidth_hz", fll_bandwidth_hz, {.min = 0.1, .max = 10.0});
  p.number("cn0_average_s", cn0_average_s, {.min = 0.05, .max = 60.0});
  p.number("tracking_threshold_db_hz", tracking_threshold_db_hz, {.min = 0.0, .max = 50.0});
  p.number("coast_s", coast_s, {.min = 0.0, .max = 60.0});
  p.number("acquisition_threshold_db_hz", acquisition_threshold_db_hz, {.min = 0.0, .max = 50.0});
  if (acquisition_threshold_db_hz < tracking_threshold_db_hz) {
    p.fail("acquisition_threshold_db_hz", "is below tracking_threshold_db_hz, needs at least that");
  }
  p.number("reacquisition_s", reacquisition_s, {.min = 0.0, .max = 120.0});
  p.number("carrier_threshold_db_hz", carrier_threshold_db_hz, {.min = 0.0, .max = 60.0});
}

void SolutionSpec::describe(Parameters& p) {
  p.degrees("elevation_mask_deg", elevation_mask_rad, {.min = 0.0, .max = 80.0});
  p.number("cn0_mask_db_hz", cn0_mask_db_hz, {.min = 0.0, .max = 50.0});
  p.number("pseudorange_floor_m", pseudorange_floor_m, kSigma_m);
  p.number("pseudorange_zenith_m", pseudorange_zenith_m, {.min = 0.0, .max = 1000.0});
  p.number("pseudorange_noise_m", pseudorange_noise_m, {.min = 0.0, .max = 1000.0});
  p.number("range_rate_noise_m_s", range_rate_noise_m_s, {.min = 0.0, .max = 1000.0});
  p.number("range_rate_floor_m_s", range_rate_floor_m_s, kSigma_m);
  p.flag("raim", raim);
  p.number("raim_false_alarm", raim_false_alarm, {.min = 1e-9, .max = 0.5});
  p.number("pdop_max", pdop_max, {.min = 1.0, .max = 1000.0});
  p.integer("satellites_min", satellites_min, {.min = 4, .max = 100});
  p.number("height_hold_s", height_hold_s, {.min = 0.0, .max = 3600.0});
  p.flag("smoothing", smoothing);
  p.number("acceleration_m_s2_sqrthz", acceleration_m_s2_sqrthz, kAcceleration);
  p.number("vertical_acceleration_m_s2_sqrthz", vertical_acceleration_m_s2_sqrthz, kAcceleration);
  p.number("gate_sigmas", gate_sigmas, {.min = 1.0, .max = 100.0});
  p.number("restart_s", restart_s, {.min = 0.0, .max = 600.0});
}

void ReceiverClockSpec::describe(Parameters& p) {
  p.number("offset_s", offset_s, {.min = 0.0, .max = 0.01});
  p.number("drift_ppm", drift_ppm, {.min = 0.0, .max = 10.0});
  // A thousand times those of a poor crystal.
  p.number("h0_s", h0_s, {.min = 0.0, .max = 1e-15});
  p.number("h_minus_2_hz", h_minus_2_hz, {.min = 0.0, .max = 1e-15});
}

void GnssSpec::describe(Parameters& p) {
  p.number("rate_hz", rate_hz, {.min = 1.0, .max = 20.0});
  p.number("latency_s", latency_s, {.min = 0.0, .max = 10.0});
  p.integer("frequencies", frequencies, {.min = 1, .max = 2});
  p.group("systems", systems);
  p.group("errors", errors);
  p.group("antenna", antenna);
  p.group("tracking", tracking);
  p.group("solution", solution);
  p.group("clock", clock);
}

}  // namespace locsim::sim
