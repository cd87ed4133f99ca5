#include "sim/gnss/correlator.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/physics.h"
#include "sim/gnss/correlator_noise.h"

namespace locsim::sim {
namespace {

constexpr double kInfinite_hz = std::numeric_limits<double>::infinity();

double triangle(double chips) {
  return std::max(0.0, 1.0 - std::abs(chips));
}

// As a sum of triangles of half a chip: that of the subcarrier's pulses.
double boc(double chips) {
  return triangle(2.0 * chips) - 0.5 * (triangle(2.0 * chips - 1.0) + triangle(2.0 * chips + 1.0));
}

// The unlimited correlation through an ideal filter: convolved with its impulse response.
double filtered(double (*correlation)(double), double bandwidth_chips, double delay_chips) {
  constexpr int kSteps = 10'000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double u = -1.0 + 2.0 * (i + 0.5) / kSteps;
    const double x = std::numbers::pi * bandwidth_chips * (delay_chips - u);
    sum += correlation(u) * (std::abs(x) < 1e-12 ? 1.0 : std::sin(x) / x);
  }
  return sum;
}

TEST(Correlator, ChipsAreThoseOfTheSignals) {
  EXPECT_NEAR(modulation_of(GnssSystem::gps).chip_m(), 293.05, 0.01);
  EXPECT_NEAR(modulation_of(GnssSystem::galileo).chip_m(), 293.05, 0.01);
  EXPECT_NEAR(modulation_of(GnssSystem::glonass).chip_m(), 586.68, 0.01);
  EXPECT_NEAR(modulation_of(GnssSystem::beidou).chip_m(), 146.53, 0.01);
  EXPECT_TRUE(modulation_of(GnssSystem::galileo).is_boc);
  EXPECT_NEAR(modulation_of(GnssSystem::galileo).peak_m(), 97.68, 0.01);
}

TEST(Correlator, UnlimitedBandGivesTheSharpShapes) {
  // Straight pieces between points that hold the corners: exact but for rounding.
  for (const GnssSystem system : {GnssSystem::gps, GnssSystem::galileo, GnssSystem::beidou}) {
    const Modulation modulation = modulation_of(system);
    const Correlation correlation(modulation, kInfinite_hz);
    for (double chips = -1.7; chips < 1.7; chips += 0.0137) {
      const double expected = modulation.is_boc ? boc(chips) : triangle(chips);
      EXPECT_NEAR(correlation.at(chips * modulation.chip_m()), expected, 1e-12) << chips;
    }
  }
}

TEST(Correlator, LimitedBandGivesTheFilteredShapes) {
  // Between points 1/1024 chip apart it is straight: that errs by R''/8·1024⁻² < 1e-5, R'' < 60 at
  // these bandwidths; the sum of `filtered` by as little.
  for (const double bandwidth_hz : {2e6, 8e6, 24e6}) {
    for (const GnssSystem system : {GnssSystem::gps, GnssSystem::galileo, GnssSystem::glonass}) {
      const Modulation modulation = modulation_of(system);
      const Correlation correlation(modulation, bandwidth_hz);
      const double band = bandwidth_hz / modulation.chip_rate_hz;
      double (*shape)(double) = modulation.is_boc ? &boc : &triangle;
      const double peak = filtered(shape, band, 0.0);
      EXPECT_EQ(correlation.at(0.0), 1.0);
      for (double chips = -1.9; chips < 1.9; chips += 0.1913) {
        EXPECT_NEAR(correlation.at(chips * modulation.chip_m()),
                    filtered(shape, band, chips) / peak, 3e-5)
            << bandwidth_hz << " Hz, " << chips << " chips";
      }
    }
  }
}

TEST(Correlator, BeyondTwoChipsThereIsNothing) {
  const Modulation gps = modulation_of(GnssSystem::gps);
  const Correlation correlation(gps, 8e6);
  EXPECT_EQ(correlation.at(2.01 * gps.chip_m()), 0.0);
  EXPECT_EQ(correlation.at(-1e9), 0.0);
  EXPECT_EQ(correlation.at(std::numeric_limits<double>::quiet_NaN()), 0.0);
}

TEST(Correlator, TablesAreShared) {
  const Modulation gps = modulation_of(GnssSystem::gps);
  EXPECT_EQ(shared_correlation(gps, 8e6), shared_correlation(gps, 8e6));
  EXPECT_NE(shared_correlation(gps, 8e6), shared_correlation(gps, 9e6));
  EXPECT_NE(shared_correlation(gps, 8e6),
            shared_correlation(modulation_of(GnssSystem::galileo), 8e6));
}

TEST(Correlator, RefusesABandThatIsNone) {
  const Modulation gps = modulation_of(GnssSystem::gps);
  for (const double bad : {0.0, -8e6, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(Correlation(gps, bad), InputError);
    EXPECT_THROW((void)shared_correlation(gps, bad), InputError);
  }
}

TEST(CorrelatorNoise, IsCorrelatedAsTheSignalIs) {
  for (const double bandwidth_hz : {kInfinite_hz, 8e6}) {
    for (const double spacing : {1.0, 0.5, 0.1}) {
      const Modulation gps = modulation_of(GnssSystem::gps);
      const Correlation correlation(gps, bandwidth_hz);
      const double spacing_m = spacing * gps.chip_m();
      const CorrelatorNoise noise(correlation, spacing_m);
      const RandomStream stream(3, "noise");
      Eigen::Matrix3cd covariance = Eigen::Matrix3cd::Zero();
      constexpr int kDraws = 50'000;
      double opposite = 0.0;
      for (int k = 0; k < kDraws; ++k) {
        const Correlators n = noise.draw(stream, k);
        const Eigen::Vector3cd v(n.early, n.prompt, n.late);
        covariance += v * v.adjoint() / double{kDraws};
        opposite += std::norm(n.early - n.late) / double{kDraws};
      }
      // Mean of products of unit power: σ = 1/√N = 0.0045 at most; five of them over 60 checks.
      const double half = correlation.at(0.5 * spacing_m);
      const double whole = correlation.at(spacing_m);
      Eigen::Matrix3d expected;
      expected << 1.0, half, whole, half, 1.0, half, whole, half, 1.0;
      EXPECT_LT((covariance - expected.cast<std::complex<double>>()).cwiseAbs().maxCoeff(), 0.0225)
          << spacing;
      // What code loops live by, to its own five sigmas.
      EXPECT_NEAR(opposite / (2.0 * (1.0 - whole)), 1.0, 0.0225) << spacing;
    }
  }
}

}  // namespace
}  // namespace locsim::sim
