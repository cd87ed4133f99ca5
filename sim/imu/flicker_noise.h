#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/pose.h"
#include "core/time.h"
#include "sim/markov_noise.h"

namespace locsim::sim {

/// Three independent flicker noises of bias instability B = 1: one-sided density 1/(π·f), Allan
/// deviation √(2·ln 2/π) = 0.664 (IEEE Std 952), within 3 % from `flat_from` to `flat_to`.
///
/// Each is a sum of first-order Gauss–Markov processes, about one a decade, with correlation times
/// T from flat_from/3 to 2·flat_to in steps of a ratio r. Summed over a continuum of T, processes
/// of variance σ²·d(ln T)/ln r have the density σ²/(f·ln r); so σ² = ln r/π. Of the infinite
/// series that this would take, each end's process stands for those beyond it, whose Allan
/// variances add up there as those of a geometric series do: its σ² is r/(r − 1) times as much.
/// A process is evaluated often enough for its T, fifty times in it, not at every sample.
class FlickerNoise {
 public:
  FlickerNoise(std::uint64_t seed, std::string_view purpose, double flat_from_s, double flat_to_s,
               Duration period);

  /// At sample k. Moves forward only.
  [[nodiscard]] Vector3d at(std::int64_t k);

 private:
  struct Process {
    MarkovNoise noise;
    double sigma;
    /// Samples from one evaluation to the next.
    std::int64_t stride;
  };
  std::vector<Process> processes_;
};

}  // namespace locsim::sim
