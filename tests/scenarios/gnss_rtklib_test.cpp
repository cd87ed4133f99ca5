#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "scenarios/presets.h"
#include "scenarios/rinex.h"
#include "scenarios/satellite_broadcast.h"
#include "scenarios/yaml_parameters.h"
#include "tests/scenarios/rtklib.h"
#include "tests/sim/gnss/gnss_rig.h"

namespace locsim::scenarios {
namespace {

using namespace testing_gnss;
using sim::GnssSpec;

constexpr int kAll = kGps + kGlonass + kGalileo + kBeidou;
// The one that RTKLIB is given.
constexpr double kMask_rad = 10.0 * std::numbers::pi / 180.0;
const Vector3d kAntenna(0.0, 0.0, sim::kAntennaHeight_m);

// 14 m/s around a circle of 100 m.
Pose driving(double t) {
  const double angle_rad = 0.14 * t;
  return {.rotation = rotation_from_rpy(0.0, 0.0, angle_rad + 0.5 * std::numbers::pi),
          .translation = {100.0 * std::cos(angle_rad), 100.0 * std::sin(angle_rad), 0.0}};
}

// One epoch in the map frame: the truth, the receiver's own fix, and RTKLIB's.
struct Solved {
  Vector3d truth_m = Vector3d::Zero();
  Vector3d own_m = Vector3d::Zero();
  Vector3d rtklib_m = Vector3d::Zero();
  int own_satellites = 0;
  int rtklib_satellites = 0;
};

struct Drive {
  GnssSpec spec;
  double length_s = 60.0;
  sim::GpsTime start = sim::kNoon;
  std::uint64_t seed = 1;
};

// A whole receiver in a car on a plain, its raw epochs and what its satellites broadcast solved
// again by RTKLIB; empty where an epoch has no fix.
std::vector<Solved> solved(const Drive& drive, int systems = kAll) {
  const sim::World world = sim::open_world();
  const sim::RayScene scene(world, {});
  const sim::Trajectory trajectory =
      sim::trajectory_along(driving, drive.length_s, std::chrono::milliseconds(10));
  sim::Gnss gnss(drive.spec, kAntenna, world, scene, sim::kHongKong, drive.start, drive.seed);
  std::vector<sim::GnssOutput> outputs;
  gnss.sample(trajectory, trajectory.start(), trajectory.end(), outputs);

  std::vector<GnssEpoch> epochs;
  for (const sim::GnssOutput& output : outputs) epochs.push_back(output.raw);
  const SatelliteBroadcast satellites = broadcast_of(gnss.receiver(), epochs, drive.start);
  const auto fixes = rtklib_fixes(
      rinex_observations({.approximate_ecef_m = sim::kHongKong.to_ecef(driving(0.0) * kAntenna),
                          .interval = drive.spec.period()},
                         epochs, drive.start),
      rinex_navigation(satellites.messages, satellites.ionosphere, drive.start), systems, true);
  const bool all_fixed =
      fixes.size() == outputs.size() &&
      std::ranges::all_of(outputs, [](const sim::GnssOutput& o) { return o.fix.valid; });
  EXPECT_TRUE(all_fixed) << "start " << drive.seed << ", systems " << systems;
  if (!all_fixed) return {};

  std::vector<Solved> all;
  for (std::size_t k = 0; k < fixes.size(); ++k) {
    const GnssFix& own = outputs[k].fix;
    all.push_back({.truth_m = driving(to_seconds(own.time)) * kAntenna,
                   .own_m = sim::kHongKong.to_map(own.position),
                   .rtklib_m = sim::kHongKong.from_ecef(fixes[k].position_ecef_m),
                   .own_satellites = own.satellites,
                   .rtklib_satellites = fixes[k].satellites});
  }
  return all;
}

// Once a second, each epoch by itself, by RTKLIB's mask.
GnssSpec epoch_by_epoch(GnssSpec spec) {
  spec.rate_hz = 1.0;
  spec.solution.smoothing = false;
  spec.solution.elevation_mask_rad = kMask_rad;
  return spec;
}

void expect_exact(const GnssSpec& spec, int systems) {
  const std::vector<Solved> epochs = solved({.spec = epoch_by_epoch(spec)}, systems);
  ASSERT_EQ(epochs.size(), 60U);
  // Pseudoranges rounded to the millimetre (0.3 mm RMS) times a PDOP up to 4, and orbits as
  // broadcast, which keep to a centimetre (GLONASS, the others to less).
  constexpr double kMost_m = 0.01;
  for (std::size_t k = 0; k < epochs.size(); ++k) {
    const Solved& epoch = epochs[k];
    EXPECT_LT((epoch.rtklib_m - epoch.truth_m).norm(), kMost_m) << systems << " at " << k;
    EXPECT_LT((epoch.own_m - epoch.truth_m).norm(), kMost_m) << systems << " at " << k;
    EXPECT_EQ(epoch.rtklib_satellites, epoch.own_satellites) << systems << " at " << k;
  }
}

TEST(GnssRtklib, WithoutErrorsEveryEpochIsTheTruthByGpsAlone) {
  GnssSpec spec = sim::flawless_receiver();
  spec.systems = {.gps = true, .glonass = false, .galileo = false, .beidou = false};
  expect_exact(spec, kGps);
}

TEST(GnssRtklib, WithoutErrorsEveryEpochIsTheTruthByAllConstellations) {
  expect_exact(sim::flawless_receiver(), kAll);
}

// From the first epoch on, whatever stands at the horizon.
TEST(GnssRtklib, WithoutErrorsEveryEpochIsTheTruthByEachOtherSystemAlone) {
  for (const int system : {kGlonass, kGalileo, kBeidou}) {
    GnssSpec spec = sim::flawless_receiver();
    spec.systems = {.gps = false,
                    .glonass = system == kGlonass,
                    .galileo = system == kGalileo,
                    .beidou = system == kBeidou};
    expect_exact(spec, system);
  }
}

// Half a millisecond dates epochs wrongly by up to 0.4 m of a satellite's way, and systems are
// metres apart: RTKLIB solves for both.
TEST(GnssRtklib, TheReceiversClockAndDelaysBetweenSystemsDoNoHarm) {
  GnssSpec spec = sim::flawless_receiver();
  spec.errors.receiver_clock = true;
  expect_exact(spec, kAll);
}

struct Rms {
  double horizontal_m = 0.0;
  double all_m = 0.0;
};
Rms rms(const std::vector<Solved>& epochs, Vector3d Solved::*of, Vector3d Solved::*against) {
  Rms sum;
  for (const Solved& epoch : epochs) {
    const Vector3d difference_m = epoch.*of - epoch.*against;
    sum.horizontal_m += difference_m.head<2>().squaredNorm();
    sum.all_m += difference_m.squaredNorm();
  }
  const auto count = static_cast<double>(epochs.size());
  return {std::sqrt(sum.horizontal_m / count), std::sqrt(sum.all_m / count)};
}

// A receiver for one frequency, as RTKLIB's model of the ionosphere needs it. The errors that count
// last for hours, so a long drive would be no better than a short one: forty-eight short ones, two
// to each hour of a day.
std::vector<Solved> open_sky_over_a_day() {
  YamlReader reader(std::string(embedded_preset("gnss", "ublox_m8t").value()), "ublox_m8t.yaml");
  GnssSpec spec;
  reader.read(spec);
  std::vector<Solved> all;
  for (int half_hours = 0; half_hours < 48; ++half_hours) {
    const auto epochs = solved({.spec = epoch_by_epoch(spec),
                                .length_s = 5.0,
                                .start = sim::kNoon + half_hours * std::chrono::minutes(30),
                                .seed = 1U + static_cast<std::uint64_t>(half_hours)});
    all.insert(all.end(), epochs.begin(), epochs.end());
  }
  return all;
}

TEST(GnssRtklib, UnderAnOpenSkyItAgreesWithTheReceiverAndErrsByOneToThreeMetres) {
  const std::vector<Solved> epochs = open_sky_over_a_day();
  ASSERT_EQ(epochs.size(), 48U * 5U);
  const Rms against_own = rms(epochs, &Solved::rtklib_m, &Solved::own_m);
  const Rms of_rtklib = rms(epochs, &Solved::rtklib_m, &Solved::truth_m);
  const Rms of_own = rms(epochs, &Solved::own_m, &Solved::truth_m);
  RecordProperty("rtklib_less_own_2d_m", std::to_string(against_own.horizontal_m));
  RecordProperty("rtklib_less_own_3d_m", std::to_string(against_own.all_m));
  RecordProperty("rtklib_less_truth_2d_m", std::to_string(of_rtklib.horizontal_m));
  RecordProperty("rtklib_less_truth_3d_m", std::to_string(of_rtklib.all_m));
  RecordProperty("own_less_truth_2d_m", std::to_string(of_own.horizontal_m));
  RecordProperty("own_less_truth_3d_m", std::to_string(of_own.all_m));
  // What is demanded. The two differ by how they weigh: the same satellites, the same models.
  EXPECT_LT(against_own.all_m, 1.0);
  EXPECT_GT(against_own.all_m, 0.05);
  for (const Rms& error : {of_rtklib, of_own}) {
    EXPECT_GT(error.all_m, 1.0);
    EXPECT_LT(error.all_m, 3.0);
    // The height is what the ionosphere spoils.
    EXPECT_LT(error.horizontal_m, 0.7 * error.all_m);
  }
}

}  // namespace
}  // namespace locsim::scenarios
