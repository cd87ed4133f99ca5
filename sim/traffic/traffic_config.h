#pragma once

#include "core/parameters.h"

namespace locsim::sim {

/// A column in the opposite lane along a part of the route; none where `to_m` is `from_m`. Beyond
/// the route's ends there is none.
struct QueueConfig {
  double from_m = 0.0;
  double to_m = 0.0;
  /// 0: it stands, all along the drive. Else it creeps through this part, and its cars come and go
  /// as fast as the road allows before and behind it.
  double speed_m_s = 0.0;
  /// Mean free road between bumpers, drawn within ±30 %.
  double gap_m = 2.5;
  /// Share of lorries, a tenth of them articulated where the road is straight enough.
  double lorry_share = 0.15;

  [[nodiscard]] bool is_asked_for() const { return to_m > from_m; }
  void describe(Parameters& p);
};

struct TrafficConfig {
  /// Cars in the opposite lane at any time.
  double oncoming_per_km = 6.0;
  /// Their speeds over the route's profile: drawn between 1 − spread and 1 + spread.
  double oncoming_speed_spread = 0.15;
  /// Shares of lorries and of buses among them and among those ahead and behind. A lorry or bus
  /// that would not get around something standing gives its place to a car.
  double lorry_share = 0.1;
  double bus_share = 0.05;
  /// Cars ahead in the car's own lane, each `leading_gap_s` before the next, by the same profile
  /// and with the same stops.
  int leading = 1;
  double leading_gap_s = 4.0;
  /// Cars behind it, likewise. They give way to nothing: a car late by more than the gap is hit.
  int following = 1;
  double following_gap_s = 5.0;
  /// People on foot and on bicycles on the pavements of the route's streets, per km of street.
  double pedestrians_per_km = 20.0;
  double cyclists_per_km = 3.0;
  QueueConfig queue;

  void describe(Parameters& p);
};

}  // namespace locsim::sim
