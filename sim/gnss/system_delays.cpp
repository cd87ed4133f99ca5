#include "sim/gnss/system_delays.h"

#include <algorithm>
#include <cmath>

namespace locsim::sim {

namespace {

std::size_t index(GnssSystem system) {
  return static_cast<std::size_t>(system);
}

}  // namespace

std::optional<SystemDelays::Delay> SystemDelays::known(GnssSystem system, Stamp time) const {
  const auto& state = states_[index(system)];
  if (!state) return std::nullopt;
  const double age_s = std::max(to_seconds(time - state->learnt), 0.0);
  return Delay{.mean_m = state->delay.mean_m,
               .sigma_m = std::hypot(state->delay.sigma_m, kWander_m_sqrts * std::sqrt(age_s))};
}

void SystemDelays::set_datum(GnssSystem datum) {
  if (datum_ == datum) return;
  datum_ = datum;
  states_ = {};
}

void SystemDelays::learn(GnssSystem system, const Delay& posterior, Stamp time) {
  states_[index(system)] = State{
      .delay = {.mean_m = posterior.mean_m, .sigma_m = std::max(posterior.sigma_m, kLeastSigma_m)},
      .learnt = time};
}

void SystemDelays::contradict(GnssSystem system, Stamp time) {
  auto& state = states_[index(system)];
  if (!state) return;
  if (!state->contradicted_since) state->contradicted_since = time;
  if (to_seconds(time - *state->contradicted_since) >= kForget_s) state.reset();
}

DelayPlan plan_delays(const SystemDelays& delays, const std::array<bool, kGnssSystems>& present,
                      const std::array<bool, kGnssSystems>& distrusted, Stamp time) {
  const auto is_present = [&](GnssSystem system) { return present[index(system)]; };
  const auto first = std::ranges::find_if(kSystemPreference, is_present);
  DelayPlan plan;
  if (first == kSystemPreference.end()) return plan;
  const bool is_tied =
      delays.datum() && std::ranges::any_of(kSystemPreference, [&](GnssSystem system) {
        return is_present(system) &&
               (system == *delays.datum() ||
                (!distrusted[index(system)] && delays.known(system, time).has_value()));
      });
  plan.reference = is_tied ? *delays.datum() : *first;
  plan.reference_present = is_present(plan.reference);
  int next = DelayPlan::kClock + 1;
  for (const GnssSystem system : kSystemPreference) {
    if (!is_present(system) || system == plan.reference) continue;
    plan.unknown[index(system)] = next++;
    if (is_tied && !distrusted[index(system)])
      plan.known[index(system)] = delays.known(system, time);
    if (!plan.known[index(system)]) ++plan.satellites_needed;
  }
  return plan;
}

}  // namespace locsim::sim
