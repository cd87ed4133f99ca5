#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/lidar/lidar.h"

namespace locsim::sim {

/// What a thread that casts blocks writes; of no use outside of Lidar.
struct Lidar::Scratch {
  /// Random numbers by one call.
  static constexpr std::size_t kDraws = 4;

  SceneEchoes scene;
  /// A packet a beam, the chosen return and, in dual mode, the second.
  std::array<std::vector<Returns>, 2> returns;
  std::vector<Echo> echoes;
  /// What the window lets through there and back, a packet a beam; none where it is clean.
  std::vector<Lanes> window_gains;
  /// Whether rays meet drops, for four beams.
  std::array<std::array<std::uint32_t, kLanes>, kDraws> drop_bits;
};

}  // namespace locsim::sim
