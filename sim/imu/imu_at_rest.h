#pragma once

#include <cstdint>
#include <vector>

#include "core/messages.h"
#include "sim/imu/imu_spec.h"

namespace locsim::sim {

/// The recording of a unit that lies level and still on a table for `duration_s`, as it is made
/// for an Allan analysis: every error of its own that `spec` has, but warm already and without
/// vibration. Sample k, at k·period, k = 1, 2, …, has the errors that `Imu` with the same seed
/// gives its sample k. Throws InputError where `spec` is out of its limits.
[[nodiscard]] std::vector<ImuSample> simulate_at_rest(const ImuSpec& spec, std::uint64_t seed,
                                                      double duration_s);

}  // namespace locsim::sim
