#include "sim/weather/weather.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.h"

namespace locsim::sim {
namespace {

constexpr double kPi = std::numbers::pi;

Atmosphere steady(const WeatherSpec& spec) {
  return Weather({spec}).at(Stamp{});
}

// ∫ N(D)·weight(D) dD over 60 e-folds, by Simpson's rule in 6000 steps of 0.01: exact to 1e-9.
double integral(const Particles& particles, const std::function<double(double)>& weight) {
  constexpr int kSteps = 6000;
  const double step_mm = 60.0 / particles.slope_1_mm / kSteps;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double d_mm = step_mm * i;
    const double share = i == 0 || i == kSteps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    sum += share * particles.number_1_m3_mm * std::exp(-particles.slope_1_mm * d_mm) * weight(d_mm);
  }
  return sum * step_mm / 3.0;
}

double sphere_mm3(double d_mm) {
  return kPi * std::pow(d_mm, 3) / 6.0;
}

std::string error_of(const std::vector<WeatherSpec>& specs) {
  try {
    const Weather weather(specs);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Weather, RainTakesAsMuchAsItsTablesSay) {
  // The tables have two digits.
  EXPECT_NEAR(steady({.rain_mm_h = 10.0}).extinction_1_m, 1.6e-3, 0.05e-3);
  EXPECT_NEAR(steady({.rain_mm_h = 50.0}).extinction_1_m, 4.3e-3, 0.05e-3);
  // 3.65e-4·R^0.63, three digits.
  for (const double rain_mm_h : {0.1, 1.0, 25.0, 200.0}) {
    const double expected = 3.65e-4 * std::pow(rain_mm_h, 0.63);
    EXPECT_NEAR(steady({.rain_mm_h = rain_mm_h}).extinction_1_m, expected, expected * 0.005 / 3.65);
  }
}

TEST(Weather, ExtinctionIsTwiceTheCrossSectionOfAllParticles) {
  for (const Particles& particles : {raindrops(30.0), snowflakes(2.0)}) {
    const double expected =
        1e-6 * integral(particles, [](double d_mm) { return 2.0 * kPi * d_mm * d_mm / 4.0; });
    EXPECT_NEAR(extinction_1_m(particles), expected, 1e-7 * expected);
  }
}

TEST(Weather, RainHoldsTheWaterOfMarshallAndPalmer) {
  // Theirs is 0.089·R^0.84 g/m³, two digits.
  for (const double rain_mm_h : {1.0, 30.0}) {
    const double water_g_m3 = 1e-3 * integral(raindrops(rain_mm_h), sphere_mm3);
    const double expected = 0.089 * std::pow(rain_mm_h, 0.84);
    EXPECT_NEAR(water_g_m3, expected, expected * 0.5 / 89.0);
  }
}

TEST(Weather, FlakesHoldTheWaterOfTheDropsTheyMeltTo) {
  for (const double snow_mm_h : {0.5, 1.0, 5.0}) {
    const Particles melted{.number_1_m3_mm = 3.8e3 * std::pow(snow_mm_h, -0.87),
                           .slope_1_mm = 2.55 * std::pow(snow_mm_h, -0.48)};
    const Particles flakes = snowflakes(snow_mm_h);
    const double water_g_m3 = 1e-3 * integral(melted, sphere_mm3);
    EXPECT_NEAR(0.1e-3 * integral(flakes, sphere_mm3), water_g_m3, 1e-7 * water_g_m3);
    // As many flakes as drops.
    const auto one = [](double) { return 1.0; };
    const double number_1_m3 = integral(melted, one);
    EXPECT_NEAR(integral(flakes, one), number_1_m3, 1e-7 * number_1_m3);
  }
}

TEST(Weather, DropsSendBackWhatRaysTracedThroughASphereDo) {
  constexpr double kIndex = 1.328;
  // Per unit of r², at 1e-4 of the radius off the axis: what is left of higher order is 1e-8, of
  // the difference quotient 1e-6.
  const auto front = [](double b) { return 2.0 * std::asin(b); };
  const auto rear = [](double b) { return 4.0 * std::asin(b / kIndex) - 2.0 * std::asin(b); };
  const auto per_sr = [](const std::function<double(double)>& angle) {
    constexpr double kB = 1e-4;
    constexpr double kStep = 1e-7;
    const double slope = (angle(kB + kStep) - angle(kB - kStep)) / (2.0 * kStep);
    return kB / (std::sin(std::abs(angle(kB))) * std::abs(slope));
  };
  const double fresnel = std::pow(0.328 / 2.328, 2);
  const double sphere =
      fresnel * per_sr(front) + (1.0 - fresnel) * fresnel * (1.0 - fresnel) * per_sr(rear);
  // A flat diffuse disk of radius r: ρ/π · π·r².
  const double disk = raindrops(10.0).reflectivity;
  EXPECT_NEAR(disk, sphere, 1e-5 * sphere);
  EXPECT_GT(disk, 0.02);
}

TEST(Weather, ContrastFallsToATwentiethAtTheVisibility) {
  const Atmosphere fog = steady({.fog_visibility_m = 50.0});
  EXPECT_NEAR(std::exp(-50.0 * fog.extinction_1_m), 0.05, 1e-12);
  EXPECT_NEAR(fog.backscatter_1_m_sr, 0.046 / 50.0, 1e-12);
  const Atmosphere dust = steady({.dust_visibility_m = 20.0});
  EXPECT_NEAR(std::exp(-20.0 * dust.extinction_1_m), 0.05, 1e-12);
  EXPECT_NEAR(dust.extinction_1_m / dust.backscatter_1_m_sr, 45.0, 1e-9);
}

TEST(Weather, EverythingInTheAirAddsUp) {
  const WeatherSpec all{
      .rain_mm_h = 10.0, .snow_mm_h = 1.0, .fog_visibility_m = 300.0, .dust_visibility_m = 700.0};
  const Atmosphere air = steady(all);
  const double expected = extinction_1_m(raindrops(10.0)) + extinction_1_m(snowflakes(1.0)) +
                          std::log(20.0) * (1.0 / 300.0 + 1.0 / 700.0);
  EXPECT_NEAR(air.extinction_1_m, expected, 1e-12);
  EXPECT_NEAR(air.backscatter_1_m_sr, 0.046 / 300.0 + std::log(20.0) / 700.0 / 45.0, 1e-12);
  EXPECT_EQ(air.rain.slope_1_mm, raindrops(10.0).slope_1_mm);
  EXPECT_EQ(air.snow.slope_1_mm, snowflakes(1.0).slope_1_mm);
}

TEST(Weather, ChangesStraightBetweenTheTimesGiven) {
  const Stamp start = stamp_from_seconds(1000.0);
  const Weather weather(
      {{.at_s = 10.0, .rain_mm_h = 4.0},
       {.at_s = 20.0, .rain_mm_h = 12.0, .snow_mm_h = 2.0, .fog_visibility_m = 100.0},
       {.at_s = 40.0, .dust_visibility_m = 60.0}},
      start);
  const auto at = [&](double t_s) { return weather.at(start + duration_from_seconds(t_s)); };
  const double fog_1_m = std::log(20.0) / 100.0;
  const auto extinction = [&](double rain, double snow, double fog, double dust) {
    return (rain > 0.0 ? extinction_1_m(raindrops(rain)) : 0.0) +
           (snow > 0.0 ? extinction_1_m(snowflakes(snow)) : 0.0) + fog * fog_1_m +
           dust * std::log(20.0) / 60.0;
  };
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(at(0.0).extinction_1_m, extinction(4.0, 0.0, 0.0, 0.0), kRounding);
  EXPECT_NEAR(at(10.0).extinction_1_m, extinction(4.0, 0.0, 0.0, 0.0), kRounding);
  EXPECT_NEAR(at(15.0).extinction_1_m, extinction(8.0, 1.0, 0.5, 0.0), kRounding);
  EXPECT_NEAR(at(20.0).extinction_1_m, extinction(12.0, 2.0, 1.0, 0.0), kRounding);
  EXPECT_NEAR(at(35.0).extinction_1_m, extinction(3.0, 0.5, 0.25, 0.75), kRounding);
  EXPECT_NEAR(at(40.0).extinction_1_m, extinction(0.0, 0.0, 0.0, 1.0), kRounding);
  EXPECT_NEAR(at(1e4).extinction_1_m, extinction(0.0, 0.0, 0.0, 1.0), kRounding);
  EXPECT_NEAR(at(15.0).rain.slope_1_mm, raindrops(8.0).slope_1_mm, kRounding);
  EXPECT_NEAR(at(15.0).backscatter_1_m_sr, 0.5 * 0.046 / 100.0, kRounding);
  EXPECT_EQ(at(40.0).rain.number_1_m3_mm, 0.0);
  EXPECT_FALSE(weather.is_clear());
}

TEST(Weather, NothingInTheAirIsClear) {
  EXPECT_TRUE(Weather().is_clear());
  EXPECT_TRUE(Weather().at(stamp_from_seconds(5.0)).is_clear());
  const Weather dry({{.at_s = 0.0}, {.at_s = 10.0, .fog_visibility_m = 1e5}});
  EXPECT_TRUE(dry.is_clear());
  EXPECT_TRUE(dry.at(stamp_from_seconds(5.0)).is_clear());

  const std::vector<WeatherSpec> not_clear = {{.rain_mm_h = 0.01},
                                              {.snow_mm_h = 0.01},
                                              {.fog_visibility_m = 99'999.0},
                                              {.dust_visibility_m = 99'999.0}};
  for (const WeatherSpec& spec : not_clear) {
    EXPECT_FALSE(Weather({spec}).is_clear());
    EXPECT_FALSE(steady(spec).is_clear());
  }
}

TEST(Weather, ValuesOutOfTheirLimitsAreRefused) {
  struct Case {
    WeatherSpec spec;
    std::string key;
  };
  const std::vector<Case> cases = {{{.at_s = -1.0}, "at_s"},
                                   {{.rain_mm_h = -0.1}, "rain_mm_h"},
                                   {{.rain_mm_h = 200.1}, "rain_mm_h"},
                                   {{.rain_mm_h = std::nan("")}, "rain_mm_h"},
                                   {{.snow_mm_h = 50.1}, "snow_mm_h"},
                                   {{.fog_visibility_m = 4.9}, "fog_visibility_m"},
                                   {{.fog_visibility_m = 1.1e5}, "fog_visibility_m"},
                                   {{.dust_visibility_m = 0.0}, "dust_visibility_m"}};
  for (const Case& wrong : cases) {
    EXPECT_THAT(error_of({{.at_s = 0.0}, wrong.spec}), testing::HasSubstr("weather[1]"));
    EXPECT_THAT(error_of({{.at_s = 0.0}, wrong.spec}), testing::HasSubstr(wrong.key));
  }
  EXPECT_EQ(error_of({{.rain_mm_h = 200.0,
                       .snow_mm_h = 50.0,
                       .fog_visibility_m = 5.0,
                       .dust_visibility_m = 5.0}}),
            "");
}

TEST(Weather, TimesThatDoNotRiseAreRefused) {
  const std::string error = error_of({{.at_s = 0.0}, {.at_s = 7.0}, {.at_s = 7.0}});
  EXPECT_THAT(error, testing::HasSubstr("weather[2]: at_s: is 7"));
  EXPECT_THAT(error, testing::HasSubstr("sort"));
}

}  // namespace
}  // namespace locsim::sim
