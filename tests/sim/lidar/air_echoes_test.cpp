#include "sim/lidar/air_echoes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "core/random.h"

namespace locsim::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kOpen_m = std::numeric_limits<float>::infinity();
// Never a drop.
constexpr std::uint32_t kNoDrop = ~0U;

LidarSpec sensor() {
  LidarSpec spec;
  spec.divergence_rad = {3.0e-3, 1.5e-3};
  return spec;
}

Atmosphere weather(const WeatherSpec& spec) {
  return Weather({spec}).at(Stamp{});
}

double limit(const LidarSpec& spec) {
  return spec.detection_reflectivity / (spec.detection_range_m * spec.detection_range_m);
}

// Of a target that fills the beam, in double and written apart from what is tested.
double gain(const LidarSpec& spec, double alpha_1_m, double range_m) {
  const double overlap = std::clamp((range_m - spec.range_min_m + 0.1) / 0.2, 0.0, 1.0);
  return overlap * std::exp(-2.0 * alpha_1_m * range_m) / (range_m * range_m);
}

Echo soft_mean(const AirEchoes& echoes, float target_range_m) {
  Echo mean;
  for (std::uint32_t i = 0; i < 256; ++i) {
    const auto echo = echoes.strongest(target_range_m, {i << 24, kNoDrop, 0, 0});
    mean.range_m = std::max(mean.range_m, echo.range_m);
    mean.power += echo.power / 256.0F;
  }
  return mean;
}

// A pulse sin²(π·t/τ) as it comes back at time t, through air up to the target, by the midpoint
// rule at a third of a millimetre or less; ranged where it peaks, less half the pulse.
Echo soft_brute(const LidarSpec& spec, const Atmosphere& air, double target_range_m) {
  const double pulse_m = 0.5 * 0.299792458 * spec.pulse_ns;
  const double near_m = spec.range_min_m - 0.1;
  const double far_m = std::min(target_range_m, near_m + 0.2 + 2.0 * pulse_m);
  const double step_m = std::min(pulse_m, 0.2) / 600.0;
  const auto response = [&](double delay_m) {
    double sum = 0.0;
    const double begin_m = std::max(near_m, delay_m - pulse_m);
    const double end_m = std::min(far_m, delay_m);
    const int steps = std::max(1, static_cast<int>((end_m - begin_m) / step_m));
    const double dr = (end_m - begin_m) / steps;
    for (int i = 0; i < steps; ++i) {
      const double r = begin_m + (i + 0.5) * dr;
      sum += dr * kPi * air.backscatter_1_m_sr * gain(spec, air.extinction_1_m, r) *
             std::pow(std::sin(kPi * (delay_m - r) / pulse_m), 2);
    }
    return sum;
  };
  Echo best;
  constexpr int kDelays = 400;
  for (int i = 1; i < kDelays; ++i) {
    const double delay_m = near_m + (far_m + pulse_m - near_m) * i / kDelays;
    const auto power = static_cast<float>(response(delay_m));
    if (power > best.power) {
      best = {.range_m = static_cast<float>(delay_m - 0.5 * pulse_m), .power = power};
    }
  }
  return best;
}

TEST(AirEchoes, ClearAirSendsNothing) {
  const AirEchoes clear(Atmosphere{}, sensor());
  EXPECT_EQ(clear.extinction_1_m(), 0.0F);
  EXPECT_EQ(clear.strongest(kOpen_m, {0, 0, 0, 0}).power, 0.0F);

  LidarSpec spec = sensor();
  spec.effects.weather = false;
  const AirEchoes ignored(weather({.snow_mm_h = 10.0, .fog_visibility_m = 20.0}), spec);
  EXPECT_EQ(ignored.extinction_1_m(), 0.0F);
  EXPECT_EQ(ignored.strongest(kOpen_m, {0, 0, 0, 0}).power, 0.0F);
}

TEST(AirEchoes, ExtinctionIsThatOfTheAir) {
  const Atmosphere air = weather({.rain_mm_h = 20.0, .fog_visibility_m = 150.0});
  EXPECT_FLOAT_EQ(AirEchoes(air, sensor()).extinction_1_m(),
                  static_cast<float>(air.extinction_1_m));
}

TEST(AirEchoes, SoftEchoIsThePulseConvolvedWithTheAir) {
  for (const double range_min_m : {0.5, 1.0, 3.0}) {
    for (const double pulse_ns : {1.0, 5.0, 30.0}) {
      for (const double visibility_m : {5.0, 15.0}) {
        for (const double beyond_m : {0.05, 0.15, 0.5, 100.0}) {
          LidarSpec spec = sensor();
          spec.range_min_m = range_min_m;
          spec.pulse_ns = pulse_ns;
          // So that nothing is too weak.
          spec.detection_range_m = 1e4;
          const Atmosphere air = weather({.fog_visibility_m = visibility_m});
          const double target_m = range_min_m - 0.1 + beyond_m;
          const auto found = soft_mean(AirEchoes(air, spec), static_cast<float>(target_m));
          const auto expected = soft_brute(spec, air, target_m);
          SCOPED_TRACE(testing::Message() << range_min_m << " m, " << pulse_ns << " ns, "
                                          << visibility_m << " m, +" << beyond_m << " m");
          // Trapezoids over a kink: (h/rise)² = 1/256 at 16 steps over the rise or half a pulse,
          // whichever is shorter; a column cut between two points is read off a straight line:
          // ⅛ h² of a square's curvature, 2/25 at 5 points into the rise.
          EXPECT_NEAR(found.power, expected.power, 0.01F * expected.power);
          // Steps of both: pulse/32 at most 0.0125 m, and the column over 400.
          const double pulse_m = 0.5 * 0.299792458 * pulse_ns;
          const double step_m = std::min(pulse_m / 32.0, 0.0125);
          EXPECT_NEAR(found.range_m, expected.range_m, step_m + (0.2 + 3.0 * pulse_m) / 400.0);
          EXPECT_LE(found.range_m, static_cast<float>(target_m) + 1e-6F);
        }
      }
    }
  }
}

TEST(AirEchoes, ShortPulseMeetsATargetOfPiBetaTimesHalfItsLength) {
  LidarSpec spec = sensor();
  spec.pulse_ns = 0.1;
  spec.detection_range_m = 1e4;
  const Atmosphere air = weather({.fog_visibility_m = 30.0});
  const double pulse_m = 0.5 * 0.299792458 * 0.1;
  const double expected = kPi * (0.046 / 30.0) * 0.5 * pulse_m *
                          std::exp(-2.0 * air.extinction_1_m * 1.1) / (1.1 * 1.1);
  // Where the overlap is full, at 1.1 m; within the pulse's 15 mm of there the gain falls by up to
  // 15/200 on the one side and 2·15/1100 on the other, half of that at half the pulse.
  const auto found = soft_mean(AirEchoes(air, spec), kOpen_m);
  EXPECT_NEAR(found.power, expected, 0.05 * expected);
  EXPECT_NEAR(found.range_m, 1.1, 0.5 * pulse_m);
}

TEST(AirEchoes, NothingIsAheadOfTargetsTheReceiverDoesNotSee) {
  const AirEchoes fog(weather({.fog_visibility_m = 10.0}), sensor());
  EXPECT_EQ(soft_mean(fog, 0.9F).power, 0.0F);
  EXPECT_EQ(soft_mean(fog, 0.0F).power, 0.0F);
  float before = 0.0F;
  for (float target_m = 1.0F; target_m < 1.5F; target_m += 0.1F) {
    const float power = soft_mean(fog, target_m).power;
    EXPECT_GT(power, before);
    before = power;
  }
  // Half a pulse (0.37 m) beyond the peak, at 1.2 m, the column is as good as endless.
  EXPECT_EQ(soft_mean(fog, 2.0F).power, soft_mean(fog, kOpen_m).power);
}

TEST(AirEchoes, SoftEchoVariesAsTheDensityDoes) {
  const AirEchoes fog(weather({.fog_visibility_m = 10.0}), sensor());
  const double mean = soft_mean(fog, kOpen_m).power;
  double sum = 0.0;
  double squares = 0.0;
  for (std::uint32_t i = 0; i < 256; ++i) {
    const double power = fog.strongest(kOpen_m, {i << 24, kNoDrop, 0, 0}).power;
    sum += std::log(power / mean);
    squares += std::pow(std::log(power / mean), 2);
  }
  // Log-normal of mean 1: the logarithm's mean is −σ²/2. 256 quantiles lack the tails beyond
  // 2.9 σ, 1 % of the variance.
  EXPECT_NEAR(sum / 256.0, -0.5 * 0.3 * 0.3, 0.01 * 0.5 * 0.3 * 0.3 + 1e-3);
  EXPECT_NEAR(std::sqrt(squares / 256.0 - std::pow(sum / 256.0, 2)), 0.3, 0.003);
}

TEST(AirEchoes, ThinFogStaysBelowTheDetectionLimitAlsoWhereNoneIsAskedFor) {
  LidarSpec spec = sensor();
  spec.effects.detection_limit = false;
  const AirEchoes haze(weather({.fog_visibility_m = 5000.0}), spec);
  EXPECT_GT(haze.extinction_1_m(), 0.0F);
  EXPECT_EQ(soft_mean(haze, kOpen_m).power, 0.0F);
  spec.detection_range_m = 1e4;
  EXPECT_GT(soft_mean(AirEchoes(weather({.fog_visibility_m = 5000.0}), spec), kOpen_m).power, 0.0F);
}

// The nearest drop that is seen, with every drop of the air placed in a box about the beam.
class PlacedDrops {
 public:
  PlacedDrops(const LidarSpec& spec, const Atmosphere& air, double target_range_m)
      : spec_(spec), air_(air), target_range_m_(target_range_m), random_(3, "drops") {}

  Echo next() {
    const auto rain = nearest(air_.rain);
    const auto snow = nearest(air_.snow);
    if (rain.power == 0.0F) return snow;
    return snow.power > 0.0F && snow.range_m < rain.range_m ? snow : rain;
  }

 private:
  Echo nearest(const Particles& kind) {
    if (kind.number_1_m3_mm == 0.0) return {};
    const double width_m = 0.01 + spec_.divergence_rad[0] * target_range_m_;
    const double height_m = 0.01 + spec_.divergence_rad[1] * target_range_m_;
    const double number_1_m = kind.number_1_m3_mm / kind.slope_1_mm * width_m * height_m;
    for (double r_m = 0.0;;) {
      r_m -= std::log(random_.uniform()) / number_1_m;
      if (r_m > target_range_m_) return {};
      const double x = random_.uniform(-0.5, 0.5) * width_m;
      const double y = random_.uniform(-0.5, 0.5) * height_m;
      const double diameter_m = -1e-3 * std::log(random_.uniform()) / kind.slope_1_mm;
      const double across_m = 0.01 + spec_.divergence_rad[0] * r_m;
      const double along_m = 0.01 + spec_.divergence_rad[1] * r_m;
      if (std::pow(2.0 * x / across_m, 2) + std::pow(2.0 * y / along_m, 2) > 1.0) continue;
      const double fill = std::min(1.0, diameter_m * diameter_m / (across_m * along_m));
      const double power = kind.reflectivity * fill * gain(spec_, air_.extinction_1_m, r_m);
      if (power >= limit(spec_)) {
        return {.range_m = static_cast<float>(r_m), .power = static_cast<float>(power)};
      }
    }
  }

  LidarSpec spec_;
  Atmosphere air_;
  double target_range_m_;
  RandomSequence random_;
};

// Two samples of the same size from one distribution: χ² of bins with a + b > 0 has as many degrees
// of freedom as bins, as none (the first bin) is counted too.
double chi_square(const std::vector<int>& a, const std::vector<int>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] + b[i] > 0) sum += std::pow(a[i] - b[i], 2) / (a[i] + b[i]);
  }
  return sum;
}

struct Histograms {
  static constexpr std::size_t kBins = 20;
  std::vector<int> range = std::vector<int>(kBins);
  std::vector<int> power = std::vector<int>(kBins);
  int hits = 0;

  // Ranges between 0.9 m and the target, powers by the square root of P_min/P: both about evenly
  // filled, in the first bin what has no echo.
  void add(const Echo& echo, double reach_m, double limit_power) {
    const bool hit = echo.power > 0.0F;
    hits += hit ? 1 : 0;
    const auto bin = [&](double share) {
      return hit ? 1 + std::min(kBins - 2, static_cast<std::size_t>(share * (kBins - 1))) : 0;
    };
    ++range[bin(std::sqrt(std::max(0.0, echo.range_m - 0.9) / (reach_m - 0.9)))];
    ++power[bin(std::sqrt(limit_power / echo.power))];
  }
};

struct DropCase {
  const char* name;
  WeatherSpec weather;
  double target_range_m;
  int rays;
};

void PrintTo(const DropCase& test, std::ostream* out) {
  *out << test.name;
}

class AirEchoesDrops : public testing::TestWithParam<DropCase> {};

TEST_P(AirEchoesDrops, ComeAsOftenAsFarAndAsStrongAsDropsPlacedOneByOne) {
  const DropCase& test = GetParam();
  const LidarSpec spec = sensor();
  const Atmosphere air = weather(test.weather);
  const AirEchoes echoes(air, spec);
  PlacedDrops placed(spec, air, test.target_range_m);
  const RandomStream stream(5, "rays");
  Histograms found;
  Histograms expected;
  for (int i = 0; i < test.rays; ++i) {
    found.add(echoes.strongest(static_cast<float>(test.target_range_m),
                               stream.bits(static_cast<std::uint64_t>(i))),
              test.target_range_m, limit(spec));
    expected.add(placed.next(), test.target_range_m, limit(spec));
  }
  // Enough to see a model that is 6 % off, at four standard deviations of the difference.
  ASSERT_GT(expected.hits, 8000);
  const double p = static_cast<double>(expected.hits) / test.rays;
  EXPECT_NEAR(found.hits, expected.hits, 4.0 * std::sqrt(2.0 * test.rays * p * (1.0 - p)));
  // 20 bins: 99.99 % of draws are below 52.4.
  EXPECT_LT(chi_square(found.range, expected.range), 52.4);
  EXPECT_LT(chi_square(found.power, expected.power), 52.4);
  EXPECT_GT(chi_square(found.range, expected.range), 2.0);  // no two random samples agree that well
}

INSTANTIATE_TEST_SUITE_P(
    Weather, AirEchoesDrops,
    testing::Values(DropCase{"snow", {.snow_mm_h = 2.0}, 14.0, 20'000},
                    DropCase{"snow_before_a_near_target", {.snow_mm_h = 2.0}, 3.0, 50'000},
                    DropCase{"rain", {.rain_mm_h = 100.0}, 6.0, 100'000},
                    DropCase{"sleet", {.rain_mm_h = 100.0, .snow_mm_h = 0.3}, 5.0, 30'000}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(AirEchoes, WithoutDivergenceTheBeamIsItsAperture) {
  LidarSpec spec = sensor();
  spec.divergence_rad = {0.0, 0.0};
  // Air that takes nothing, so that the rate has a closed form: A·N/Λ·exp(−Λ·k·r) with
  // D_min = k·r, k = a·√(P_min/ρ).
  const Atmosphere air{.extinction_1_m = 0.0, .snow = snowflakes(2.0)};
  const double k = 0.01 * std::sqrt(limit(spec) / air.snow.reflectivity) * 1e3;
  const double slope_1_m = air.snow.slope_1_mm * k;
  const double number_1_m =
      air.snow.number_1_m3_mm / air.snow.slope_1_mm * 0.25 * kPi * 0.01 * 0.01;
  const double expected =
      number_1_m / slope_1_m * (std::exp(-slope_1_m * 5.0) - std::exp(-slope_1_m * 20.0));

  const AirEchoes echoes(air, spec);
  constexpr std::uint32_t kDraws = 1U << 18U;
  const auto share_before = [&](float target_m) {
    int hits = 0;
    for (std::uint32_t i = 0; i < kDraws; ++i) {
      hits += echoes.strongest(target_m, {0, i << 14U, 0, 1U << 31U}).power > 0.0F ? 1 : 0;
    }
    return hits / static_cast<double>(kDraws);
  };
  const double found = std::log1p(-share_before(5.0F)) - std::log1p(-share_before(20.0F));
  // Draws are even to 2^−18, and 512 cells of a quadratic grid follow an exponential that falls by
  // 1/e over some 40 m to (cell/40)²/24.
  EXPECT_NEAR(found, expected, 1e-4 * expected + 4.0 / kDraws);
}

TEST(AirEchoes, StrongestOfFogAndDropIsWhatCounts) {
  const LidarSpec spec = sensor();
  const Atmosphere both{.extinction_1_m = 0.02,
                        .backscatter_1_m_sr = 3e-4,
                        .rain = raindrops(100.0),
                        .snow = snowflakes(3.0)};
  Atmosphere fog = both;
  fog.rain = {};
  fog.snow = {};
  Atmosphere drops = both;
  drops.backscatter_1_m_sr = 0.0;
  const AirEchoes of_both(both, spec);
  const AirEchoes of_fog(fog, spec);
  const AirEchoes of_drops(drops, spec);
  const RandomStream stream(9, "rays");
  int soft = 0;
  int hard = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const auto bits = stream.bits(i);
    const auto a = of_fog.strongest(kOpen_m, bits);
    const auto b = of_drops.strongest(kOpen_m, bits);
    const auto& stronger = a.power > b.power ? a : b;
    const auto found = of_both.strongest(kOpen_m, bits);
    EXPECT_EQ(found.power, stronger.power);
    EXPECT_EQ(found.range_m, stronger.range_m);
    (a.power > b.power ? soft : hard) += 1;
  }
  EXPECT_GT(soft, 100);
  EXPECT_GT(hard, 100);
}

TEST(AirEchoes, SameBitsGiveTheSameEcho) {
  const Atmosphere air = weather({.rain_mm_h = 50.0, .snow_mm_h = 3.0});
  const AirEchoes first(air, sensor());
  const AirEchoes second(air, sensor());
  const RandomStream stream(7, "rays");
  int echoes = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const auto a = first.strongest(30.0F, stream.bits(i));
    const auto b = second.strongest(30.0F, stream.bits(i));
    EXPECT_EQ(a.range_m, b.range_m);
    EXPECT_EQ(a.power, b.power);
    echoes += a.power > 0.0F ? 1 : 0;
  }
  EXPECT_GT(echoes, 300);
  EXPECT_LT(echoes, 1000);
}

TEST(AirEchoes, EveryDropIsAheadOfTheTargetAndAboveTheLimit) {
  LidarSpec spec = sensor();
  spec.range_max_m = 8.0;
  const AirEchoes snow(weather({.snow_mm_h = 50.0}), spec);
  const RandomStream stream(8, "rays");
  float farthest_m = 0.0F;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    const auto echo = snow.strongest(i % 2 == 0 ? 4.0F : kOpen_m, stream.bits(i));
    if (echo.power == 0.0F) continue;
    EXPECT_GE(echo.power, static_cast<float>(0.9999 * limit(spec)));
    EXPECT_LE(echo.range_m, i % 2 == 0 ? 4.0F : 8.0F);
    EXPECT_GT(echo.range_m, 0.9F);
    farthest_m = std::max(farthest_m, echo.range_m);
  }
  EXPECT_GT(farthest_m, 7.0F);
}

}  // namespace
}  // namespace locsim::sim
