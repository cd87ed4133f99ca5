#include "sim/gnss/ionosphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/physics.h"

namespace locsim::sim {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr GeodeticPoint kHongKong{22.3 * kDegree, 114.17 * kDegree, 10.0};
constexpr GeodeticPoint kKarlsruhe{49.0 * kDegree, 8.4 * kDegree, 115.0};
const GpsTime kNoon = GpsTime::from_utc("2026-06-01T04:00:00Z");

// The steps of IS-GPS-200, figure 20-4, in their order and with their names.
double by_figure_20_4(const KlobucharModel& model, const GeodeticPoint& place, double azimuth_rad,
                      double elevation_rad, double gps_time_s) {
  const double pi = std::numbers::pi;
  const double e = elevation_rad / pi;
  const double psi = 0.0137 / (e + 0.11) - 0.022;
  double phi_i = place.latitude_rad / pi + psi * std::cos(azimuth_rad);
  if (phi_i > 0.416) phi_i = 0.416;
  if (phi_i < -0.416) phi_i = -0.416;
  const double lambda_i =
      place.longitude_rad / pi + psi * std::sin(azimuth_rad) / std::cos(phi_i * pi);
  const double phi_m = phi_i + 0.064 * std::cos((lambda_i - 1.617) * pi);
  double t = 4.32e4 * lambda_i + gps_time_s;
  while (t >= 86400.0) t -= 86400.0;
  while (t < 0.0) t += 86400.0;
  const double f = 1.0 + 16.0 * std::pow(0.53 - e, 3);
  double per = 0.0;
  double amp = 0.0;
  for (std::size_t n = 0; n < 4; ++n) {
    per += model.beta[n] * std::pow(phi_m, static_cast<double>(n));
    amp += model.alpha[n] * std::pow(phi_m, static_cast<double>(n));
  }
  if (per < 72000.0) per = 72000.0;
  if (amp < 0.0) amp = 0.0;
  const double x = 2.0 * pi * (t - 50400.0) / per;
  const double t_iono = std::abs(x) < 1.57
                            ? f * (5.0e-9 + amp * (1.0 - x * x / 2.0 + std::pow(x, 4) / 24.0))
                            : f * 5.0e-9;
  return kSpeedOfLight_m_s * t_iono;
}

TEST(Klobuchar, IsThatOfTheSpecificationAllOverTheEarth) {
  const KlobucharModel model = Ionosphere(false, 1).broadcast();
  double least_m = 1e9;
  double most_m = 0.0;
  for (int latitude = -90; latitude <= 90; latitude += 18) {
    for (int longitude = -180; longitude <= 180; longitude += 45) {
      for (int hour = 0; hour < 24; hour += 3) {
        for (int azimuth = 0; azimuth < 360; azimuth += 60) {
          for (const int elevation : {1, 15, 50, 90}) {
            const GeodeticPoint place{latitude * kDegree, longitude * kDegree, 0.0};
            const GpsTime time = GpsTime{.week = 2420} + hours(3 * 24 + hour);
            const double delay_m =
                model.delay_m(place, azimuth * kDegree, elevation * kDegree, time);
            // Rounding, in another order.
            ASSERT_NEAR(
                delay_m,
                by_figure_20_4(model, place, azimuth * kDegree, elevation * kDegree, 3600.0 * hour),
                1e-9);
            least_m = std::min(least_m, delay_m);
            most_m = std::max(most_m, delay_m);
          }
        }
      }
    }
  }
  EXPECT_NEAR(least_m, 1.5, 0.01);
  EXPECT_GT(most_m, 10.0);
}

TEST(Klobuchar, GivesThePublishedExample) {
  // 40° N, 260° E, towards 210°, 20° up, at 593 100 s of the week: 23.784 m by the example that
  // goes with M. Mahooti's program (the result from memory).
  const KlobucharModel model{.alpha = {0.3820e-7, 0.1490e-7, -0.1790e-6, 0.0},
                             .beta = {0.1430e6, 0.0, -0.3280e6, 0.1130e6}};
  const GeodeticPoint place{40.0 * kDegree, 260.0 * kDegree, 0.0};
  const GpsTime time = GpsTime{.week = 1042} + seconds(593100);
  EXPECT_NEAR(model.delay_m(place, 210.0 * kDegree, 20.0 * kDegree, time), 23.784, 0.001);
}

TEST(Klobuchar, IsFiveNanosecondsByNightAndMostAtTwoInTheAfternoon) {
  const KlobucharModel model = Ionosphere(false, 1).broadcast();
  const auto zenith_m = [&](double local_h) {
    const double utc_h = local_h - 114.17 / 15.0;
    const GpsTime time = GpsTime{.week = 2420} + hours(24) + duration_from_seconds(3600.0 * utc_h);
    return model.delay_m(kHongKong, 0.0, 90.0 * kDegree, time);
  };
  // Overhead the slant factor is 1 + 16·0.03³.
  EXPECT_NEAR(zenith_m(2.0), 5e-9 * kSpeedOfLight_m_s * 1.000432, 1e-9);
  // It pierces the layer a third of a kilometre from overhead: less than a second of local time.
  for (const double later_h : {0.5, 1.0, 3.0, 4.5}) {
    EXPECT_GT(zenith_m(14.0), zenith_m(14.0 + later_h) + 0.01);
    EXPECT_NEAR(zenith_m(14.0 + later_h), zenith_m(14.0 - later_h), 1e-3);
  }
  EXPECT_NEAR(zenith_m(14.0), 4.7, 0.3);
}

TEST(Klobuchar, SeesNothingBelowTheHorizon) {
  const Ionosphere sky(true, 1);
  EXPECT_EQ(sky.broadcast().delay_m(kHongKong, 1.0, 0.0, kNoon), 0.0);
  EXPECT_EQ(sky.delay_m(kHongKong, 1.0, -0.3, kNoon), 0.0);
}

TEST(Ionosphere, WithoutErrorsIsTheModel) {
  const Ionosphere sky(false, 1);
  const double delay_m = sky.delay_m(kHongKong, 1.0, 0.5, kNoon);
  EXPECT_GT(delay_m, 3.0);
  EXPECT_EQ(delay_m, sky.broadcast().delay_m(kHongKong, 1.0, 0.5, kNoon));
}

// Delay over that of the model, over many seeds.
std::vector<double> factors(const GeodeticPoint& place, GpsTime time) {
  std::vector<double> all;
  for (std::uint64_t seed = 1; seed <= 10000; ++seed) {
    const Ionosphere sky(true, seed);
    all.push_back(sky.delay_m(place, 0.4, 1.2, time) /
                  sky.broadcast().delay_m(place, 0.4, 1.2, time));
  }
  return all;
}

double mean_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - 1.0) * (b[i] - 1.0);
  return sum / static_cast<double>(a.size());
}

TEST(Ionosphere, DiffersFromTheModelByFortyPercent) {
  const std::vector<double> here = factors(kHongKong, kNoon);
  double sum = 0.0;
  for (const double factor : here) {
    EXPECT_GT(factor, 0.0);
    sum += factor;
  }
  // Of 10 000: the mean within 0.4/100; the variance, of a log-normal with kurtosis 6, within
  // √(5/10 000) = 2.2 % of 0.16; four of them.
  EXPECT_NEAR(sum / 10000.0, 1.0, 0.016);
  EXPECT_NEAR(mean_product(here, here), 0.16, 0.015);
}

TEST(Ionosphere, IsAlikeNearbyAndHalfAlikeFarAway) {
  const std::vector<double> here = factors(kHongKong, kNoon);
  const GeodeticPoint near{kHongKong.latitude_rad + 0.02, kHongKong.longitude_rad, 0.0};
  // 127 km: of the field's variance 1 − (4·0.02)²/4 is common, 0.16 % of it is not.
  const std::vector<double> nearby = factors(near, kNoon);
  double squares = 0.0;
  for (std::size_t i = 0; i < here.size(); ++i) squares += std::pow(here[i] - nearby[i], 2.0);
  // Var(a − b) = 2·0.148·(1 − ρ) for the logarithms, about that times e^(s²) for the factors.
  EXPECT_LT(squares / 10000.0, 2.0 * 0.16 * 0.0016 * 1.5);
  EXPECT_GT(squares, 0.0);
  // Half the variance of the logarithm: (e^(0.148/2) − 1) = 0.077.
  EXPECT_NEAR(mean_product(here, factors(kKarlsruhe, kNoon)), 0.077, 0.012);
  // Far in time nothing is alike; products are within 0.16/100; four of them.
  EXPECT_NEAR(mean_product(here, factors(kHongKong, kNoon + hours(24))), 0.0, 0.0064);
}

TEST(Ionosphere, ChangesSlowlyAndBySeedAlone) {
  const Ionosphere sky(true, 7);
  const Ionosphere same(true, 7);
  const auto log_factor = [&](GpsTime time) {
    return std::log(sky.delay_m(kHongKong, 2.0, 0.6, time) /
                    sky.broadcast().delay_m(kHongKong, 2.0, 0.6, time));
  };
  double least = 1e9;
  double most = -1e9;
  for (int minute = 24 * 60; minute-- > 0;) {
    const GpsTime time = kNoon + minutes(minute);
    // 0.385, whose rate's RMS is 1.33 in two hours at most; five of them.
    EXPECT_NEAR(log_factor(time + seconds(1)), log_factor(time), 5.0 * 0.385 * 1.33 / 7200.0);
    EXPECT_EQ(same.delay_m(kHongKong, 2.0, 0.6, time), sky.delay_m(kHongKong, 2.0, 0.6, time));
    least = std::min(least, log_factor(time));
    most = std::max(most, log_factor(time));
  }
  EXPECT_GT(most, least + 0.385);
  EXPECT_NE(Ionosphere(true, 8).delay_m(kHongKong, 2.0, 0.6, kNoon),
            sky.delay_m(kHongKong, 2.0, 0.6, kNoon));
}

}  // namespace
}  // namespace locsim::sim
