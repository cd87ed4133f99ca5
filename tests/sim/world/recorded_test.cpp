#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "core/error.h"
#include "core/random.h"
#include "sim/world/recorded_layout.h"
#include "sim/world/smoothing_spline.h"

namespace locsim::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;
const std::string kHeader =
    "t_gps_s,latitude_deg,longitude_deg,height_m,velocity_north_m_s,velocity_east_m_s\n";

std::filesystem::path write(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("recorded_test_" + std::to_string(getpid()) + "_" + name);
  std::ofstream(path) << text;
  return path;
}

/// North at 10 m/s, four lines a second.
std::string northward(int lines) {
  std::string text = kHeader;
  for (int i = 0; i < lines; ++i) {
    const double t = 0.25 * i;
    text += std::to_string(1000.0 + t) + "," + std::to_string(48.0 + 10.0 * t / 111200.0) +
            ",8.0,200.0,10.0,0.0\n";
  }
  return text;
}

std::string message(const std::filesystem::path& path) {
  try {
    (void)load_recorded_track(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(RecordedTrack, CsvIsPlacedAboutItsMiddleAtItsLowest) {
  const auto path = write("north.csv", northward(81));
  const RecordedTrack track = load_recorded_track(path);
  ASSERT_EQ(track.samples.size(), 81U);
  EXPECT_NEAR(track.origin.latitude_rad / kDegree, 48.0 + 100.0 / 111200.0, 1e-6);
  EXPECT_NEAR(track.origin.longitude_rad / kDegree, 8.0, 1e-9);
  EXPECT_NEAR(track.origin.height_m, 200.0, 0.01);
  EXPECT_EQ(track.samples.front().time_s, 0.0);
  EXPECT_NEAR(track.samples.back().time_s, 20.0, 1e-6);
  // 1° of latitude is 111.2 km at 48° (to 0.01 %); the text keeps 1e-6°, 0.11 m.
  EXPECT_NEAR(track.samples.back().position.y() - track.samples.front().position.y(), 200.0, 0.3);
  EXPECT_NEAR(track.samples[7].speed_m_s, 10.0, 1e-12);
  EXPECT_NEAR(track.samples[7].course_rad, 0.5 * std::numbers::pi, 1e-12);
}

TEST(RecordedTrack, TumGivesSpeedAndCourseFromPositions) {
  // A circle of 100 m radius at 10 m/s, far from the frame's zero.
  std::string text = "# t x y z qx qy qz qw\n";
  for (int i = 0; i <= 200; ++i) {
    const double angle = 0.01 * i;
    const double yaw = angle + 0.5 * std::numbers::pi;
    text += std::to_string(0.1 * i) + " " + std::to_string(500000.0 + 100.0 * std::cos(angle)) +
            " " + std::to_string(4e6 + 100.0 * std::sin(angle)) + " 50 0 0 " +
            std::to_string(std::sin(0.5 * yaw)) + " " + std::to_string(std::cos(0.5 * yaw)) + "\n";
  }
  const GeodeticPoint origin{.latitude_rad = 0.8, .longitude_rad = 0.1, .height_m = 30.0};
  const RecordedTrack track = load_recorded_track(write("circle.tum", text), origin);
  EXPECT_EQ(track.origin.latitude_rad, 0.8);
  for (std::size_t i = 5; i + 5 < track.samples.size(); ++i) {
    EXPECT_LT(track.samples[i].position.head<2>().norm(), 110.0);
    EXPECT_EQ(track.samples[i].position.z(), 0.0);
    // Chords of 6 m are shorter than their arcs by 0.15 ‰; text keeps micrometres.
    EXPECT_NEAR(track.samples[i].speed_m_s, 10.0, 0.003);
    EXPECT_NEAR(wrap_angle(track.samples[i].course_rad -
                           (0.01 * static_cast<double>(i) + 0.5 * std::numbers::pi)),
                0.0, 1e-4);
  }
}

TEST(RecordedTrack, ErrorsNameFileAndLine) {
  EXPECT_THAT(message("nowhere/at_all.csv"), HasSubstr("nowhere/at_all.csv: cannot be opened"));
  EXPECT_THAT(message(write("empty.csv", "")), HasSubstr("fewer than two samples"));

  std::string text = northward(81);
  text.replace(text.find("height_m"), 8, "elevation");
  EXPECT_THAT(message(write("column.csv", text)),
              AllOf(HasSubstr("column.csv:1: "), HasSubstr("\"height_m\"")));

  text = northward(81);
  EXPECT_THAT(message(write("cut.csv", text.substr(0, text.size() - 12))),
              AllOf(HasSubstr("cut.csv:82: "), HasSubstr("4 fields"), HasSubstr("cut short")));

  text = northward(81);
  text.replace(text.find(",8.0,"), 5, ",8.x,");
  EXPECT_THAT(message(write("word.csv", text)),
              AllOf(HasSubstr("word.csv:2: longitude_deg"), HasSubstr("\"8.x\" is not a number")));

  text = northward(81);
  text.replace(text.find("48.0"), 4, "98.0");
  EXPECT_THAT(message(write("range.csv", text)),
              AllOf(HasSubstr("range.csv:2: latitude_deg"), HasSubstr("beyond ±90")));

  text = northward(81) + "1000.0,48.0,8.0,200.0,10.0,0.0\n";
  EXPECT_THAT(message(write("back.csv", text)),
              AllOf(HasSubstr("back.csv:83: "), HasSubstr("time does not rise")));

  EXPECT_THAT(message(write("short.csv", northward(20))),
              AllOf(HasSubstr("short.csv:21: "), HasSubstr("at least 50 m")));

  EXPECT_THAT(message(write("cut.tum", "0 0 0 0 0 0 0 1\n1 5 0 0 0 0 0\n")),
              AllOf(HasSubstr("cut.tum:2: "), HasSubstr("7 fields")));
  EXPECT_THAT(message(write("turned.tum", "0 0 0 0 0 0 0 1\n1 5 0 0 0 0 0 3\n")),
              AllOf(HasSubstr("turned.tum:2: "), HasSubstr("quaternion")));
  EXPECT_THAT(message(write("backwards.tum", "0 0 0 0 0 0 0 1\n1 -60 0 0 0 0 0 1\n")),
              AllOf(HasSubstr("backwards.tum:1: "), HasSubstr("against its heading")));
}

TEST(SmoothingSpline, PassesParabolasAndHalvesWavesAtTheCutoff) {
  std::vector<double> u, parabola, wave;
  for (int i = 0; i <= 300; ++i) {
    u.push_back(i);
    parabola.push_back(3.0 - 0.2 * i + 0.004 * i * i);
    wave.push_back(std::sin(2.0 * std::numbers::pi * i / 12.0));
  }
  const std::vector<double> sigma(u.size(), 0.01);
  const SmoothingSpline smooth(u, parabola, sigma, 1.0, 12.0);
  for (const double x : {0.0, 77.3, 300.0}) {
    EXPECT_NEAR(smooth.at(x).value, 3.0 - 0.2 * x + 0.004 * x * x, 1e-6);
    EXPECT_NEAR(smooth.at(x).first, -0.2 + 0.008 * x, 1e-6);
    EXPECT_NEAR(smooth.at(x).second, 0.008, 1e-6);
  }
  const SmoothingSpline halved(u, wave, sigma, 1.0, 12.0);
  // The spline's own stiffness at 12 knots a wave differs from the continuum's by (2π/12)²/4.
  for (int x = 99; x < 200; x += 12) EXPECT_NEAR(halved.at(x).value, 0.5, 0.04);
}

/// A drive of known law: 10 s of rest, 1 m/s² to 10 m/s, 20 s of that, 2 m/s² to rest for 8 s,
/// then again to 10 m/s; along a circle of 80 m radius, with noise of 1 cm.
RecordedTrack known_drive(const RandomStream& noise) {
  RecordedTrack track;
  track.source = "known";
  double s = 0.0;
  double v = 0.0;
  const double dt = 0.05;
  for (int i = 0; i <= 1400; ++i) {
    const double t = dt * i;
    if (i % 5 == 0) {
      const double angle = s / 80.0;
      const auto n = noise.gaussian3(static_cast<std::uint64_t>(i));
      track.samples.push_back(
          {.time_s = t,
           .position =
               Vector3d(80.0 * std::cos(angle), 80.0 * std::sin(angle), 0.02 * s + 1.5) + 0.01 * n,
           .speed_m_s = v,
           .course_rad = angle + 0.5 * std::numbers::pi});
    }
    const double a = t < 10.0   ? 0.0
                     : t < 20.0 ? 1.0
                     : t < 40.0 ? 0.0
                     : t < 45.0 ? -2.0
                     : t < 53.0 ? 0.0
                     : t < 63.0 ? 1.0
                                : 0.0;
    const double next = std::max(0.0, v + a * dt);
    s += 0.5 * (v + next) * dt;
    v = next < 1e-9 ? 0.0 : next;
  }
  return track;
}

TEST(RecordedLayout, RestsBecomeStopsAndTimesAreTheLogs) {
  const RecordedTrack track = known_drive(RandomStream(3, "test/noise"));
  const Layout layout = make_recorded_layout(track);
  const Route& route = layout.route;
  ASSERT_EQ(route.stops().size(), 2U);
  // Epochs are 0.25 s apart, the threshold is 0.15 m/s.
  EXPECT_NEAR(route.stops()[0].s_m, 0.0, 1e-9);
  EXPECT_NEAR(route.stops()[0].dwell_s, 10.0, 0.5);
  EXPECT_NEAR(route.stops()[1].s_m, 50.0 + 200.0 + 25.0, 0.5);
  EXPECT_NEAR(route.stops()[1].dwell_s, 8.0, 0.5);
  EXPECT_NEAR(route.duration_s(), 70.0, 1e-9);
  for (const auto& sample : track.samples) {
    const RoutePoint p = route.at(route.s_at_time(sample.time_s));
    // 0.25 m where the schedule is linear over half a metre out of a rest, else noise.
    EXPECT_LT((p.position - sample.position).head<2>().norm(), 0.3) << sample.time_s;
    EXPECT_NEAR(p.speed_m_s, sample.speed_m_s, 0.75) << sample.time_s;
  }
  for (double s = 10.0; s < route.length_m() - 10.0; s += 3.0) {
    const RoutePoint p = route.at(s);
    EXPECT_NEAR(p.position.head<2>().norm(), 80.0, 0.03);
    // 1 cm of noise at 2.5 m spacing, passed below 6 m wavelength: (2π/6)²·0.01·√(2.5/3)·…
    EXPECT_NEAR(p.curvature_1_m, 1.0 / 80.0, 0.01);
    EXPECT_NEAR(p.position.z(), 0.02 * s, 0.03);
  }
  const GroundSurface ground(layout);
  const Vector3d here = route.at(100.0).position;
  EXPECT_NEAR(ground.at(here.x(), here.y()).lateral_m, -1.75, 0.01);
  EXPECT_NEAR(ground.at(here.x(), here.y()).height_m, here.z(), 0.002);
}

TEST(RecordedLayout, ReverseIsAnError) {
  RecordedTrack track;
  track.source = "there_and_back";
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.25 * i;
    const bool back = t > 25.0;
    track.samples.push_back({.time_s = t,
                             .position = {back ? 4.0 * (50.0 - t) : 4.0 * t, 0.0, 0.0},
                             .speed_m_s = 4.0,
                             .course_rad = back ? std::numbers::pi : 0.0});
  }
  try {
    (void)make_recorded_layout(track);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("there_and_back"), HasSubstr("reverses")));
  }
}

TEST(RecordedLayout, TurnsTighterThanACarIsAnError) {
  RecordedTrack track;
  track.source = "tight";
  for (int i = 0; i <= 300; ++i) {
    const double angle = 0.05 * i;
    track.samples.push_back({.time_s = 0.1 * i,
                             .position = {4.0 * std::cos(angle), 4.0 * std::sin(angle), 0.0},
                             .speed_m_s = 2.0,
                             .course_rad = angle + 0.5 * std::numbers::pi});
  }
  EXPECT_THROW((void)make_recorded_layout(track, {.path_cutoff_m = 3.0}), InputError);
  EXPECT_NO_THROW(
      (void)make_recorded_layout(track, {.path_cutoff_m = 3.0, .turning_radius_m = 3.5}));
}

std::filesystem::path shared_drive() {
  const char* folder = std::getenv("LOCSIM_DATA_DIR");
  const std::filesystem::path data =
      folder != nullptr ? std::filesystem::path(folder)
                        : std::filesystem::path(LOCSIM_SOURCE_DIR) / ".." / "shared" / "data";
  return data / "drive_0708" / "gnss.csv";
}

TEST(RecordedDrive, RouteIsWhereTheLogWasWhenItWas) {
  if (!std::filesystem::exists(shared_drive())) {
    GTEST_SKIP() << shared_drive() << " is absent; LOCSIM_DATA_DIR names the folder of drives";
  }
  const RecordedTrack track = load_recorded_track(shared_drive());
  const Layout layout = make_recorded_layout(track);
  const Route& route = layout.route;
  // As the drive's own description has it.
  EXPECT_NEAR(route.length_m(), 4050.0, 10.0);
  EXPECT_NEAR(route.duration_s(), 549.0, 0.5);
  ASSERT_EQ(route.stops().size(), 5U);

  double position = 0.0, height = 0.0, speed = 0.0, course = 0.0;
  int moving = 0;
  for (const auto& sample : track.samples) {
    const RoutePoint p = route.at(route.s_at_time(sample.time_s));
    position += (p.position - sample.position).head<2>().squaredNorm();
    height += std::pow(p.position.z() + 1.5 - sample.position.z(), 2);
    speed += std::pow(p.speed_m_s - sample.speed_m_s, 2);
    if (sample.speed_m_s < 1.0) continue;
    ++moving;
    course += std::pow(wrap_angle(p.yaw_rad - sample.course_rad), 2);
  }
  const auto count = static_cast<double>(track.samples.size());
  EXPECT_LT(std::sqrt(position / count), 0.10);
  EXPECT_LT(std::sqrt(height / count), 0.05);
  EXPECT_LT(std::sqrt(speed / count), 0.15);
  // The log's courses come of velocities with 0.05 m/s of noise: 3° at 1 m/s, 0.3° at 10 m/s.
  EXPECT_LT(std::sqrt(course / moving), 2.0 * kDegree);
  RecordProperty("position_rms_m", std::to_string(std::sqrt(position / count)));
  RecordProperty("height_rms_m", std::to_string(std::sqrt(height / count)));
  RecordProperty("speed_rms_m_s", std::to_string(std::sqrt(speed / count)));
}

TEST(RecordedDrive, RouteStaysDrivableOverFloatEpochsAndOverlaps) {
  if (!std::filesystem::exists(shared_drive())) {
    GTEST_SKIP() << shared_drive() << " is absent; LOCSIM_DATA_DIR names the folder of drives";
  }
  const Layout layout = make_recorded_layout(load_recorded_track(shared_drive()));
  const auto& points = layout.route.points();
  const GroundSurface ground(layout, 10.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double ds = points[i].s_m - points[i - 1].s_m;
    EXPECT_LT(std::abs(points[i].curvature_1_m), 1.0 / 5.3);
    EXPECT_LT(std::abs(points[i].curvature_1_m - points[i - 1].curvature_1_m) / ds, 0.08);
    EXPECT_LT(std::abs(points[i].position.z() - points[i - 1].position.z()) / ds, 0.18);
    EXPECT_LT(ground.at(points[i].position.x(), points[i].position.y()).carriageway_distance_m,
              -1.7);
  }
}

}  // namespace
}  // namespace locsim::sim
