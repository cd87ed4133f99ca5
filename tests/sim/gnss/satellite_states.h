#pragma once

#include <vector>

#include "sim/gnss/constellation.h"

namespace locsim::sim {

/// Every satellite of the constellation, in its order.
inline std::vector<SatelliteState> states_at(const Constellation& sky, GpsTime time) {
  std::vector<SatelliteState> states;
  for (const RepeatingOrbit& orbit : sky.orbits()) states.push_back(evaluate(orbit, time));
  return states;
}

}  // namespace locsim::sim
