#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/messages.h"
#include "core/physics.h"
#include "sim/gnss/constellation.h"
#include "sim/gnss/ionosphere.h"
#include "sim/gnss/signal_in_space.h"
#include "sim/gnss/troposphere.h"

namespace locsim::scenarios::testing_gnss {

inline constexpr double kDegree = std::numbers::pi / 180.0;
inline const sim::KlobucharModel kKlobuchar{.alpha = {1.1176e-08, 2.2352e-08, -5.9605e-08, 0.0},
                                            .beta = {1.1674e+05, 1.6384e+05, -6.5536e+04, 0.0}};

struct Motion {
  Vector3d position_map_m = Vector3d::Zero();
  Vector3d velocity_map_m_s = Vector3d::Zero();
};
using Path = std::function<Motion(double)>;

inline Motion at_rest(double) {
  return {{120.0, -340.0, 25.0}, Vector3d::Zero()};
}
/// 14 m/s around a circle of 100 m, climbing.
inline Motion driving(double t) {
  const double angle = 0.14 * t;
  return {{100.0 * std::cos(angle), 100.0 * std::sin(angle), 2.0 + 0.5 * t},
          {-14.0 * std::sin(angle), 14.0 * std::cos(angle), 0.5}};
}

/// What a perfect receiver measures for a minute, once a second; only its clock and those of the
/// satellites are off, and, if wanted, air is in the way.
struct Sky {
  std::vector<GnssSystem> systems{GnssSystem::gps, GnssSystem::glonass, GnssSystem::galileo,
                                  GnssSystem::beidou};
  sim::GpsTime start = sim::GpsTime::from_utc("2026-06-01T04:00:00Z");
  LocalFrame frame{{22.3 * kDegree, 114.17 * kDegree, 5.0}};
  Path path = at_rest;
  double clock_s = 1e-4;
  double clock_drift = 3e-7;
  bool air = false;
  /// Dates epochs by true time instead of by the receiver's clock.
  bool dated_by_true_time = false;
};

struct Recording {
  std::vector<GnssEpoch> epochs;
  std::vector<sim::BroadcastMessage> messages;
};

/// GPS L1, GLONASS L1 by slot, Galileo E1, BeiDou B1I.
inline double carrier_hz(const SatelliteId& satellite) {
  switch (satellite.system) {
    case GnssSystem::glonass:
      return 1602e6 + 562.5e3 * sim::glonass_channel(satellite.number);
    case GnssSystem::beidou:
      return 1561.098e6;
    case GnssSystem::gps:
    case GnssSystem::galileo:
      break;
  }
  return 1575.42e6;
}

inline const sim::GpsTime kClockEpoch = sim::GpsTime::from_utc("2026-06-01T00:00:00Z");
/// Clocks off by up to 0.2 ms, differently from satellite to satellite, so that a wrong sign or the
/// message of another satellite is off by kilometres.
inline sim::BroadcastMessage message_in_force(const sim::SignalInSpace& signals,
                                              const SatelliteId& satellite, sim::GpsTime time) {
  sim::BroadcastMessage message = signals.broadcast(satellite, time);
  message.af1_s_s = 2e-12 * (satellite.number % 5 - 2);
  message.af0_s = 1e-5 * (satellite.number % 37 - 17) +
                  message.af1_s_s * to_seconds(message.toe() - kClockEpoch);
  message.af2_s_s2 = 0.0;
  return message;
}

inline GnssObservation observe(const Sky& sky, const sim::SatelliteSight& sight,
                               const sim::BroadcastMessage& message, const Motion& antenna,
                               sim::GpsTime time, double clock_s) {
  const double frequency_hz = carrier_hz(sight.id);
  const double since_toe_s = to_seconds(time - message.toe()) - sight.range_m / kSpeedOfLight_m_s;
  // The constellation's orbits are circles to which the relativistic term gives nothing.
  const double satellite_clock_s = message.af0_s + message.af1_s_s * since_toe_s;
  double air_m = 0.0;
  if (sky.air) {
    const GeodeticPoint place = sky.frame.to_geodetic(antenna.position_map_m);
    air_m = sim::saastamoinen_delay_m(place, sight.elevation_rad()) +
            kKlobuchar.delay_m(place, sight.azimuth_rad(), sight.elevation_rad(), time) *
                std::pow(1575.42e6 / frequency_hz, 2.0);
  }
  const double range_rate_m_s = sight.range_rate_m_s -
                                sight.direction.dot(antenna.velocity_map_m_s) +
                                kSpeedOfLight_m_s * (sky.clock_drift - message.af1_s_s);
  GnssObservation seen{.satellite = sight.id};
  seen.pseudorange_m = sight.range_m + kSpeedOfLight_m_s * (clock_s - satellite_clock_s) + air_m;
  seen.doppler_hz = -range_rate_m_s * frequency_hz / kSpeedOfLight_m_s;
  seen.carrier_hz = frequency_hz;
  seen.cn0_db_hz = 45.0;
  seen.carrier_cycles = seen.pseudorange_m * frequency_hz / kSpeedOfLight_m_s;
  seen.carrier_locked = true;
  return seen;
}

inline Recording record(const Sky& sky) {
  constexpr int kEpochs = 60;
  constexpr double kMask_rad = 5.0 * kDegree;
  const sim::Constellation constellation(sky.systems);
  const sim::SignalInSpace signals(constellation, false, 1);
  std::map<std::pair<SatelliteId, sim::GpsTime>, sim::BroadcastMessage> sent;
  Recording recording;
  for (int k = 0; k < kEpochs; ++k) {
    const Stamp stamp = stamp_from_seconds(k);
    const sim::GpsTime time = sky.start + stamp.time_since_epoch();
    const Motion antenna = sky.path(k);
    const double clock_s = sky.clock_s + sky.clock_drift * k;
    GnssEpoch epoch{.time = stamp, .receiver_time = stamp};
    if (!sky.dated_by_true_time) epoch.receiver_time += duration_from_seconds(clock_s);
    for (const sim::SatelliteSight& sight :
         constellation.in_view(sky.frame, antenna.position_map_m, time, kMask_rad)) {
      const sim::BroadcastMessage message = message_in_force(signals, sight.id, time);
      sent.insert({{sight.id, message.toe()}, message});
      epoch.observations.push_back(observe(sky, sight, message, antenna, time, clock_s));
    }
    recording.epochs.push_back(std::move(epoch));
  }
  for (const auto& [key, message] : sent) recording.messages.push_back(message);
  return recording;
}

}  // namespace locsim::scenarios::testing_gnss
