#pragma once

#include <vector>

#include "core/geodesy.h"
#include "sim/gnss/broadcast_orbit.h"
#include "sim/gnss/satellites.h"

namespace locsim::sim {

/// Near-circular orbit about an oblate earth whose ground track repeats, as stations keep it.
struct RepeatingOrbit {
  SatelliteId id;
  double inclination_rad = 0.0;
  /// Mean radius, the drift of the node among the stars, and of the argument of latitude from it.
  double radius_m = 0.0;
  double node_rate_rad_s = 0.0;
  double latitude_argument_rate_rad_s = 0.0;
  /// At `epoch`: earth-fixed longitude of the ascending node, argument of latitude.
  GpsTime epoch;
  double node_longitude_rad = 0.0;
  double latitude_argument_rad = 0.0;
};

/// The satellites of the nominal slots: GPS 24 (SPS Performance Standard 2001, table 3-1, as
/// G01…G24 in its order), Galileo 24/3/1 (E01…E24), GLONASS 24 (R01…R24, eight a plane), BeiDou
/// 24/3/1, three inclined geosynchronous ones (the numbers of BeiDou-3: C19… and C38…C40) and five
/// geostationary ones (C01 140° E, C02 80° E, C03 110.5° E, C04 160° E, C05 58.75° E, in the plane
/// of the equator). Where no epoch of a slot table is published (GLONASS, BeiDou), nodes
/// start from 0° longitude on 2020-01-01: right in spacing, not in which satellite is where.
class Constellation {
 public:
  /// Throws InputError where `systems` is empty or names one twice.
  explicit Constellation(std::vector<GnssSystem> systems);

  [[nodiscard]] const std::vector<RepeatingOrbit>& orbits() const { return orbits_; }
  /// What the satellite would broadcast for `toe`; throws InputError where it is none of these.
  [[nodiscard]] BroadcastOrbit broadcast(SatelliteId id, GpsTime toe) const;
  /// Satellites whose signals arrive at `time` from at least `mask_rad` above the horizon of the
  /// map's origin: light time and the turn of the earth within it are accounted for, refraction
  /// is not. Throws InputError where the mask is not within [−90°, 90°].
  [[nodiscard]] std::vector<SatelliteSight> in_view(const LocalFrame& frame,
                                                    const Vector3d& antenna_map_m, GpsTime time,
                                                    double mask_rad) const;

 private:
  std::vector<RepeatingOrbit> orbits_;
};

/// Position and velocity on the orbit, with the swing that J2 gives radius and argument of
/// latitude.
[[nodiscard]] SatelliteState evaluate(const RepeatingOrbit& orbit, GpsTime time);

/// GLONASS channel k of a slot 1…24: its L1 carrier is 1602 MHz + k · 0.5625 MHz.
[[nodiscard]] int glonass_channel(int slot);

}  // namespace locsim::sim
