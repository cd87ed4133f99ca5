#include "sim/magnetometer/steel_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.h"

namespace locsim::sim {
namespace {

const Vector3d kNoField = Vector3d::Zero();
// About that of 49° north: east, north, up.
const Vector3d kEarth_T{1.2e-6, 20.6e-6, -44.0e-6};

World world_of(std::vector<SteelBody> steel) {
  World world;
  world.steel = std::move(steel);
  return world;
}

SteelField standing(const World& world, const Vector3d& earth_T, std::uint64_t seed = 1) {
  return {world, {}, earth_T, seed};
}

/// Moment of a dipole at `offset` = (0, d, 0) from it: B = μ₀/4π·(3·m_y·ŷ − m)/d³.
Vector3d moment_beside(const Vector3d& field_T, double d) {
  return 1e7 * d * d * d * Vector3d(-field_T.x(), 0.5 * field_T.y(), -field_T.z());
}

TEST(DipoleField, OnAxisAndBesideItHaveTheirClosedForms) {
  const Vector3d moment{0.0, 0.0, 300.0};
  // μ₀/4π·2·m/r³ along the moment, −μ₀/4π·m/r³ beside it.
  EXPECT_LT((dipole_field_T(moment, {0, 0, 2}, 0.5) - Vector3d(0, 0, 7.5e-6)).norm(), 1e-18);
  EXPECT_LT((dipole_field_T(moment, {2, 0, 0}, 0.5) - Vector3d(0, 0, -3.75e-6)).norm(), 1e-18);
  // At 45°: (3·(m/√2)·r̂ − m)/r³ has 1.5·m across the axis and 0.5·m along it.
  const Vector3d diagonal = dipole_field_T(moment, Vector3d(1, 0, 1) * std::numbers::sqrt2, 0.5);
  EXPECT_LT((diagonal - Vector3d(5.625e-6, 0, 1.875e-6)).norm(), 1e-17);
}

TEST(DipoleField, HasNeitherSourcesNorCurlsOutsideItsBody) {
  const Vector3d moment{120.0, -70.0, 200.0};
  const Vector3d at{1.1, -1.7, 0.9};
  constexpr double kStep = 1e-4;
  Matrix3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d step = kStep * Vector3d::Unit(axis);
    gradient.col(axis) =
        (dipole_field_T(moment, at + step, 1.0) - dipole_field_T(moment, at - step, 1.0)) /
        (2.0 * kStep);
  }
  // Third derivatives are of the order B/r³·60: 1e-5·60·kStep²/6 = 1e-12 T/m; entries are 1e-6.
  EXPECT_GT(gradient.cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_NEAR(gradient.trace(), 0.0, 1e-12);
  EXPECT_LT((gradient - gradient.transpose()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(DipoleField, StaysBoundedWithinItsBody) {
  const Vector3d moment{0.0, 0.0, 300.0};
  constexpr double kRadius = 1.3;
  // The demagnetising field of a magnetised ball, −μ₀·M/3.
  const double inside = -4e-7 * std::numbers::pi * 300.0 / (4.0 * std::numbers::pi / 3.0) /
                        (kRadius * kRadius * kRadius) / 3.0;
  EXPECT_NEAR(dipole_field_T(moment, Vector3d::Zero(), kRadius).z(), inside, 1e-18);
  const double largest = dipole_field_T(moment, {0, 0, kRadius}, kRadius).norm();
  for (double r = 0.0; r < 3.0; r += 0.01) {
    const Vector3d at = r * Vector3d(0.6, 0.0, 0.8);
    EXPECT_LE(dipole_field_T(moment, at, kRadius).norm(), largest);
  }
  const Vector3d just_in = dipole_field_T(moment, (kRadius - 1e-9) * Vector3d::UnitX(), kRadius);
  const Vector3d just_out = dipole_field_T(moment, (kRadius + 1e-9) * Vector3d::UnitX(), kRadius);
  EXPECT_LT((just_in - just_out).norm(), 1e-12);
}

TEST(SteelField, InducedPartLiesAlongTheEarthFieldAndGrowsWithMass) {
  const Vector3d body{10.0, -5.0, 1.0};
  const Vector3d at = body + Vector3d(0.0, 4.0, 0.0);
  for (const double mass_kg : {200.0, 1000.0}) {
    const World world = world_of({{body, mass_kg}});
    // Permanent moments are those of the seed whatever the earth's field.
    const Vector3d induced =
        standing(world, kEarth_T).at(at, {}) - standing(world, kNoField).at(at, {});
    const Vector3d moment = moment_beside(induced, 4.0);
    EXPECT_LT((moment - 3000.0 * mass_kg * kEarth_T).norm(), 1e-9 * moment.norm());
  }
}

TEST(SteelField, TonneOfSteelDisturbsAsTheRuleOfThumbSays) {
  // 1 nT at 30 m by induction (Geometrics), within the factor two between beside and on axis.
  const double moment = steel::kInduced_A_m2_kg_T * 1000.0 * 50e-6;
  const double beside_nT = 1e9 * dipole_field_T({0, 0, moment}, {30, 0, 0}, 1.0).norm();
  const double axis_nT = 1e9 * dipole_field_T({0, 0, moment}, {0, 0, 30}, 1.0).norm();
  EXPECT_LE(beside_nT, 1.0);
  EXPECT_GE(axis_nT, 1.0);
}

TEST(SteelField, PermanentPartsAreDrawnForEachBodyInAllDirections) {
  constexpr std::size_t kBodies = 3000;
  constexpr double kMass_kg = 500.0;
  std::vector<SteelBody> bodies;
  // So far apart that none reaches another's probe.
  for (std::size_t i = 0; i < kBodies; ++i) {
    bodies.push_back({Vector3d(100.0 * static_cast<double>(i), 0.0, 0.0), kMass_kg});
  }
  const World world = world_of(bodies);
  const SteelField field = standing(world, kNoField, 3);
  const SteelField other = standing(world, kNoField, 4);
  Vector3d mean = Vector3d::Zero();
  double square = 0.0;
  for (const SteelBody& body : bodies) {
    const Vector3d probe = body.position + Vector3d(0.0, 3.0, 0.0);
    const Vector3d moment = moment_beside(field.at(probe, {}), 3.0) / kMass_kg;
    mean += moment / kBodies;
    square += moment.squaredNorm() / kBodies;
    EXPECT_NE(field.at(probe, {}), other.at(probe, {}));
  }
  // 9000 normal draws: 4·√(2/9000) = 6 %; each mean 4·(0.3/√3)/√3000.
  EXPECT_NEAR(square / (0.3 * 0.3), 1.0, 0.06);
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.0127);
}

TEST(SteelField, ThousandBodiesAddUpToTheSumOfEach) {
  constexpr std::size_t kBodies = 1000;
  const RandomStream draw(5, "test/steel");
  std::vector<SteelBody> bodies;
  for (std::size_t i = 0; i < kBodies; ++i) {
    bodies.push_back(
        {{draw.uniform(-200, 200, i, 0), draw.uniform(-200, 200, i, 1), draw.uniform(0, 6, i, 2)},
         draw.uniform(10, 3000, i, 3)});
  }
  const SteelField field = standing(world_of(bodies), kEarth_T);
  std::vector<SteelField> alone;
  for (std::size_t i = 0; i < kBodies; ++i) {
    // Those without mass keep the others' places in the draw.
    std::vector<SteelBody> one(i + 1);
    one[i] = bodies[i];
    alone.push_back(standing(world_of(one), kEarth_T));
  }
  double largest = 0.0;
  for (std::size_t k = 0; k < 40; ++k) {
    const Vector3d at{draw.uniform(-220, 220, k, 10), draw.uniform(-220, 220, k, 11), 1.5};
    Vector3d sum = Vector3d::Zero();
    for (const SteelField& one : alone) sum += one.at(at, {});
    largest = std::max(largest, sum.norm());
    // The same terms in the same order.
    EXPECT_LT((field.at(at, {}) - sum).norm(), 1e-18);
  }
  EXPECT_GT(largest, 1e-7);
}

TEST(SteelField, OnlyNegligibleFieldsAreLeftOut) {
  for (int i = 0; i < 32; ++i) {
    // Near two corners of a square of the index.
    const Vector3d body = i % 2 == 0 ? Vector3d(1.0, 1.0, 0.5) : Vector3d(15.0, 15.0, 0.5);
    const SteelField field = standing(world_of({{body, 1000.0}}), kEarth_T);
    const double azimuth = 0.0625 * std::numbers::pi * i;
    const Vector3d direction(std::cos(azimuth), std::sin(azimuth), 0.1);
    double last_T = 0.0;
    double r = 3.0;
    for (; r < 60.0; r += 0.01) {
      const double here_T = field.at(body + r * direction, {}).norm();
      if (here_T == 0.0) break;
      last_T = here_T;
    }
    EXPECT_LE(last_T, steel::kNegligible_T);
    // Off axis the field is half of what the reach is made for at least, less what the angle
    // between both parts takes off their sum.
    EXPECT_GT(last_T, 0.1 * steel::kNegligible_T);
    EXPECT_LT(r, 30.0);
  }
}

TEST(SteelField, MovingBodyCarriesItsMagnetAndIsInducedWhereItStands) {
  World world;
  world.actor_steel = {{}, {{Vector3d(1.0, 0.5, 1.2), 4000.0}}};
  const Pose turned{.rotation = rotation_from_rpy(0.0, 0.0, 2.0),
                    .translation = Vector3d(40.0, 30.0, 0.0)};
  const std::vector<Actor> actors = {{.shape = 1, .poses = {Pose{}, turned}}};
  const Vector3d probe{1.5, 4.5, 0.8};
  const Stamp later = stamp_from_seconds(0.1);

  const SteelField permanent(world, actors, kNoField, 9);
  const Vector3d before = permanent.at(probe, Stamp{});
  EXPECT_GT(before.norm(), 1e-6);
  EXPECT_LT((permanent.at(turned * probe, later) - turned.rotation * before).norm(), 1e-18);

  const SteelField both(world, actors, kEarth_T, 9);
  const Vector3d induced = both.at(turned * probe, later) - permanent.at(turned * probe, later);
  const Vector3d offset = turned * probe - turned * Vector3d(1.0, 0.5, 1.2);
  const Vector3d expected =
      dipole_field_T(3000.0 * 4000.0 * kEarth_T, offset, steel_radius_m(4000.0));
  EXPECT_LT((induced - expected).norm(), 1e-17);
}

TEST(SteelField, ActorsOfOneShapeDifferAndShapesWithoutSteelAreNotFelt) {
  World world;
  world.actor_steel = {{{Vector3d::Zero(), 1000.0}}};
  const Pose far{.translation = Vector3d(500.0, 0.0, 0.0)};
  const std::vector<Actor> actors = {{.shape = 0, .poses = {Pose{}}},
                                     {.shape = 0, .poses = {far}},
                                     {.shape = 7, .poses = {Pose{}}}};
  const SteelField field(world, actors, kNoField, 2);
  const Vector3d probe{0.0, 3.0, 0.0};
  EXPECT_GT((field.at(probe, {}) - field.at(far * probe, {})).norm(), 1e-7);
  const SteelField first(world, std::span(actors).first(2), kNoField, 2);
  EXPECT_EQ(field.at(probe, {}), first.at(probe, {}));
}

/// Seconds for which the size of `field` at `at`, sampled each millisecond of `length_s`, is above
/// half of its largest.
double seconds_above_half(const SteelField& field, const Vector3d& at, double length_s) {
  std::vector<double> sizes;
  for (double t = 0.0; t < length_s; t += 1e-3) {
    sizes.push_back(field.at(at, stamp_from_seconds(t)).norm());
  }
  const double half = 0.5 * *std::ranges::max_element(sizes);
  return 1e-3 *
         static_cast<double>(std::ranges::count_if(sizes, [&](double s) { return s > half; }));
}

TEST(SteelField, LorryPassingAtThreeMetresMakesTheBurstOfItsDipole) {
  World world;
  world.actor_steel = {{{Vector3d(0.0, 0.0, 1.0), 8000.0}}};
  const auto lorry = [](double speed_m_s) {
    Actor actor{.shape = 0, .poses = {}};
    for (int i = 0; i <= 100; ++i) {
      const double x = speed_m_s * (0.1 * i - 5.0);
      actor.poses.push_back({.translation = Vector3d(x, 0.0, 0.0)});
    }
    return std::vector<Actor>{actor};
  };
  const Vector3d at{0.0, 3.0, 1.0};
  const std::vector<Actor> slow = lorry(10.0);
  const std::vector<Actor> fast = lorry(20.0);
  const SteelField field(world, slow, kEarth_T, 11);
  const Vector3d moment = moment_beside(field.at(at, stamp_from_seconds(5.0)), 3.0);
  // Permanent 0.3 (root mean square) and induced 0.146 A·m²/kg, in any mutual direction.
  EXPECT_GT(moment.norm(), 8000.0 * 0.03);
  EXPECT_LT(moment.norm(), 8000.0 * 0.9);
  for (double t = 3.0; t < 7.0; t += 0.05) {
    const Vector3d offset(-10.0 * (t - 5.0), 3.0, 0.0);
    const double r = offset.norm();
    const Vector3d expected =
        1e-7 * (3.0 * moment.dot(offset) * offset / (r * r) - moment) / (r * r * r);
    // What lies beyond the reach is left out.
    EXPECT_LT((field.at(at, stamp_from_seconds(t)) - expected).norm(), 1e-8);
  }
  // A dipole's |B| falls to half between 0.766·d (beside it, 1/r³) and 1.16·d away: for a moment
  // along the way 0.51·d. Twice that, over the speed.
  const double slow_s = seconds_above_half(field, at, 10.0);
  EXPECT_GT(slow_s, 2.0 * 0.5 * 3.0 / 10.0);
  EXPECT_LT(slow_s, 2.0 * 1.2 * 3.0 / 10.0);
  EXPECT_NEAR(seconds_above_half(SteelField(world, fast, kEarth_T, 11), at, 10.0), 0.5 * slow_s,
              2e-3);
}

TEST(SteelField, GirderAcrossTheRoadIsFeltAsALineOfDipoles) {
  constexpr double kMass_kg_m = 300.0;
  constexpr double kHeight_m = 4.0;
  std::vector<SteelBody> girder;
  for (int y = -60; y <= 60; ++y) girder.push_back({Vector3d(0.0, y, 5.5), kMass_kg_m});
  const World world = world_of(girder);
  const SteelField with = standing(world, kEarth_T);
  const SteelField without = standing(world, kNoField);
  const Vector3d line =
      steel::kInduced_A_m2_kg_T * kMass_kg_m * Vector3d(kEarth_T.x(), 0.0, kEarth_T.z());
  const auto induced = [&](double x) -> Vector3d {
    const Vector3d at(x, 0.0, 5.5 - kHeight_m);
    return with.at(at, {}) - without.at(at, {});
  };
  for (const double x : {-6.0, -2.0, 0.0, 1.0, 5.0}) {
    const Vector3d d(x, 0.0, -kHeight_m);
    const Vector3d expected =
        2e-7 * (2.0 * line.dot(d) * d / d.squaredNorm() - line) / d.squaredNorm();
    Vector3d across = induced(x);
    across.y() = 0.0;
    // Reaches end some 13 m away: tails of 1/r³ beyond leave (d/13 m)² at most.
    EXPECT_LT((across - expected).norm(), 0.2 * expected.norm()) << x;
    EXPECT_GT(across.dot(expected), 0.0);
  }
  // |B| of a line is 2e-7·|λ|/(x² + h²): half at x = h, wherever λ points.
  const auto size = [&](double x) { return std::hypot(induced(x).x(), induced(x).z()); };
  EXPECT_NEAR(size(kHeight_m) / size(0.0), 0.5, 0.06);
  EXPECT_NEAR(size(-kHeight_m) / size(0.0), 0.5, 0.06);
}

}  // namespace
}  // namespace locsim::sim
