#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "tests/localization/dynamic_icp/simulated_messages.h"

namespace locsim::localization {
namespace {

using namespace testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array kBad{kNan, kInfinity, -kInfinity};

const std::vector<Message>& clean_record() {
  static const Drive drive{.start_x_m = -90.0, .standing_s = 1.0};
  static const std::vector<Message> messages =
      record(Sensors(the_street(), drive, make_rig()), 2.6);
  return messages;
}

/// Delivers the record to one localizer as it is, to the other with what `dirt` adds after each
/// message (or, where it returns true, by `dirt` alone): all that they say must be the same.
using Dirt = std::function<bool(Localizer&, const Message&, double time_s)>;
void expect_nothing_changed(const Dirt& dirt) {
  const auto clean = make_dynamic_icp();
  const auto dirty = make_dynamic_icp();
  int tracking = 0;
  for (const Message& message : clean_record()) {
    deliver(*clean, message);
    if (!dirt(*dirty, message, to_seconds(time_of(message)))) deliver(*dirty, message);
    const std::optional<Estimate> a = clean->estimate();
    const std::optional<Estimate> b = dirty->estimate();
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) continue;
    Hash of_a;
    Hash of_b;
    add_to(of_a, *a);
    add_to(of_b, *b);
    ASSERT_EQ(of_a.value(), of_b.value()) << "at " << to_seconds(time_of(message)) << " s";
    tracking += b->state == State::tracking ? 1 : 0;
  }
  EXPECT_GT(tracking, 200);
}

TEST(BadMessages, ImuSamplesThatAreNotFiniteOrNotNewerAreDropped) {
  expect_nothing_changed([](Localizer& dirty, const Message& message, double) {
    const auto* sample = std::get_if<ImuSample>(&message);
    if (sample == nullptr) return false;
    dirty.add(*sample);
    dirty.add(*sample);
    for (const double bad : kBad) {
      for (int axis = 0; axis < 3; ++axis) {
        ImuSample spoilt = *sample;
        spoilt.time += std::chrono::milliseconds(1);
        spoilt.angular_rate_rad_s[axis] = bad;
        dirty.add(spoilt);
        spoilt = *sample;
        spoilt.time += std::chrono::milliseconds(1);
        spoilt.specific_force_m_s2[axis] = bad;
        dirty.add(spoilt);
      }
    }
    ImuSample old = *sample;
    old.angular_rate_rad_s.setConstant(1.0);
    for (const int age_ms : {1, 300, 3000}) {
      old.time = sample->time - std::chrono::milliseconds(age_ms);
      // A clock that runs behind for a second's worth of samples is another matter.
      if (sample->time.time_since_epoch().count() % 50'000'000 == 10'000'000) dirty.add(old);
    }
    return true;
  });
}

TEST(BadMessages, FixesThatAreNotFiniteOrNotValidAreDropped) {
  expect_nothing_changed([](Localizer& dirty, const Message& message, double) {
    const auto* fix = std::get_if<GnssFix>(&message);
    if (fix == nullptr) return false;
    dirty.add(*fix);
    // Newer, and a kilometre north: it would show.
    GnssFix other = *fix;
    other.time += std::chrono::milliseconds(50);
    other.position.latitude_rad += 1000.0 / 6.4e6;
    const auto try_with = [&](const std::function<void(GnssFix&)>& spoil) {
      GnssFix spoilt = other;
      spoil(spoilt);
      dirty.add(spoilt);
    };
    for (const double bad : kBad) {
      try_with([&](GnssFix& f) { f.position.latitude_rad = bad; });
      try_with([&](GnssFix& f) { f.position.longitude_rad = bad; });
      try_with([&](GnssFix& f) { f.position.height_m = bad; });
      for (int i = 0; i < 3; ++i) {
        try_with([&](GnssFix& f) { f.velocity_enu_m_s[i] = bad; });
        for (int j = 0; j < 3; ++j) {
          try_with([&](GnssFix& f) { f.position_covariance_m2(i, j) = bad; });
          try_with([&](GnssFix& f) { f.velocity_covariance_m2_s2(i, j) = bad; });
        }
      }
    }
    try_with([](GnssFix& f) { f.valid = false; });
    try_with([](GnssFix& f) { f.position.latitude_rad = 2.0; });
    try_with([](GnssFix& f) { f.time += std::chrono::hours(1); });
    try_with([](GnssFix& f) { f.time -= std::chrono::seconds(5); });
    return true;
  });
}

TEST(BadMessages, FixesWhoseCovarianceIsNoneAreDropped) {
  expect_nothing_changed([](Localizer& dirty, const Message& message, double) {
    const auto* fix = std::get_if<GnssFix>(&message);
    if (fix == nullptr) return false;
    dirty.add(*fix);
    GnssFix spoilt = *fix;
    spoilt.time += std::chrono::milliseconds(50);
    spoilt.position_covariance_m2 = -100.0 * Matrix3d::Identity();
    dirty.add(spoilt);
    // Sigmas of 1 m and 1.5 m that were more than fully correlated.
    spoilt = *fix;
    spoilt.time += std::chrono::milliseconds(50);
    spoilt.position_covariance_m2(0, 1) = spoilt.position_covariance_m2(1, 0) = 50.0;
    dirty.add(spoilt);
    spoilt = *fix;
    spoilt.time += std::chrono::milliseconds(50);
    spoilt.velocity_covariance_m2_s2(2, 2) = -1.0;
    dirty.add(spoilt);
    return true;
  });
}

TEST(BadMessages, HeadingsThatAreNoneAreDropped) {
  expect_nothing_changed([](Localizer& dirty, const Message& message, double) {
    const auto* heading = std::get_if<MagneticHeading>(&message);
    if (heading == nullptr) return false;
    dirty.add(*heading);
    MagneticHeading other = *heading;
    other.time += std::chrono::milliseconds(50);
    for (const double bad : kBad) {
      dirty.add(MagneticHeading{other.time, bad, 0.1});
      dirty.add(MagneticHeading{other.time, heading->yaw_rad + 1.5, bad});
    }
    dirty.add(MagneticHeading{other.time, heading->yaw_rad + 1.5, -0.1});
    return true;
  });
}

TEST(BadMessages, ScansThatAreNoneAreDropped) {
  LidarScan first;
  expect_nothing_changed([&](Localizer& dirty, const Message& message, double time_s) {
    const auto* scan = std::get_if<LidarScan>(&message);
    if (scan == nullptr) return false;
    if (first.points.empty()) first = *scan;
    LidarScan spoilt = *scan;
    spoilt.points.clear();
    dirty.add(spoilt);
    dirty.add(LidarScan{});
    // What it holds is of the start, elsewhere once it drives.
    spoilt = first;
    spoilt.start = spoilt.end = scan->end;
    dirty.add(spoilt);
    spoilt.start = scan->end;
    spoilt.end = scan->start;
    dirty.add(spoilt);
    spoilt.start = scan->end - std::chrono::milliseconds(1100);
    spoilt.end = scan->end;
    dirty.add(spoilt);
    spoilt.start = scan->start + std::chrono::hours(1);
    spoilt.end = scan->end + std::chrono::hours(1);
    dirty.add(spoilt);
    spoilt.start = scan->start - std::chrono::hours(1);
    spoilt.end = scan->end - std::chrono::hours(1);
    dirty.add(spoilt);

    dirty.add(*scan);
    if (time_s < 1.0) return true;
    dirty.add(*scan);
    dirty.add(first);
    spoilt = first;
    spoilt.start = scan->start;
    spoilt.end = scan->end;
    dirty.add(spoilt);
    return true;
  });
}

TEST(BadMessages, PointsThatAreNoneAreLeftOut) {
  expect_nothing_changed([](Localizer& dirty, const Message& message, double) {
    const auto* scan = std::get_if<LidarScan>(&message);
    if (scan == nullptr) return false;
    LidarScan spoilt = *scan;
    const LidarPoint good = scan->points.back();
    for (std::size_t i = 0; i < 300; ++i) {
      LidarPoint point = scan->points[7 * i];
      point.time_ns = good.time_ns;
      const auto bad = static_cast<float>(kBad[i % 3]);
      if (i % 5 == 0) point.x_m = bad;
      if (i % 5 == 1) point.y_m = bad;
      if (i % 5 == 2) point.z_m = bad;
      if (i % 5 > 2) point = {point.x_m, 30.0F, 3.0F, 0.5F, point.time_ns, 0, 0};
      if (i % 5 == 3) point.sensor = static_cast<std::uint16_t>(1 + i);
      if (i % 5 == 4) point.time_ns = 100'000'001;
      spoilt.points.push_back(point);
    }
    for (LidarPoint& point : spoilt.points) point.intensity = std::nanf("");
    dirty.add(spoilt);
    return true;
  });
}

}  // namespace
}  // namespace locsim::localization
