#pragma once

#include <cstdint>
#include <string_view>

#include "core/random.h"
#include "core/time.h"
#include "sim/gnss/satellites.h"

namespace locsim::sim {

/// What changes slowly and smoothly by chance: independent Gaussian functions of GPS time, one a
/// lane, of mean 0 and standard deviation 1 at every instant, twice continuously differentiable.
/// Independent normal draws at knots `spacing` apart are the coefficients of a cubic B-spline,
/// divided by the root of the sum of its squared weights: (1, 4, 1)/√18 at a knot, (1, 23, 23,
/// 1)/√1060 midway. Two instants τ apart correlate by 0.44 (at knots) to 0.54 (midway) at
/// τ = spacing, by 0.06 to 0.04 at twice that, not at all from four times on. A pure function.
class SmoothNoise {
 public:
  SmoothNoise(std::uint64_t seed, std::string_view purpose, Duration spacing);

  [[nodiscard]] double at(GpsTime time, std::uint64_t lane) const;

 private:
  RandomStream stream_;
  Duration spacing_;
};

}  // namespace locsim::sim
