#pragma once

#include "sim/world/town.h"
#include "sim/world/town_layout.h"

namespace locsim::benchmarks {

/// The town of the first drive: about a million triangles.
struct Town {
  sim::Layout layout = sim::make_town_layout({}, 7);
  sim::World world = sim::build_town({}, layout, 7, {});
};

inline const Town& town() {
  static const Town instance;
  return instance;
}

}  // namespace locsim::benchmarks
