#include "sim/imu/imu_at_rest.h"

#include "core/physics.h"
#include "sim/imu/imu_errors.h"

namespace locsim::sim {

std::vector<ImuSample> simulate_at_rest(const ImuSpec& spec, std::uint64_t seed,
                                        double duration_s) {
  check_parameters(spec, "imu");
  ImuSpec on_table = spec;
  on_table.effects.temperature = false;
  on_table.effects.vibration = false;
  ImuErrors errors(on_table, seed);
  const Duration period = spec.period();
  const std::int64_t count = duration_from_seconds(duration_s) / period;
  std::vector<ImuSample> samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (std::int64_t k = 1; k <= count; ++k) {
    ImuSample sample{.time = Stamp{k * period}, .specific_force_m_s2 = {0.0, 0.0, kGravity_m_s2}};
    if (spec.noise) {
      errors.sense(k, 0.0, sample);
      errors.digitise(sample);
    }
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace locsim::sim
