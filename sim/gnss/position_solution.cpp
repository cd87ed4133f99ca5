#include "sim/gnss/position_solution.h"

#include <algorithm>
#include <cmath>

namespace locsim::sim {

namespace {

// By how much a car's height may differ from the one held, growing with the way it goes.
constexpr double kHeightWander_m_s = 0.5;
// A car's vertical speed, where satellites do not give it.
constexpr double kVerticalSpeed_m_s = 0.5;

struct RateFit {
  Vector3d velocity_ecef_m_s = Vector3d::Zero();
  double drift_m_s = 0.0;
  Matrix3d covariance_m2_s2 = Matrix3d::Zero();
};

// Velocity and drift are the unknowns 0 to 3, linear in the range rates.
std::optional<RateFit> fit_rates(const SolutionSpec& spec, const GnssEpoch& epoch,
                                 const RangeFit& ranges) {
  std::vector<Equation> equations;
  equations.reserve(ranges.used.size() + 1);
  std::vector<Vector3d> toward_enu;
  for (const std::size_t i : ranges.used) {
    const GnssObservation& observation = epoch.observations[i];
    const LineOfSight sight = line_of_sight(observation, ranges.position_ecef_m);
    Equation equation;
    equation.gradient.head<3>() = -sight.toward / (1.0 + sight.stretch);
    equation.gradient[DelayPlan::kClock] = 1.0;
    equation.residual =
        corrected_range_rate_m_s(observation) - sight.approach_m_s / (1.0 + sight.stretch);
    equation.sigma = range_rate_sigma_m_s(spec, observation.cn0_db_hz);
    equations.push_back(equation);
    toward_enu.push_back(ranges.place.R_ecef_enu.transpose() * sight.toward);
  }
  if (ranges.height_is_held) {
    Equation level{.sigma = kVerticalSpeed_m_s};
    level.gradient.head<3>() = ranges.place.up();
    equations.push_back(level);
  }
  const auto is_enough = [&] {
    std::vector<Vector3d> left;
    for (std::size_t k = 0; k < toward_enu.size(); ++k)
      if (equations[k].used) left.push_back(toward_enu[k]);
    return dilution(left, ranges.height_is_held).position <= spec.pdop_max;
  };
  const auto integrity = solve_by_spec(spec, equations, is_enough);
  if (!integrity) return std::nullopt;
  const LeastSquares& solution = integrity->solution;
  return RateFit{
      .velocity_ecef_m_s = solution.step.head<3>(),
      .drift_m_s = solution.step[DelayPlan::kClock],
      .covariance_m2_s2 = integrity->variance_factor() * solution.covariance.topLeftCorner<3, 3>()};
}

}  // namespace

PositionSolver::PositionSolver(const SolutionSpec& spec) : spec_(spec) {}

EpochSolution PositionSolver::solve(const GnssEpoch& epoch, const Vector3d& near_ecef_m) {
  EpochSolution solution;
  const auto ranges =
      fit_ranges(spec_, epoch, delays_, held_height(epoch.time), near_ecef_m, solution.satellites);
  if (!ranges) return solution;
  const auto rates = fit_rates(spec_, epoch, *ranges);
  if (!rates || !rates->covariance_m2_s2.allFinite()) return solution;
  remember(*ranges, epoch.time);
  solution.state = ranges->height_is_held ? FixState::two_dimensional : FixState::three_dimensional;
  solution.position_ecef_m = ranges->position_ecef_m;
  solution.velocity_ecef_m_s = rates->velocity_ecef_m_s;
  solution.position_covariance_m2 = ranges->covariance.topLeftCorner<3, 3>();
  solution.velocity_covariance_m2_s2 = rates->covariance_m2_s2;
  solution.clock_m = ranges->clock_m;
  solution.clock_drift_m_s = rates->drift_m_s;
  solution.satellites = static_cast<int>(ranges->used.size());
  solution.excluded = ranges->excluded;
  solution.hdop = ranges->dilution.horizontal;
  solution.vdop = ranges->dilution.vertical;
  solution.pdop = ranges->dilution.position;
  return solution;
}

std::optional<HeldHeight> PositionSolver::held_height(Stamp time) const {
  if (!height_time_) return std::nullopt;
  const double age_s = to_seconds(time - *height_time_);
  if (!(age_s <= spec_.height_hold_s)) return std::nullopt;
  return HeldHeight{.height_m = height_.height_m,
                    .sigma_m = std::hypot(height_.sigma_m, kHeightWander_m_s * age_s)};
}

void PositionSolver::remember(const RangeFit& fit, Stamp time) {
  if (!fit.height_is_held) {
    const Vector3d up = fit.place.up();
    height_ = {.height_m = fit.place.geodetic.height_m,
               .sigma_m = std::sqrt(up.dot(fit.covariance.topLeftCorner<3, 3>() * up))};
    height_time_ = time;
  }
  for (const GnssSystem system : kSystemPreference) {
    const auto s = static_cast<std::size_t>(system);
    if (fit.contradicted[s]) delays_.contradict(system, time);
  }
  if (fit.height_is_held || !fit.passed || !fit.plan.reference_present) return;
  if (!delays_.datum()) delays_.set_datum(fit.plan.reference);
  if (delays_.datum() != fit.plan.reference) return;
  for (const GnssSystem system : kSystemPreference) {
    const auto s = static_cast<std::size_t>(system);
    const auto unknown = fit.plan.unknown[s];
    if (!unknown || (fit.contradicted[s] && delays_.known(system, time))) continue;
    delays_.learn(
        system,
        {.mean_m = fit.delay_m[s], .sigma_m = std::sqrt(fit.covariance(*unknown, *unknown))}, time);
  }
}

}  // namespace locsim::sim
