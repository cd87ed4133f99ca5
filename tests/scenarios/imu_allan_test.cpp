#include "sim/imu/imu_allan.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenarios/imu_presets.h"
#include "sim/imu/imu_at_rest.h"

namespace locsim::scenarios {
namespace {

using namespace locsim::sim;

constexpr double kHour_s = 3600.0;
constexpr double kTolerance = 0.10;
// So much of the tolerance is one standard deviation: of the 38 coefficients of nine presets one
// in ten sets of seeds would miss by three of them.
constexpr double kSigmas = 3.0;
// Presets share the draws of a seed, and few hours cost little.
constexpr double kFewestHours = 12.0;
constexpr std::array kTerms = {AllanTerm::white, AllanTerm::flicker, AllanTerm::walk};

// The curve that is expected of `recordings` hours of three axes, with its degrees of freedom.
AllanCurve expected_curve(const AllanModel& model, double rate_hz, int recordings) {
  const std::vector<double> any(static_cast<std::size_t>(kHour_s * rate_hz), 0.0);
  AllanCurve curve = allan_variance(any, rate_hz);
  for (AllanPoint& point : curve) {
    point.variance = model.variance(point.tau_s);
    for (double& edf : point.edf) edf *= 3.0 * recordings;
  }
  return curve;
}

// Hours until every coefficient of the model is known to a third of the tolerance, by the fit's own
// account of its uncertainty, which falls with the root of them.
int hours_needed(const AllanModel& model, double rate_hz) {
  constexpr int kMany = 1000;
  AllanFamily family{.shape = model.shape, .model_error = 0.0};
  for (std::size_t term = 0; term < kAllanTerms; ++term) {
    family.terms[term] = model.coefficient(static_cast<AllanTerm>(term)) > 0.0;
  }
  const AllanFit fit = fit_allan(expected_curve(model, rate_hz, kMany), family);
  double most = kFewestHours;
  for (const AllanTerm term : kTerms) {
    if (!(model.coefficient(term) > 0.0)) continue;
    const double relative = fit.of(term).sigma / model.coefficient(term) * kSigmas / kTolerance;
    most = std::max(most, kMany * relative * relative);
  }
  return static_cast<int>(std::ceil(most));
}

ImuAllanCurves simulate(const ImuSpec& spec, int hours) {
  std::vector<ImuAllanCurves> recordings(static_cast<std::size_t>(hours));
  tbb::parallel_for(std::size_t{0}, recordings.size(), [&](std::size_t i) {
    const std::vector<ImuSample> samples = simulate_at_rest(spec, i + 1, kHour_s);
    const Stretch all{.begin = 0, .end = samples.size()};
    recordings[i] = measure_allan(samples, {&all, 1}, spec.rate_hz);
  });
  return pool_recordings(recordings);
}

void expect_given_back(const std::string& what, const AllanAxes& axes, const AllanTriadFit& fit,
                       const AllanModel& model) {
  for (const AllanTerm term : kTerms) {
    const double specified = model.coefficient(term);
    if (!(specified > 0.0)) continue;
    const AllanCoefficient& c = fit.together.of(term);
    EXPECT_NEAR(c.value / specified, 1.0, kTolerance) << what << ' ' << static_cast<int>(term);
    EXPECT_TRUE(c.seen) << what << ' ' << static_cast<int>(term);
    ::testing::Test::RecordProperty(what + std::to_string(static_cast<int>(term)),
                                    std::to_string(c.value / specified));
  }
  // The whole curve, too: 40 points, nearly as many as independent octaves, within four standard
  // deviations, and 2 % for samples being values, not means over their interval.
  for (const AllanPoint& point : pool_allan(axes)) {
    EXPECT_NEAR(std::sqrt(point.variance) / model.deviation(point.tau_s), 1.0,
                4.0 * relative_sigma(point, model) + 0.02)
        << what << " at " << point.tau_s << " s";
  }
}

class PresetAllan : public testing::TestWithParam<const char*> {};

// As many hours as the least visible coefficient takes: a few for a floor that an hour shows, some
// five hundred for that of hg9900's gyros, which lies under their white noise for 2700 s. Where
// many are needed they are sampled at 10 Hz: densities and floors are the same at any rate.
TEST_P(PresetAllan, HoursAtRestGiveBackEveryCoefficient) {
  constexpr int kManyHours = 20;
  NamedImu imu = load_imu(GetParam());
  imu.spec.rate_hz = 100.0;
  // Of the densities themselves: what rounding adds to the white noise depends on the rate.
  imu.spec.effects.quantisation = false;
  const ImuAllanModel model = specified_allan(imu.spec);
  const int hours = std::max(hours_needed(model.gyro, imu.spec.rate_hz),
                             hours_needed(model.accelerometer, imu.spec.rate_hz));
  RecordProperty("hours", hours);
  ASSERT_LE(hours, 1000) << "this would take too long";
  if (hours > kManyHours) imu.spec.rate_hz = 10.0;
  const ImuAllanCurves curves = simulate(imu.spec, hours);
  const ImuAllanFit fit = fit_imu_allan(curves, model);
  expect_given_back("gyro", curves.gyro, fit.gyro, model.gyro);
  expect_given_back("accelerometer", curves.accelerometer, fit.accelerometer, model.accelerometer);
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, PresetAllan,
                         testing::Values("mpu6000", "bmi088", "mti10", "mti100", "adis16488",
                                         "stim300", "rt3003", "kvh1750", "hg9900"),
                         [](const auto& preset) { return std::string(preset.param); });

TEST(ImuPresets, RoundedReadingsKeepTheirCurve) {
  // With the unit's own resolution, at its own rate: half an hour knows N to 0.1 %, and rounding
  // adds 0.1 to 1 % to it.
  for (const char* name : {"mpu6000", "bmi088"}) {
    const ImuSpec spec = load_imu(name).spec;
    ASSERT_GT(spec.gyro.resolution, 0.0);
    const std::vector<ImuSample> samples = simulate_at_rest(spec, 1, 0.5 * kHour_s);
    const Stretch all{.begin = 0, .end = samples.size()};
    const ImuAllanModel model = specified_allan(spec);
    const ImuAllanFit fit = fit_imu_allan(measure_allan(samples, {&all, 1}, spec.rate_hz), model);
    EXPECT_NEAR(fit.gyro.together.of(AllanTerm::white).value / model.gyro.white, 1.0, 0.005);
    EXPECT_NEAR(fit.accelerometer.together.of(AllanTerm::white).value / model.accelerometer.white,
                1.0, 0.005);
  }
}

TEST(ImuPresets, EveryBuiltInPresetIsNearestToItself) {
  // As two of them hold a good part of the same figures, N and B of one hour have to tell.
  const std::vector<NamedImu> imus = builtin_imus();
  ASSERT_EQ(imus.size(), 9U);
  for (NamedImu imu : imus) {
    imu.spec.rate_hz = 10.0;
    const std::vector<ImuSample> samples = simulate_at_rest(imu.spec, 5, kHour_s);
    const Stretch all{.begin = 0, .end = samples.size()};
    const ImuAllanFit fit = fit_imu_allan(measure_allan(samples, {&all, 1}, imu.spec.rate_hz));
    std::string nearest;
    double least = 1e9;
    for (const NamedImu& other : imus) {
      const double d = distance(fit, specified_allan(other.spec)).mean_log10_ratio;
      if (d < least) {
        least = d;
        nearest = other.name;
      }
    }
    EXPECT_EQ(nearest, imu.name);
    EXPECT_LT(least, 0.15);
  }
}

TEST(LoadImu, UnknownNameIsAnInputErrorThatSuggests) {
  try {
    static_cast<void>(load_imu("mti01"));
    FAIL() << "was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("mti10"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace locsim::scenarios
