#include "sim/lidar/lidar_spec.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace locsim::sim {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// So that what is written reads as it was given: 0.1° again, not its 17 digits by way of radians.
double to_degrees(double angle_rad) {
  return std::round(angle_rad / kDegree * 1e10) / 1e10;
}

double to_microseconds(Duration duration) {
  return static_cast<double>(duration.count()) / 1e3;
}

Duration from_microseconds(double microseconds) {
  return Duration{std::llround(microseconds * 1e3)};
}

template <typename Get>
std::vector<double> column(const std::vector<LidarBeam>& beams, Get get) {
  std::vector<double> values(beams.size());
  std::ranges::transform(beams, values.begin(), get);
  return values;
}

}  // namespace

void LidarSpec::describe(Parameters& p) {
  p.text("name", name);
  p.number("rate_hz", rate_hz, {.min = 1.0, .max = 100.0});
  p.flag("clockwise", clockwise);
  p.degrees("start_azimuth_deg", start_azimuth_rad, {.min = -360.0, .max = 360.0});
  p.number("range_min_m", range_min_m, kNotNegative);
  p.number("range_max_m", range_max_m, {.min = 1.0, .max = 1000.0});
  p.number("range_noise_m", range_noise_m, {.min = 0.0, .max = 1.0});
  if (range_min_m >= range_max_m) {
    p.fail("range_min_m", "is not below range_max_m; exchange or correct them");
  }

  double cycle_us = to_microseconds(cycle);
  p.number("cycle_us", cycle_us, {.min = 1.0, .max = 1e4});
  cycle = from_microseconds(cycle_us);
  if (cycle > period()) p.fail("cycle_us", "is longer than a revolution at rate_hz");

  auto elevations_deg = column(beams, [](auto& b) { return to_degrees(b.elevation_rad); });
  auto offsets_deg = column(beams, [](auto& b) { return to_degrees(b.azimuth_offset_rad); });
  auto times_us = column(beams, [](auto& b) { return to_microseconds(b.firing_time); });
  p.numbers("elevations_deg", elevations_deg, 0, {.min = -90.0, .max = 90.0});
  const std::size_t size = elevations_deg.size();
  if (size == 0 || size > 1024) p.fail("elevations_deg", "needs 1 to 1024 numbers, one a laser");
  offsets_deg.resize(size);
  times_us.resize(size);
  p.numbers("azimuth_offsets_deg", offsets_deg, size, {.min = -180.0, .max = 180.0});
  p.numbers("firing_times_us", times_us, size, {.min = 0.0, .max = cycle_us});
  if (!std::ranges::is_sorted(times_us) || times_us.back() >= cycle_us) {
    p.fail("firing_times_us", "needs numbers that do not fall and stay below cycle_us");
  }
  beams.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    beams[i] = {.elevation_rad = elevations_deg[i] * kDegree,
                .azimuth_offset_rad = offsets_deg[i] * kDegree,
                .firing_time = from_microseconds(times_us[i])};
  }
}

Duration LidarSpec::period() const {
  return duration_from_seconds(1.0 / rate_hz);
}

std::size_t LidarSpec::cycles() const {
  return static_cast<std::size_t>(period() / cycle);
}

std::vector<std::uint16_t> LidarSpec::rings() const {
  std::vector<std::uint16_t> upwards(beams.size());
  std::iota(upwards.begin(), upwards.end(), std::uint16_t{0});
  std::ranges::stable_sort(upwards, {}, [&](auto i) { return beams[i].elevation_rad; });
  std::vector<std::uint16_t> rings(beams.size());
  for (std::uint16_t ring = 0; ring < upwards.size(); ++ring) rings[upwards[ring]] = ring;
  return rings;
}

}  // namespace locsim::sim
