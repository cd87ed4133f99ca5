#pragma once

#include <cstdint>
#include <vector>

#include "core/messages.h"
#include "core/random.h"
#include "sim/faults/faults.h"

namespace locsim::sim {

/// What faults do to the samples of an IMU: bias jumps (those at the same time add up), ranges
/// that shrink, stuck axes, lost samples. An axis that sticks from the first sample on keeps that.
/// (That samples come late is up to who delivers them.)
class ImuFaults {
 public:
  ImuFaults(const Faults& faults, std::uint64_t seed);

  /// Before the converters.
  void shift_biases(ImuSample& sample) const;
  /// After them.
  void clip(ImuSample& sample) const;
  /// Last of all. For every sample in order.
  void hold_stuck_axes(ImuSample& sample);
  [[nodiscard]] bool is_lost(std::int64_t k, Stamp time) const;

 private:
  /// An axis by its number in ImuStuckAxis::kAxes.
  struct StuckAxis {
    Faults::Interval interval;
    int axis;
  };

  std::vector<Faults::Timed<ImuBiasJump>> jumps_;
  std::vector<Faults::Timed<ImuSaturation>> saturations_;
  std::vector<StuckAxis> stuck_axes_;
  std::vector<Faults::Timed<ImuDropout>> dropouts_;
  RandomStream losses_;
  bool has_last_ = false;
  ImuSample last_;
};

}  // namespace locsim::sim
