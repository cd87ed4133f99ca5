#include "sim/gnss/fresnel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace locsim::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

double loss_db(std::complex<double> field) {
  return -20.0 * std::log10(std::abs(field));
}

TEST(Fresnel, LossesAreThoseOfThePublishedConstants) {
  // Concrete 5.24, 0.066 S/m and glass 6.31, 0.0066 S/m at L1, worked out apart and rounded to
  // 0.1 dB below 20 dB or to a decibel: half of that, and as much for the third digit.
  struct Row {
    const char* name;
    double grazing_deg, co_db, cross_db, co_within_db;
  };
  for (const Row& row : {Row{"concrete", 10, 4.2, 12.8, 0.1}, Row{"concrete", 30, 11.8, 8.7, 0.1},
                         Row{"concrete", 45, 18.0, 8.2, 0.6}, Row{"concrete", 60, 26.0, 8.1, 0.6},
                         Row{"glass", 10, 4.3, 12.0, 0.1}, Row{"glass", 30, 11.9, 8.0, 0.1},
                         Row{"glass", 45, 18.0, 7.5, 0.6}, Row{"glass", 60, 26.0, 7.3, 0.6}}) {
    SCOPED_TRACE(std::string(row.name) + " " + std::to_string(row.grazing_deg));
    const CircularReflection field =
        reflect_circular(radio_material(row.name), row.grazing_deg * kDegree, kL1Wavelength_m);
    EXPECT_NEAR(loss_db(field.co), row.co_db, row.co_within_db);
    EXPECT_NEAR(loss_db(field.cross), row.cross_db, 0.1);
  }
}

TEST(Fresnel, MetalTurnsTheSenseOfRotationAndLosesNothing) {
  for (const double grazing_deg : {10.0, 30.0, 60.0, 90.0}) {
    const CircularReflection field =
        reflect_circular(radio_material("metal"), grazing_deg * kDegree, kL1Wavelength_m);
    // √(2 ω ε0/σ) / sin 10° = 0.002 is what steel keeps from being perfect.
    EXPECT_NEAR(std::abs(field.cross), 1.0, 0.003);
    EXPECT_LT(std::abs(field.co), 0.003);
  }
}

TEST(Fresnel, VerticalFieldVanishesAtBrewstersAngle) {
  const RadioMaterial lossless{.relative_permittivity = 4.0, .conductivity_s_m = 0.0};
  const double brewster_rad = std::atan(1.0 / std::sqrt(4.0));
  EXPECT_LT(std::abs(reflect_linear(lossless, brewster_rad, kL1Wavelength_m).vertical), 1e-12);
  // Head on |Γ| = (√ε − 1)/(√ε + 1), grazing all of it.
  const LinearReflection head_on =
      reflect_linear(lossless, 0.5 * std::numbers::pi, kL1Wavelength_m);
  EXPECT_NEAR(head_on.horizontal.real(), -1.0 / 3.0, 1e-12);
  EXPECT_NEAR(head_on.vertical.real(), 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(std::abs(reflect_linear(lossless, 0.0, kL1Wavelength_m).vertical), 1.0, 1e-12);
}

TEST(Fresnel, KnifeEdgeTakesSixDecibelsOnTheBoundaryAndTwentyDeepInTheShadow) {
  // |F(0)| = 1/2 exactly; deep in the shadow |F| → 1/(√2 π v). The formula is good to 0.2 dB.
  EXPECT_NEAR(knife_edge_loss_db(0.0), 20.0 * std::log10(2.0), 0.2);
  EXPECT_NEAR(knife_edge_loss_db(3.0),
              20.0 * std::log10(std::numbers::sqrt2 * 3.0 * std::numbers::pi), 0.3);
  EXPECT_EQ(knife_edge_loss_db(-0.78), 0.0);
  EXPECT_NEAR(knife_edge_loss_db(-0.7799), 0.0, 0.05);
}

TEST(Fresnel, WhatAWallScattersItsMirrorImageLacks) {
  int dark = 0;
  for (const double scattering : {0.0, 0.2, 0.3, 0.45}) {
    for (const char* name : {"concrete", "glass", "metal", "wood"}) {
      for (const double grazing_deg : {3.0, 20.0, 50.0, 90.0}) {
        RadioMaterial material = radio_material(name);
        material.scattering = scattering;
        const double grazing_rad = grazing_deg * kDegree;
        const auto smooth = reflect_circular(material, grazing_rad, kL1Wavelength_m);
        const auto rough = reflect_rough(material, grazing_rad, kL1Wavelength_m);
        const double before = std::norm(smooth.co) + std::norm(smooth.cross);
        const double after = std::norm(rough.co) + std::norm(rough.cross);
        SCOPED_TRACE(std::string(name) + " " + std::to_string(grazing_deg));
        // Energy: nothing is left where more is scattered than a smooth wall would send back.
        EXPECT_NEAR(after, std::max(0.0, before - scattering * scattering), 1e-12);
        // Both senses lose alike, and no phase: co over cross stays.
        EXPECT_LT(std::abs(rough.co * smooth.cross - rough.cross * smooth.co), 1e-12);
        EXPECT_GE((rough.cross * std::conj(smooth.cross)).real(), 0.0);
        EXPECT_NEAR((rough.cross * std::conj(smooth.cross)).imag(), 0.0, 1e-12);
        if (after == 0.0) ++dark;
      }
    }
  }
  // Glass, concrete and wood head on send back 0.03 to 0.19.
  EXPECT_GT(dark, 2);
  EXPECT_LT(dark, 16);
}

TEST(Fresnel, WallsScatterAndRoadsDoNot) {
  for (const char* name : {"concrete", "brick", "glass", "coated_glass"}) {
    EXPECT_GT(radio_material(name).scattering, 0.1) << name;
    EXPECT_LT(radio_material(name).scattering, 0.5) << name;
  }
  EXPECT_EQ(radio_material("grass").scattering, 0.0);
  // The metal on a pane is what mirrors.
  EXPECT_EQ(radio_material("coated_glass").conductivity_s_m,
            radio_material("metal").conductivity_s_m);
}

TEST(Fresnel, FoliageIsToldFromWhatReflects) {
  EXPECT_TRUE(radio_material("foliage").is_foliage);
  EXPECT_FALSE(radio_material("glass").is_foliage);
  EXPECT_EQ(radio_material("nothing known").relative_permittivity,
            radio_material("concrete").relative_permittivity);
}

}  // namespace
}  // namespace locsim::sim
