#include "benchmarks/fidelity/gnss_figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "benchmarks/fidelity/gnss_reference.h"
#include "benchmarks/fidelity/gnss_tables.h"
#include "core/error.h"

namespace locsim::fidelity {
namespace {

SatelliteRecord tracked(int number, double cn0_db_hz, double code_error_m,
                        double rate_error_m_s = 0.0) {
  return {.id = {GnssSystem::gps, number},
          .is_tracked = true,
          .code_error_m = code_error_m,
          .range_rate_error_m_s = rate_error_m_s,
          .cn0_db_hz = cn0_db_hz};
}

EpochRecord epoch_at(int second, std::vector<SatelliteRecord> satellites, double speed_m_s = 5.0) {
  return {.time = stamp_from_seconds(second),
          .s_m = 10.0 * second,
          .speed_m_s = speed_m_s,
          .satellites = std::move(satellites),
          .fix = {}};
}

FixRecord fix_off_by(double east_m, double north_m, double sigma_m) {
  return {.error_m = {east_m, north_m, -2.0},
          .velocity_error_m_s = {0.3, 0.4, 9.0},
          .covariance_m2 = sigma_m * sigma_m * Matrix3d::Identity()};
}

GnssFigures figures_of(std::vector<EpochRecord> epochs) {
  const GnssDrive drive{.epochs = std::move(epochs)};
  return gnss_figures({&drive, 1});
}

TEST(GnssFigures, QuantilesRunLinearlyFromLeastToGreatest) {
  const std::vector<double> values = {4.0, 0.0, 1.0, 3.0, 2.0};
  EXPECT_DOUBLE_EQ(quantile(values, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.9), 3.6);
  EXPECT_DOUBLE_EQ(quantile(values, 1.0), 4.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(GnssFigures, ClassesBeginAtTheirLowerBorders) {
  const GnssFigures figures = figures_of(
      {epoch_at(1, {tracked(1, 19.99, 1.0), tracked(2, 20.0, 2.0), tracked(3, 24.99, 4.0),
                    tracked(4, 40.0, 5.0), tracked(5, 55.0, 7.0)})});
  EXPECT_EQ(figures.classes[0].count, 1U);
  EXPECT_EQ(figures.classes[1].count, 2U);
  EXPECT_EQ(figures.classes[2].count, 0U);
  EXPECT_EQ(figures.classes[5].count, 2U);
  EXPECT_DOUBLE_EQ(figures.classes[1].share, 0.4);
  EXPECT_DOUBLE_EQ(figures.classes[1].median_m, 3.0);
  EXPECT_DOUBLE_EQ(figures.classes[5].median_m, 6.0);
  EXPECT_TRUE(std::isnan(figures.classes[2].p95_m));
  EXPECT_DOUBLE_EQ(figures.cn0_db_hz[2], 24.99);
}

TEST(GnssFigures, QuantilesKeepTheSignAndSharesDoNot) {
  std::vector<SatelliteRecord> satellites;
  for (const double error_m : {-60.0, -20.0, 0.0, 20.0, 60.0}) {
    satellites.push_back(tracked(1 + static_cast<int>(satellites.size()), 30.0, error_m));
  }
  const Cn0Class c = figures_of({epoch_at(1, satellites)}).classes[3];
  EXPECT_DOUBLE_EQ(c.median_m, 0.0);
  EXPECT_DOUBLE_EQ(c.p75_m, 20.0);
  EXPECT_DOUBLE_EQ(c.p95_m, 52.0);
  EXPECT_DOUBLE_EQ(c.beyond_15_m, 0.8);
  EXPECT_DOUBLE_EQ(c.beyond_50_m, 0.4);
}

TEST(GnssFigures, RangeRatesAreToldApartByWhetherTheCarStands) {
  const Cn0Class c = figures_of({epoch_at(1, {tracked(1, 33.0, 0.0, -0.2)}, 0.0),
                                 epoch_at(2, {tracked(1, 33.0, 0.0, 3.0)}, 8.0)})
                         .classes[3];
  EXPECT_DOUBLE_EQ(c.rate_static_m_s, 0.2);
  EXPECT_DOUBLE_EQ(c.rate_moving_m_s, 3.0);
}

TEST(GnssFigures, GapsLastFromTheLastObservationToTheNextAndEndWithTheDrive) {
  SatelliteRecord unheard = tracked(1, 0.0, 0.0);
  unheard.is_tracked = false;
  // Satellite 1 misses one second, then two; satellite 2 never comes back.
  const std::vector<EpochRecord> epochs = {epoch_at(1, {tracked(1, 40, 0), tracked(2, 40, 0)}),
                                           epoch_at(2, {unheard}),
                                           epoch_at(3, {tracked(1, 40, 0)}),
                                           epoch_at(4, {tracked(1, 40, 0)}),
                                           epoch_at(5, {}),
                                           epoch_at(6, {unheard}),
                                           epoch_at(7, {tracked(1, 40, 0)})};
  const GnssFigures figures = figures_of(epochs);
  EXPECT_EQ(figures.gaps, 2U);
  EXPECT_DOUBLE_EQ(figures.gap_p50_s, 2.5);
  EXPECT_DOUBLE_EQ(figures.gap_max_s, 3.0);
  EXPECT_DOUBLE_EQ(figures.satellites_tracked, 5.0 / 7.0);
  EXPECT_DOUBLE_EQ(figures.satellites_above_horizon, 7.0 / 7.0);

  const std::vector<GnssDrive> twice = {{.epochs = epochs}, {.epochs = epochs}};
  EXPECT_EQ(gnss_figures(twice).gaps, 4U);
  EXPECT_EQ(gnss_figures(twice).epochs, 14U);
}

TEST(GnssFigures, ErrorsOfFixesAreThoseOfTheThreeFourFiveTriangle) {
  std::vector<EpochRecord> epochs = {epoch_at(1, {}), epoch_at(2, {}), epoch_at(3, {}),
                                     epoch_at(4, {})};
  epochs[0].fix = fix_off_by(3.0, -4.0, 1.0);
  epochs[1].fix = fix_off_by(0.0, 1.0, 1.0);
  const GnssFigures figures = figures_of(epochs);
  EXPECT_DOUBLE_EQ(figures.availability, 0.5);
  EXPECT_EQ(figures.horizontal_m.count, 2U);
  EXPECT_DOUBLE_EQ(figures.horizontal_m.mean, 3.0);
  EXPECT_DOUBLE_EQ(figures.horizontal_m.deviation, 2.0);
  EXPECT_DOUBLE_EQ(figures.horizontal_m.rms, std::sqrt(13.0));
  EXPECT_DOUBLE_EQ(figures.horizontal_m.max, 5.0);
  EXPECT_DOUBLE_EQ(figures.vertical_m.p50, 2.0);
  EXPECT_DOUBLE_EQ(figures.horizontal_velocity_m_s.p50, 0.5);
  // (25 + 1) / 2 over σ² east and north, 1 m² each.
  EXPECT_DOUBLE_EQ(figures.overconfidence, 6.5);
  // From the fix at 2 s to the end at 4 s.
  EXPECT_DOUBLE_EQ(figures.longest_without_fix_s, 1.0);
}

TEST(GnssFigures, WithoutAnyFixTheWholeDriveIsAGap) {
  const GnssFigures figures = figures_of({epoch_at(1, {}), epoch_at(2, {}), epoch_at(3, {})});
  EXPECT_DOUBLE_EQ(figures.availability, 0.0);
  EXPECT_DOUBLE_EQ(figures.longest_without_fix_s, 2.0);
  EXPECT_TRUE(std::isnan(figures.horizontal_m.rms));
  EXPECT_THROW((void)gnss_figures({}), InputError);
}

TEST(GnssFigures, TunnelsCountFixesInsideAndTheTimeAfterThem) {
  std::vector<EpochRecord> epochs;
  for (int second = 1; second <= 12; ++second) epochs.push_back(epoch_at(second, {}));
  epochs[1].fix = fix_off_by(0.0, 0.0, 1.0);
  epochs[4].fix = fix_off_by(1.0, 0.0, 1.0);
  epochs[10].fix = fix_off_by(0.0, 7.0, 1.0);
  epochs[11].fix = fix_off_by(0.0, 1.0, 1.0);
  // From 30 to 80 m, that is from 3 s to 8 s, of which 5, 6 s are inside by more than 15 m.
  const TunnelFigures figures = tunnel_figures({.epochs = epochs}, 30.0, 80.0, 15.0);
  EXPECT_EQ(figures.epochs_inside, 2U);
  EXPECT_EQ(figures.fixes_inside, 1U);
  EXPECT_DOUBLE_EQ(figures.until_fix_s, 3.0);
  EXPECT_DOUBLE_EQ(figures.first_error_m, 7.0);
}

TEST(GnssReference, FactorsAreOneForTheRealFiguresThemselves) {
  std::array<Cn0Class, kCn0Classes> ours = urbannav_hk().classes;
  for (Cn0Class& c : ours) c.count = 1;
  const auto factors = class_factors(urbannav_hk().classes, ours);
  for (const ClassFactors& f : factors) {
    EXPECT_DOUBLE_EQ(f.worst, 1.0);
    EXPECT_DOUBLE_EQ(f.typical, 1.0);
  }
  EXPECT_TRUE(verdict(factors, &ClassFactors::worst).is_met());
  // Medians count where the real one is more than the zero of the clock: 31, 26 and 6 m.
  EXPECT_FALSE(std::isnan(factors[2].median));
  EXPECT_TRUE(std::isnan(factors[3].median));
}

TEST(GnssReference, FactorsAreTheSameForTooMuchAndTooLittle) {
  EXPECT_DOUBLE_EQ(factor(30.0, 20.0, 1.0), 1.5);
  EXPECT_DOUBLE_EQ(factor(20.0, 30.0, 1.0), 1.5);
  // What is negligible, or has the wrong sign, counts as the limit.
  EXPECT_DOUBLE_EQ(factor(0.3, 0.6, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(factor(6.0, -8.0, 1.0), 6.0);
  EXPECT_TRUE(std::isnan(factor(kNoFigure, 1.0, 1.0)));
}

TEST(GnssReference, OneFigureMadeWorseShowsInItsClassAndInTheVerdict) {
  std::array<Cn0Class, kCn0Classes> ours = urbannav_hk().classes;
  for (Cn0Class& c : ours) c.count = 1;
  ours[0].p95_m *= 1.8;
  ours[1].median_m *= 1.8;
  auto factors = class_factors(urbannav_hk().classes, ours);
  EXPECT_DOUBLE_EQ(factors[0].worst, 1.8);
  EXPECT_NEAR(factors[0].typical, std::pow(1.8, 0.2), 1e-12);
  Verdict result = verdict(factors, &ClassFactors::worst);
  EXPECT_EQ(result.within_1_5, 4);
  EXPECT_EQ(result.within_2, 6);
  EXPECT_TRUE(result.is_met());

  ours[5].beyond_15_m = 0.07;
  factors = class_factors(urbannav_hk().classes, ours);
  result = verdict(factors, &ClassFactors::worst);
  EXPECT_EQ(result.within_1_5, 3);
  EXPECT_EQ(result.within_2, 5);
  EXPECT_FALSE(result.is_met());
  EXPECT_TRUE(verdict(factors, &ClassFactors::typical).is_met());
}

TEST(GnssReference, AClassWithoutObservationsFails) {
  std::array<Cn0Class, kCn0Classes> ours = urbannav_hk().classes;
  for (Cn0Class& c : ours) c.count = 1;
  ours[0] = {};
  const auto factors = class_factors(urbannav_hk().classes, ours);
  EXPECT_FALSE(verdict(factors, &ClassFactors::worst).is_met());
  EXPECT_FALSE(verdict(factors, &ClassFactors::typical).is_met());
}

TEST(GnssTables, ShowOursBesideTheRealFigures) {
  std::vector<EpochRecord> epochs = {
      epoch_at(1, {tracked(1, 18.0, 40.0, 1.0), tracked(2, 43.0, -0.2, 0.1)})};
  epochs[0].fix = fix_off_by(3.0, -4.0, 1.0);
  const GnssDrive drive{.epochs = epochs};
  const GnssFigures figures = gnss_figures({&drive, 1});
  const std::string text = canyon_tables(figures);
  EXPECT_NE(text.find("| <20 | 1 (50 %) | 0 % | 40.0 / 31.0 | 40.0 / 61.0 | 40.0 / 96.0 |"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("| 20–25 | 0 (0 %) | – | – / 26.0 |"), std::string::npos) << text;
  EXPECT_NE(text.find("not met"), std::string::npos);
  EXPECT_NE(observations_csv({&drive, 1})
                .find("\n0,1.000,10.0,5.00,G01,0.0,0,0,0,0.0,0.0,18.00,40.000,1.0000\n0,1.000,"),
            std::string::npos);
  EXPECT_NE(fixes_csv({&drive, 1}).find("\n0,1.000,10.0,5.00,1,3.000,-4.000,-2.000,1.414,0.5000\n"),
            std::string::npos);
  EXPECT_NE(open_sky_table(figures, "ublox_m8t").find("| 5.00 | 2.5 |"), std::string::npos);
}

}  // namespace
}  // namespace locsim::fidelity
