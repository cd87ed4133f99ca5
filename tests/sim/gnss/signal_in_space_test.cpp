#include "sim/gnss/signal_in_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "tests/sim/gnss/satellite_states.h"

namespace locsim::sim {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

const GpsTime kTime = GpsTime::from_utc("2026-06-01T04:00:00Z");

const Constellation& whole_sky() {
  static const Constellation sky(
      {GnssSystem::gps, GnssSystem::galileo, GnssSystem::glonass, GnssSystem::beidou});
  return sky;
}

struct Documented {
  GnssSystem system;
  double ranging_error_m;
};
constexpr std::array<Documented, 4> kDocumented{{{GnssSystem::gps, 0.5},
                                                 {GnssSystem::beidou, 0.6},
                                                 {GnssSystem::galileo, 0.2},
                                                 {GnssSystem::glonass, 1.7}}};

// Even over the area of the earth (a sphere) that sees the satellite.
Vector3d someone_who_sees(const SatelliteState& satellite, const RandomStream& dice,
                          std::uint64_t draw) {
  constexpr double kEarth_m = 6371e3;
  const Vector3d up = satellite.position_ecef_m.normalized();
  const double share = kEarth_m / satellite.position_ecef_m.norm();
  const double cosine = dice.uniform(share, 1.0, draw, 0);
  const double around = dice.uniform(0.0, 2.0 * std::numbers::pi, draw, 1);
  const Vector3d east = up.unitOrthogonal();
  const Vector3d side = std::cos(around) * east + std::sin(around) * up.cross(east);
  return kEarth_m * (cosine * up + std::sqrt(1.0 - cosine * cosine) * side);
}

TEST(SignalInSpace, RangingErrorsHaveEachSystemsRms) {
  const RandomStream dice(5, "test/places");
  for (const Documented& documented : kDocumented) {
    const Constellation sky({documented.system});
    const std::vector<SatelliteState> satellites = states_at(sky, kTime);
    double squares = 0.0;
    double sum = 0.0;
    std::uint64_t draws = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const SignalInSpace space(sky, true, seed);
      for (const SatelliteState& satellite : satellites) {
        const Vector3d place = someone_who_sees(satellite, dice, draws++);
        const double error_m =
            space.range_error_m(satellite, (place - satellite.position_ecef_m).normalized(), kTime);
        squares += error_m * error_m;
        sum += error_m;
      }
    }
    const auto count = static_cast<double>(draws);
    const double rms_m = std::sqrt(squares / count);
    // At least 4800 independent draws: 1/√(2·4800) = 1 % of the RMS, four of them; and 1 % for
    // orbits higher and lower than the mean one (3 % for BeiDou's three of 27 far higher ones).
    EXPECT_NEAR(rms_m / documented.ranging_error_m, 1.0, 0.05) << documented.ranging_error_m;
    EXPECT_LT(std::abs(sum / count), 4.0 * rms_m / std::sqrt(count));
  }
}

TEST(SignalInSpace, OrbitErrorsLieMostlyAlongTheTrack) {
  const Constellation sky({GnssSystem::gps});
  const SatelliteState satellite = states_at(sky, kTime)[7];
  const Vector3d& p = satellite.position_ecef_m;
  const Vector3d among_stars =
      satellite.velocity_ecef_m_s + 7.2921151467e-5 * Vector3d(-p.y(), p.x(), 0.0);
  const Vector3d radial = p.normalized();
  const Vector3d along = (among_stars - among_stars.dot(radial) * radial).normalized();
  const Vector3d cross = radial.cross(along);
  constexpr int kSeeds = 4000;
  std::array<double, 4> squares{};
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SignalInSpace space(sky, true, seed);
    // The error is the clock's, less that of the orbit along the direction.
    const double clock_m = space.range_error_m(satellite, Vector3d::Zero(), kTime);
    squares[0] += clock_m * clock_m;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d& axis = i == 0 ? radial : i == 1 ? along : cross;
      squares[i + 1] += std::pow(space.range_error_m(satellite, axis, kTime) - clock_m, 2.0);
    }
  }
  const std::array<double, 4> expected_m{0.5 * 0.88, 0.5 * 0.35, 0.5 * 2.0, 0.5 * 1.2};
  for (std::size_t i = 0; i < 4; ++i) {
    // 1/√(2·4000) = 1.1 %, four of them.
    EXPECT_NEAR(std::sqrt(squares[i] / kSeeds) / expected_m[i], 1.0, 0.045) << i;
  }
}

TEST(SignalInSpace, ErrorsChangeByMillimetresASecond) {
  const SignalInSpace space(whole_sky(), true, 3);
  double most_m_s = 0.0;
  double most_m_in_an_hour = 0.0;
  for (const RepeatingOrbit& orbit : whole_sky().orbits()) {
    const auto error_m = [&](GpsTime time) {
      const SatelliteState satellite = evaluate(orbit, time);
      return space.range_error_m(satellite, -satellite.position_ecef_m.normalized(), time);
    };
    // Every message of every system changes within two hours.
    for (int second = 0; second < 7200; second += 60) {
      const GpsTime time = kTime + seconds(second);
      most_m_s = std::max(most_m_s, std::abs(error_m(time + seconds(1)) - error_m(time)));
      most_m_in_an_hour =
          std::max(most_m_in_an_hour, std::abs(error_m(time + hours(1)) - error_m(time)));
    }
  }
  // GLONASS: 1.7 m · √(0.88² + 0.35²), whose rate's RMS is at most 1.33 per knot spacing of an
  // hour; five of them.
  EXPECT_LT(most_m_s, 5.0 * 1.33 * 1.61 / 3600.0);
  EXPECT_GT(most_m_in_an_hour, 1.0);
}

TEST(SignalInSpace, WithoutErrorsTheBroadcastIsRight) {
  const SignalInSpace space(whole_sky(), false, 3);
  for (const RepeatingOrbit& orbit : whole_sky().orbits()) {
    const SatelliteState truth = evaluate(orbit, kTime);
    const BroadcastMessage message = space.broadcast(orbit.id, kTime);
    EXPECT_EQ(message.id(), orbit.id);
    EXPECT_EQ(space.range_error_m(truth, -truth.position_ecef_m.normalized(), kTime), 0.0);
    // GLONASS's equations leave a centimetre in a quarter of an hour; others only rounding.
    const double told_m =
        (evaluate(message.orbit, kTime).position_ecef_m - truth.position_ecef_m).norm();
    EXPECT_LT(told_m, orbit.id.system == GnssSystem::glonass ? 0.01 : 1e-3) << orbit.id.name();
  }
}

TEST(SignalInSpace, IsAPureFunction) {
  const SignalInSpace space(whole_sky(), true, 3);
  const SignalInSpace same(whole_sky(), true, 3);
  const SignalInSpace other(whole_sky(), true, 4);
  const std::vector<SatelliteState> satellites = states_at(whole_sky(), kTime);
  std::vector<double> errors_m;
  std::vector<double> clocks_s;
  for (const SatelliteState& s : satellites) {
    errors_m.push_back(space.range_error_m(s, -s.position_ecef_m.normalized(), kTime));
    clocks_s.push_back(space.broadcast(s.id, kTime).af0_s);
    EXPECT_NE(other.range_error_m(s, -s.position_ecef_m.normalized(), kTime), errors_m.back());
    EXPECT_NE(other.broadcast(s.id, kTime).af0_s, clocks_s.back());
  }
  for (std::size_t i = satellites.size(); i-- > 0;) {
    const SatelliteState& s = satellites[i];
    const Vector3d toward = -s.position_ecef_m.normalized();
    static_cast<void>(same.range_error_m(s, toward, kTime + hours(5)));
    EXPECT_EQ(same.range_error_m(s, toward, kTime), errors_m[i]);
    EXPECT_EQ(same.broadcast(s.id, kTime).af0_s, clocks_s[i]);
    if (i > 0) {
      EXPECT_NE(errors_m[i], errors_m[i - 1]);
    }
  }
}

}  // namespace
}  // namespace locsim::sim
