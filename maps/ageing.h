#pragma once

#include <cstdint>

#include "maps/prior_map.h"

namespace locsim::maps {

/// The map as it would be had the world changed since it was made: patches of 4 m, `stale` of them
/// at random, no longer tell what stands there. A third each: what stood above the ground is left
/// out (it was built later); is 0.3 to 1.5 m beside (it was rebuilt); a box of a van's to a kiosk's
/// size stands there that has gone since. The ground of all of them lies up to 8 cm higher or lower
/// (new paving). The same seed gives the same bytes, and the patches of a small share are among
/// those of a larger one. Throws InputError where `stale` is not in [0, 1].
[[nodiscard]] PriorMap age(const PriorMap& map, double stale, std::uint64_t seed);

}  // namespace locsim::maps
