#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "scenarios/presets.h"
#include "sim/lidar/lidar.h"
#include "sim/ray_scene.h"
#include "tests/scenarios/lidar_preset.h"

namespace locsim::scenarios {
namespace {

/// A ray by the data sheet's rule alone, in the lidar frame.
struct PublishedRay {
  Duration since_start;
  std::uint16_t ring = 0;
  Vector3d origin;
  Vector3d direction;
};

double triangle(double turns) {
  return 2.0 / std::numbers::pi * std::asin(std::sin(2.0 * std::numbers::pi * turns));
}

std::vector<PublishedRay> published_rays(const sim::LidarSpec& spec, Stamp start) {
  const std::vector<std::uint16_t> rings = spec.rings();
  const double turns_1_s = spec.head_rate_hz == 0.0 ? spec.rate_hz : spec.head_rate_hz;
  const double rate_rad_s = (spec.clockwise ? -2.0 : 2.0) * std::numbers::pi * turns_1_s;
  std::vector<PublishedRay> rays;
  for (std::size_t cycle = 0; cycle < spec.cycles(); ++cycle) {
    const Duration cycle_start = spec.cycle * static_cast<std::int64_t>(cycle);
    const double running_s =
        spec.repeats() ? to_seconds(cycle_start) : to_seconds(start + cycle_start);
    const double nod_rad = spec.nod_amplitude_rad * triangle(spec.nod_rate_hz * running_s);
    for (std::size_t b = 0; b < spec.beams.size(); ++b) {
      const sim::LidarBeam& beam = spec.beams[b];
      const double head_rad =
          spec.start_azimuth_rad + rate_rad_s * (running_s + to_seconds(beam.firing_time));
      const double lifted_rad = beam.elevation_rad + nod_rad;
      const double azimuth_rad = head_rad + beam.azimuth_offset_rad;
      rays.push_back(
          {.since_start = cycle_start + beam.firing_time,
           .ring = rings[b],
           .origin = spec.beam_origin_m * Vector3d(std::cos(head_rad), std::sin(head_rad), 0.0),
           .direction = {std::cos(lifted_rad) * std::cos(azimuth_rad),
                         std::cos(lifted_rad) * std::sin(azimuth_rad), std::sin(lifted_rad)}});
    }
  }
  return rays;
}

sim::World bright_room() {
  sim::World world;
  world.materials = {{.name = "white", .reflectivity_905nm = 1.0}};
  add_box(world.structures, {}, {12.0, 10.0, 15.0}, 0);
  return world;
}

sim::Trajectory standing_still() {
  sim::Trajectory trajectory(Stamp{}, Duration{2'500'000});
  for (int i = 0; i < 200; ++i) trajectory.push({});
  return trajectory;
}

/// Exact ranges of all that is met.
sim::LidarSpec ideal(sim::LidarSpec spec) {
  spec.effects.noise = false;
  spec.effects.beam_bias = false;
  spec.effects.quantisation = false;
  spec.effects.detection_limit = false;
  return spec;
}

double distance_m(const PublishedRay& ray, const Vector3d& p) {
  const Vector3d from = p - ray.origin;
  return (from - std::max(from.dot(ray.direction), 0.0) * ray.direction).norm();
}

// Which ray a point belongs to is told by its coordinates alone: it lies on one published ray, and
// ring and time of that ray are the ring and time that the point says of itself.
TEST(LidarPattern, RingAzimuthAndTimeOfAPointAreRecoveredFromItsCoordinates) {
  const sim::World world = bright_room();
  const sim::RayScene scene(world, {});
  const sim::Trajectory standing = standing_still();
  for (const std::string& name : preset_names("lidar")) {
    const sim::LidarSpec spec = ideal(lidar_preset(name));
    // A later scan, so that patterns that run on have run on.
    const Stamp start = Stamp{2 * spec.period()};
    sim::Lidar lidar(spec, {}, 0, 1);
    LidarScan scan = lidar.start_scan(start);
    lidar.cast(scene, standing, scan.start, scan.end, scan);
    ASSERT_EQ(scan.points.size(), spec.beams.size() * spec.cycles()) << name;

    const std::vector<PublishedRay> rays = published_rays(spec, start);
    const std::size_t stride = scan.points.size() / 400;
    for (std::size_t i = 0; i < scan.points.size(); i += stride) {
      const LidarPoint& point = scan.points[i];
      const PublishedRay* nearest = nullptr;
      double nearest_m = std::numeric_limits<double>::infinity();
      double next_m = std::numeric_limits<double>::infinity();
      for (const PublishedRay& ray : rays) {
        const double d_m = distance_m(ray, point.position());
        if (d_m < nearest_m) {
          next_m = nearest_m;
          nearest_m = d_m;
          nearest = &ray;
        } else {
          next_m = std::min(next_m, d_m);
        }
      }
      // Directions are floats, 2e-7 rad, at up to 22 m.
      EXPECT_LT(nearest_m, 1e-5) << name;
      EXPECT_GT(next_m, 4.0 * nearest_m) << name;
      EXPECT_EQ(nearest->ring, point.ring) << name;
      EXPECT_EQ(nearest->since_start, Duration{point.time_ns}) << name;
    }
  }
}

// Directions of two scans that follow each other: the same, or none again.
TEST(LidarPattern, RepeatsFromScanToScanOrRunsOn) {
  const sim::World world = bright_room();
  const sim::RayScene scene(world, {});
  const sim::Trajectory standing = standing_still();
  for (const std::string& name : preset_names("lidar")) {
    sim::Lidar lidar(ideal(lidar_preset(name)), {}, 0, 1);
    std::array<LidarScan, 2> scans;
    for (std::size_t i = 0; i < 2; ++i) {
      scans[i] = lidar.start_scan(Stamp{} + static_cast<std::int64_t>(i) * lidar.spec().period());
      lidar.cast(scene, standing, scans[i].start, scans[i].end, scans[i]);
    }
    const double same = std::cos(1e-4);
    std::size_t tried = 0;
    std::size_t again = 0;
    for (std::size_t i = 0; i < scans[0].points.size(); i += 197) {
      const Vector3d direction = scans[0].points[i].position().normalized();
      ++tried;
      again += std::ranges::any_of(scans[1].points, [&](const LidarPoint& p) {
        return p.position().normalized().dot(direction) > same;
      });
    }
    ASSERT_GT(tried, 50U) << name;
    if (name == "mid360") {
      EXPECT_LT(again, tried / 20) << name;
    } else {
      EXPECT_EQ(again, tried) << name;
    }
  }
}

}  // namespace
}  // namespace locsim::scenarios
