#include "sim/traffic/traffic_config.h"

namespace locsim::sim {

void QueueConfig::describe(Parameters& p) {
  p.number("from_m", from_m, kNotNegative);
  p.number("to_m", to_m, kNotNegative);
  if (to_m < from_m) p.fail("to_m", "is less than from_m, needs at least as much");
  p.number("speed_m_s", speed_m_s, {0.0, 8.0});
  // Between nothing and a crawl, cars would enter minutes apart.
  if (speed_m_s > 0.0 && speed_m_s < 0.5) {
    p.fail("speed_m_s", "is between 0 and 0.5, needs 0 (standing) or 0.5 to 8");
  }
  p.number("gap_m", gap_m, {1.0, 50.0});
  p.number("lorry_share", lorry_share, kShare);
}

void TrafficConfig::describe(Parameters& p) {
  p.number("oncoming_per_km", oncoming_per_km, {0.0, 60.0});
  p.number("oncoming_speed_spread", oncoming_speed_spread, {0.0, 0.5});
  p.number("lorry_share", lorry_share, kShare);
  p.number("bus_share", bus_share, kShare);
  if (lorry_share + bus_share > 1.0) {
    p.fail("bus_share", "is more than lorry_share leaves, needs at most 1 together");
  }
  p.integer("leading", leading, {0.0, 10.0});
  p.number("leading_gap_s", leading_gap_s, {1.0, 30.0});
  p.integer("following", following, {0.0, 3.0});
  p.number("following_gap_s", following_gap_s, {4.0, 30.0});
  p.number("pedestrians_per_km", pedestrians_per_km, {0.0, 200.0});
  p.number("cyclists_per_km", cyclists_per_km, {0.0, 50.0});
  p.group("queue", queue);
}

}  // namespace locsim::sim
