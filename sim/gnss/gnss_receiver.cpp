#include "sim/gnss/gnss_receiver.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/physics.h"
#include "sim/gnss/antenna.h"
#include "sim/gnss/fresnel.h"

namespace locsim::sim {

namespace {

constexpr double kBeidouCarrier_hz = 1561.098e6;
constexpr double kGlonassCarrier_hz = 1602e6;
constexpr double kGlonassStep_hz = 0.5625e6;

/// Of signal before the first epoch. Code loops average all they have heard until that is as long
/// as their memory of 1/(4·B), 1.3 s at 0.2 Hz and 2.5 s at 0.1 Hz: after 3 s their variance is
/// 1.07 and 1.7 times that of the steady loop, which the next seconds take away.
constexpr double kWarmUp_s = 3.0;

/// Delays of hardware that differ between systems [m], about 15 ns, and what two frequencies leave
/// of the ionosphere: codes' differences smoothed by the carrier over minutes.
constexpr double kSystemDelay_m = 5.0;
constexpr double kTwoFrequencySigma_m = 0.35;
constexpr Duration kTwoFrequencyTime = std::chrono::seconds(100);
/// What a receiver takes Klobuchar's model to leave, as a share of it: IS-GPS-200 promises that it
/// takes off half at least, and receivers cannot know better (RTKLIB's ERR_BRDCI is the same, as
/// remembered). The simulated ionosphere differs by 0.4: they are somewhat too careful.
constexpr double kModelSigma = 0.5;

}  // namespace

double carrier_hz(SatelliteId id) {
  switch (id.system) {
    case GnssSystem::glonass:
      return kGlonassCarrier_hz + kGlonassStep_hz * glonass_channel(id.number);
    case GnssSystem::beidou:
      return kBeidouCarrier_hz;
    case GnssSystem::gps:
    case GnssSystem::galileo:
      break;
  }
  return kL1Carrier_hz;
}

GnssReceiver::GnssReceiver(const GnssSpec& spec, const Vector3d& antenna_in_vehicle_m,
                           const World& world, const RayScene& scene, const LocalFrame& frame,
                           GpsTime start, std::uint64_t seed, const Faults& faults)
    : spec_(spec),
      antenna_in_vehicle_m_(antenna_in_vehicle_m),
      frame_(frame),
      start_(start),
      seed_(seed),
      constellation_(spec.systems.list()),
      signal_in_space_(constellation_, spec.errors.signal_in_space, seed),
      ionosphere_(spec.errors.ionosphere, seed),
      troposphere_(spec.errors.troposphere, seed),
      paths_(world, scene),
      interference_(faults),
      clock_(spec.clock, spec.errors.receiver_clock, spec.period(), seed),
      two_frequencies_(seed, "gnss/two_frequencies", kTwoFrequencyTime),
      delays_(seed, "gnss/system_delays"),
      ambiguities_(seed, "gnss/ambiguities") {}

AntennaState GnssReceiver::antenna(const Trajectory& trajectory, Stamp time) const {
  const TruthState truth = trajectory.at(time);
  return {.position_map_m = truth.T_map_vehicle * antenna_in_vehicle_m_,
          .velocity_map_m_s =
              truth.velocity_m_s +
              truth.T_map_vehicle.rotation * truth.angular_rate_rad_s.cross(antenna_in_vehicle_m_)};
}

void GnssReceiver::look_around(const AntennaState& antenna, Stamp time) {
  const std::vector<SatelliteSight> sights =
      constellation_.in_view(frame_, antenna.position_map_m, start_ + time.time_since_epoch(), 0.0);
  std::vector<Vector3d> directions;
  for (const SatelliteSight& sight : sights) directions.push_back(sight.direction);
  std::vector<std::vector<SignalPath>> found(sights.size());
  if (spec_.errors.scene) {
    found = paths_.find(antenna.position_map_m, directions, time);
  } else {
    for (std::size_t i = 0; i < sights.size(); ++i) found[i] = {{.arrival = directions[i]}};
  }
  truth_.clear();
  arrivals_.resize(sights.size());
  for (std::size_t i = 0; i < sights.size(); ++i) {
    arrivals_[i].clear();
    for (const SignalPath& path : found[i]) {
      arrivals_[i].push_back({.excess_m = path.excess_m,
                              .bent = directions[i] - path.arrival,
                              .surface_velocity_m_s = path.surface_velocity_m_s,
                              .field = received(path, spec_.antenna)});
    }
    truth_.push_back({.sight = sights[i], .paths = std::move(found[i])});
  }
}

GnssReceiver::Channel& GnssReceiver::channel(SatelliteId id) {
  const auto found = channels_.find(id);
  if (found != channels_.end()) return found->second;
  const double frequency_hz = carrier_hz(id);
  const double wavelength_m = kSpeedOfLight_m_s / frequency_hz;
  return channels_
      .try_emplace(id,
                   Channel{.tracking = TrackingChannel(spec_.tracking, spec_.errors.thermal, id,
                                                       wavelength_m, seed_),
                           .carrier_hz = frequency_hz,
                           .wavelength_m = wavelength_m,
                           .zenith_amplitude = std::sqrt(zenith_cn0_hz(spec_.antenna, id.system))})
      .first->second;
}

std::vector<GnssReceiver::Channel*> GnssReceiver::channels_of_truth() {
  std::vector<Channel*> channels;
  channels.reserve(truth_.size());
  for (const SignalTruth& signal : truth_) channels.push_back(&channel(signal.sight.id));
  return channels;
}

GnssReceiver::Moment GnssReceiver::moment(const AntennaState& antenna, Stamp time) const {
  return {.time = time,
          .antenna = antenna,
          .cable_amplitude = std::pow(10.0, -interference_.attenuation_db(time) / 20.0),
          .is_outage = interference_.is_outage(time)};
}

void GnssReceiver::components_of(std::size_t signal, const Channel& channel,
                                 const AntennaState& at_epoch, Stamp epoch, const Moment& now,
                                 std::vector<SignalComponent>& out) const {
  out.clear();
  const SatelliteSight& sight = truth_[signal].sight;
  const double zenith = channel.zenith_amplitude * now.cable_amplitude;
  const auto turned = [&](std::complex<double> amplitude, double excess_m) {
    return amplitude * std::polar(1.0, -2.0 * std::numbers::pi * excess_m / channel.wavelength_m);
  };
  if (!now.is_outage) {
    const Vector3d moved_m = now.antenna.position_map_m - at_epoch.position_map_m;
    const double after_s = to_seconds(now.time - epoch);
    for (const Arrival& one : arrivals_[signal]) {
      const double excess_m =
          one.excess_m + one.bent.dot(moved_m - after_s * one.surface_velocity_m_s);
      out.push_back(
          {.excess_m = excess_m,
           .excess_rate_m_s = one.bent.dot(now.antenna.velocity_map_m_s - one.surface_velocity_m_s),
           .amplitude = turned(zenith * one.field, excess_m)});
    }
  }
  if (const auto spoofed = interference_.spoofed(sight.direction, now.time)) {
    const double level = std::pow(10.0, spoofed->advantage_db / 20.0);
    const double open = std::abs(received({.arrival = sight.direction}, spec_.antenna));
    out.push_back({.excess_m = spoofed->excess_m,
                   .excess_rate_m_s = spoofed->excess_rate_m_s,
                   .amplitude = turned(zenith * open * level, spoofed->excess_m)});
  }
}

void GnssReceiver::warm_up(const Trajectory& trajectory, Stamp start) {
  AntennaState standing = antenna(trajectory, start);
  standing.velocity_map_m_s.setZero();
  look_around(standing, start);
  // Faults begin with the drive at the earliest.
  const Stamp before = start - Duration{1};
  const auto count = static_cast<std::int64_t>(std::ceil(kWarmUp_s / spec_.tracking.coherent_s));
  const Moment moment_before = moment(standing, before);
  std::vector<SignalComponent> components;
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    Channel& tracker = channel(truth_[i].sight.id);
    components_of(i, tracker, standing, before, moment_before, components);
    tracker.tracking.start(components);
    for (std::int64_t k = 0; k < count; ++k) tracker.tracking.integrate(components, k);
  }
  integrations_ = count;
  next_integration_ = start;
}

void GnssReceiver::track(const Trajectory& trajectory, Stamp epoch) {
  const Duration step = duration_from_seconds(spec_.tracking.coherent_s);
  const AntennaState at_epoch = antenna(trajectory, epoch);
  std::vector<SignalComponent> components;
  for (auto& [id, tracker] : channels_) tracker.has_set = true;
  const std::vector<Channel*> in_view = channels_of_truth();
  for (Channel* tracker : in_view) tracker->has_set = false;
  const double signal_cn0_hz = zenith_cn0_hz(spec_.antenna, GnssSystem::gps);
  for (; next_integration_ + step <= epoch; next_integration_ += step, ++integrations_) {
    const Stamp middle = next_integration_ + step / 2;
    const Moment now = moment(antenna(trajectory, middle), middle);
    const double noise_db = interference_.noise_density_db(middle, signal_cn0_hz);
    for (std::size_t i = 0; i < in_view.size(); ++i) {
      components_of(i, *in_view[i], at_epoch, epoch, now, components);
      in_view[i]->tracking.integrate(components, integrations_, noise_db);
    }
    for (auto& [id, tracker] : channels_) {
      if (tracker.has_set && tracker.tracking.is_tracking()) {
        tracker.tracking.integrate({}, integrations_, noise_db);
      }
    }
  }
}

GnssEpoch GnssReceiver::measure(const Trajectory& trajectory, const SampleTimes& times,
                                std::int64_t k, const std::optional<GeodeticPoint>& last_fix) {
  if (integrations_ == 0) warm_up(trajectory, times.start);
  const Stamp time = times[k];
  const AntennaState state = antenna(trajectory, time);
  const Place place{.geodetic = frame_.to_geodetic(state.position_map_m),
                    .ecef_m = frame_.to_ecef(state.position_map_m)};
  look_around(state, time);
  track(trajectory, time);

  const ReceiverClock::State clock = clock_.at(k);
  clock_offset_m_ = clock.offset_m + kSpeedOfLight_m_s * interference_.clock_jump_s(time);
  clock_drift_m_s_ = clock.drift_m_s;
  GnssEpoch epoch{
      .time = time,
      .receiver_time = time + duration_from_seconds(clock_offset_m_ / kSpeedOfLight_m_s)};
  for (SignalTruth& signal : truth_) {
    Channel& tracker = channel(signal.sight.id);
    const auto measured = tracker.tracking.measure();
    if (!measured) continue;
    epoch.observations.push_back(observe(signal, tracker, *measured, state, place, time, last_fix));
  }
  return epoch;
}

GnssObservation GnssReceiver::observe(SignalTruth& signal, Channel& channel,
                                      const TrackingChannel::Measurement& measured,
                                      const AntennaState& antenna, const Place& place, Stamp time,
                                      const std::optional<GeodeticPoint>& last_fix) const {
  signal.tracked = true;
  signal.code_error_m = measured.code_error_m;
  signal.range_rate_error_m_s = measured.range_rate_error_m_s;
  signal.cn0_db_hz = measured.cn0_db_hz;

  const SatelliteSight& sight = signal.sight;
  const GpsTime received_at = start_ + time.time_since_epoch();
  const GpsTime sent_at = received_at - duration_from_seconds(sight.range_m / kSpeedOfLight_m_s);
  const BroadcastMessage message = signal_in_space_.broadcast(sight.id, received_at);
  const SatelliteState told = evaluate(message.orbit, sent_at);
  const SatelliteClock clock = broadcast_clock(message, sent_at);
  const double scale = std::pow(kL1Carrier_hz / channel.carrier_hz, 2);
  const double ionosphere_m =
      ionosphere_.delay_m(place.geodetic, sight.azimuth_rad(), sight.elevation_rad(), received_at) *
      scale;
  const double troposphere_m =
      troposphere_.delay_m(place.geodetic, sight.elevation_rad(), received_at);
  const double signal_error_m = signal_in_space_.range_error_m(
      sight.sent, (place.ecef_m - sight.sent.position_ecef_m).normalized(), sent_at);
  const double common_m = sight.range_m + clock_offset_m_ - clock.offset_m + signal_error_m +
                          troposphere_m + system_delay_m(sight.id.system);

  GnssObservation observation{.satellite = sight.id,
                              .pseudorange_m = common_m + ionosphere_m + measured.code_error_m,
                              .carrier_hz = channel.carrier_hz,
                              .cn0_db_hz = measured.cn0_db_hz,
                              .carrier_locked = measured.carrier_locked,
                              .slipped = measured.slipped,
                              .lock_s = measured.lock_s,
                              .satellite_ecef_m = told.position_ecef_m,
                              .satellite_velocity_ecef_m_s = told.velocity_ecef_m_s,
                              .satellite_clock_m = clock.offset_m,
                              .satellite_clock_drift_m_s = clock.drift_m_s};
  const double range_rate_m_s = sight.range_rate_m_s -
                                sight.direction.dot(antenna.velocity_map_m_s) + clock_drift_m_s_ -
                                clock.drift_m_s + measured.range_rate_error_m_s;
  observation.doppler_hz = -range_rate_m_s / channel.wavelength_m;
  if (measured.slipped || channel.ambiguity_cycles == 0.0) {
    constexpr double kMost_cycles = 1e6;
    channel.ambiguity_cycles =
        std::floor(ambiguities_.uniform(1.0, kMost_cycles, channel.counts++, lane_of(sight.id)));
  }
  if (measured.carrier_locked) {
    observation.carrier_cycles =
        (common_m - ionosphere_m + measured.carrier_error_m) / channel.wavelength_m +
        channel.ambiguity_cycles;
  }
  set_ionosphere(observation, sight, ionosphere_m, scale, received_at, last_fix);
  return observation;
}

double GnssReceiver::system_delay_m(GnssSystem system) const {
  if (!spec_.errors.receiver_clock || system == GnssSystem::gps) return 0.0;
  return kSystemDelay_m * delays_.gaussian(static_cast<std::uint64_t>(system));
}

void GnssReceiver::set_ionosphere(GnssObservation& observation, const SatelliteSight& sight,
                                  double delay_m, double scale, GpsTime time,
                                  const std::optional<GeodeticPoint>& last_fix) const {
  if (spec_.frequencies == 2) {
    observation.ionosphere_m = delay_m;
    if (!spec_.errors.ionosphere) return;
    observation.ionosphere_sigma_m = kTwoFrequencySigma_m;
    observation.ionosphere_m += kTwoFrequencySigma_m * two_frequencies_.at(time, lane_of(sight.id));
    return;
  }
  if (!last_fix) return;
  observation.ionosphere_m = scale * ionosphere_.broadcast().delay_m(*last_fix, sight.azimuth_rad(),
                                                                     sight.elevation_rad(), time);
  if (spec_.errors.ionosphere) {
    observation.ionosphere_sigma_m = kModelSigma * observation.ionosphere_m;
  }
}

}  // namespace locsim::sim
