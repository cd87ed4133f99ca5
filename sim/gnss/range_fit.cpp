#include "sim/gnss/range_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace locsim::sim {

namespace {

constexpr int kIterations = 12;
constexpr double kConverged_m = 1e-4;
// Within this distance of the ground, masks and weights by elevation mean something.
constexpr double kNearGround_m = 1e5;
// Moving less than this, a satellite's elevation changes by less than 0.1°.
constexpr double kReselect_m = 1e4;
constexpr int kSelections = 5;

bool is_near_ground(const EarthPlace& place) {
  return std::abs(place.geodetic.height_m) < kNearGround_m;
}

// What Gauss–Newton works on: the fit so far, and the equations about it. The first equations are
// those of `fit.used`, in its order, then those of known delays, then that of the height.
class RangeSolver {
 public:
  RangeSolver(const SolutionSpec& spec, const GnssEpoch& epoch, const SystemDelays& delays)
      : spec_(spec), epoch_(epoch), delays_(delays) {}

  RangeFit fit;

  void move_to(const Vector3d& position_ecef_m) {
    fit.position_ecef_m = position_ecef_m;
    fit.place = EarthPlace::at(position_ecef_m);
  }

  // All that are plausible; above the elevation mask as well once the place is known.
  void select() {
    is_masked_ = is_near_ground(fit.place);
    const double least_sine = std::sin(spec_.elevation_mask_rad);
    fit.used.clear();
    for (std::size_t i = 0; i < epoch_.observations.size(); ++i) {
      const GnssObservation& observation = epoch_.observations[i];
      if (!is_plausible(observation) || observation.cn0_db_hz < spec_.cn0_mask_db_hz) continue;
      if (is_masked_ &&
          line_of_sight(observation, fit.position_ecef_m).toward.dot(fit.place.up()) < least_sine)
        continue;
      fit.used.push_back(i);
    }
    plan();
  }

  void plan() {
    std::array<bool, kGnssSystems> present = {};
    for (const std::size_t i : fit.used) present[system(i)] = true;
    fit.plan = plan_delays(delays_, present, fit.contradicted, epoch_.time);
  }

  // Steps until they are small; false where they do not become so.
  bool converge(const std::optional<HeldHeight>& height) {
    for (int i = 0; i < kIterations; ++i) {
      build(height);
      const auto solution = solve_least_squares(equations_);
      if (!solution) return false;
      const UnknownVector& step = solution->step;
      move_to(fit.position_ecef_m + step.head<3>());
      fit.clock_m += step[DelayPlan::kClock];
      for (std::size_t s = 0; s < fit.delay_m.size(); ++s)
        if (fit.plan.unknown[s]) fit.delay_m[s] += step[*fit.plan.unknown[s]];
      if (step.head<3>().norm() < kConverged_m) return true;
    }
    return false;
  }

  // Takes out what stands out; true where there was something.
  bool monitor(const std::optional<HeldHeight>& height) {
    build(height);
    const auto is_enough = [&] {
      const auto left = std::count_if(equations_.begin(), equations_.begin() + satellites(),
                                      [](const Equation& equation) { return equation.used; });
      return left >= fit.plan.satellites_needed - (height ? 1 : 0) &&
             dilution_of_used(height.has_value()).position <= spec_.pdop_max;
    };
    const auto integrity = solve_by_spec(spec_, equations_, is_enough);
    if (!integrity) {
      fit.covariance.setConstant(std::numeric_limits<double>::infinity());
      return false;
    }
    fit.covariance = integrity->variance_factor() * integrity->solution.covariance;
    fit.passed = integrity->passed;
    if (integrity->excluded == 0) return false;
    apply_exclusions();
    return true;
  }

  Dilution dilution_of_used(bool height_is_held) const {
    std::vector<Vector3d> toward_enu;
    toward_enu.reserve(fit.used.size());
    for (std::size_t k = 0; k < fit.used.size(); ++k)
      if (equations_[k].used)
        toward_enu.push_back(fit.place.R_ecef_enu.transpose() * -equations_[k].gradient.head<3>());
    return dilution(toward_enu, height_is_held);
  }

 private:
  std::size_t system(std::size_t observation) const {
    return static_cast<std::size_t>(epoch_.observations[observation].satellite.system);
  }
  std::ptrdiff_t satellites() const { return static_cast<std::ptrdiff_t>(fit.used.size()); }

  void build(const std::optional<HeldHeight>& height) {
    const bool is_weighted = is_near_ground(fit.place);
    equations_.clear();
    for (const std::size_t i : fit.used) {
      const GnssObservation& observation = epoch_.observations[i];
      const LineOfSight sight = line_of_sight(observation, fit.position_ecef_m);
      const double sine = std::clamp(sight.toward.dot(fit.place.up()), -1.0, 1.0);
      const auto unknown = fit.plan.unknown[system(i)];
      Equation equation;
      equation.gradient.head<3>() = -sight.toward;
      equation.gradient[DelayPlan::kClock] = 1.0;
      if (unknown) equation.gradient[*unknown] = 1.0;
      // Without the mask some may stand at the horizon, where the troposphere's model has a pole.
      const double elevation_rad = is_masked_ ? std::asin(sine) : 0.0;
      equation.residual = corrected_range_m(observation, fit.place, elevation_rad) - sight.range_m -
                          fit.clock_m - (unknown ? fit.delay_m[system(i)] : 0.0);
      if (is_weighted) equation.sigma = range_sigma_m(spec_, observation, sine);
      equations_.push_back(equation);
    }
    for (std::size_t s = 0; s < fit.plan.known.size(); ++s) {
      const auto& known = fit.plan.known[s];
      if (!known) continue;
      Equation equation{.residual = known->mean_m - fit.delay_m[s], .sigma = known->sigma_m};
      equation.gradient[*fit.plan.unknown[s]] = 1.0;
      equations_.push_back(equation);
    }
    if (height) {
      Equation equation{.residual = height->height_m - fit.place.geodetic.height_m,
                        .sigma = height->sigma_m};
      equation.gradient.head<3>() = fit.place.up();
      equations_.push_back(equation);
    }
  }

  void apply_exclusions() {
    std::vector<std::size_t> left;
    std::size_t next = 0;
    for (const std::size_t i : fit.used)
      if (equations_[next++].used) left.push_back(i);
    fit.excluded += static_cast<int>(fit.used.size() - left.size());
    fit.used = std::move(left);
    for (std::size_t s = 0; s < fit.plan.known.size(); ++s)
      if (fit.plan.known[s] && !equations_[next++].used) fit.contradicted[s] = true;
    plan();
  }

  const SolutionSpec& spec_;
  const GnssEpoch& epoch_;
  const SystemDelays& delays_;
  std::vector<Equation> equations_;
  bool is_masked_ = false;
};

std::optional<RangeFit> fit_from(const SolutionSpec& spec, const GnssEpoch& epoch,
                                 const SystemDelays& delays, const std::optional<HeldHeight>& held,
                                 const Vector3d& start_ecef_m, int& usable) {
  RangeSolver solver(spec, epoch, delays);
  RangeFit& fit = solver.fit;
  solver.move_to(start_ecef_m);
  std::optional<HeldHeight> height;
  const auto is_enough = [&](int least) {
    return usable >= std::max(least, fit.plan.satellites_needed - (height ? 1 : 0));
  };
  for (int selection = 0;; ++selection) {
    if (selection == kSelections) return std::nullopt;
    const Vector3d before = fit.position_ecef_m;
    const bool was_near_ground = is_near_ground(fit.place);
    solver.select();
    usable = static_cast<int>(fit.used.size());
    height.reset();
    if (usable < std::max(spec.satellites_min, fit.plan.satellites_needed)) {
      if (!held || !was_near_ground) return std::nullopt;
      height = held;
      if (!is_enough(spec.satellites_min - 1)) return std::nullopt;
    }
    if (!solver.converge(height)) {
      if (height || !held || !was_near_ground) return std::nullopt;
      height = held;
      solver.move_to(before);
      if (!solver.converge(height)) return std::nullopt;
    }
    if (!is_near_ground(fit.place)) return std::nullopt;
    if (was_near_ground && (fit.position_ecef_m - before).norm() < kReselect_m) break;
  }
  if (!height && held && solver.dilution_of_used(false).position > spec.pdop_max) {
    height = held;
    if (!solver.converge(height)) return std::nullopt;
  }
  while (solver.monitor(height))
    if (!solver.converge(height)) return std::nullopt;
  fit.dilution = solver.dilution_of_used(height.has_value());
  fit.height_is_held = height.has_value();
  if (!(fit.dilution.position <= spec.pdop_max) || !fit.covariance.allFinite()) return std::nullopt;
  return fit;
}

}  // namespace

std::optional<RangeFit> fit_ranges(const SolutionSpec& spec, const GnssEpoch& epoch,
                                   const SystemDelays& delays,
                                   const std::optional<HeldHeight>& held,
                                   const Vector3d& near_ecef_m, int& usable) {
  usable = 0;
  if (near_ecef_m.allFinite() && is_near_ground(EarthPlace::at(near_ecef_m))) {
    auto fit = fit_from(spec, epoch, delays, held, near_ecef_m, usable);
    if (fit) return fit;
  }
  int usable_from_middle = 0;
  auto fit = fit_from(spec, epoch, delays, std::nullopt, Vector3d::Zero(), usable_from_middle);
  if (fit) usable = usable_from_middle;
  return fit;
}

}  // namespace locsim::sim
