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

double to_milliradians(double angle_rad) {
  return std::round(angle_rad * 1e13) / 1e10;
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

void LidarEffects::describe(Parameters& p) {
  p.flag("noise", noise);
  p.flag("beam_bias", beam_bias);
  p.flag("quantisation", quantisation);
  p.flag("detection_limit", detection_limit);
  p.flag("incidence", incidence);
  p.flag("glass", glass);
  p.flag("retroreflection", retroreflection);
  p.flag("weather", weather);
}

void LidarSpec::describe(Parameters& p) {
  p.text("name", name);
  p.number("wavelength_nm", wavelength_nm, {.min = 400.0, .max = 2000.0});
  describe_scanning(p);
  describe_ranging(p);
  describe_pulse(p);
  p.group("effects", effects);
  describe_beams(p);
}

void LidarSpec::describe_scanning(Parameters& p) {
  p.number("rate_hz", rate_hz, {.min = 1.0, .max = 100.0});
  p.number("head_rate_hz", head_rate_hz, {.min = 0.0, .max = 1000.0});
  p.degrees("nod_amplitude_deg", nod_amplitude_rad, {.min = 0.0, .max = 90.0});
  p.number("nod_rate_hz", nod_rate_hz, {.min = 0.0, .max = 1e4});
  p.flag("clockwise", clockwise);
  p.degrees("start_azimuth_deg", start_azimuth_rad, {.min = -360.0, .max = 360.0});
  p.number("beam_origin_m", beam_origin_m, {.min = 0.0, .max = 0.5});
}

void LidarSpec::describe_ranging(Parameters& p) {
  p.number("range_min_m", range_min_m, kNotNegative);
  p.number("range_max_m", range_max_m, {.min = 1.0, .max = 1000.0});
  if (range_min_m >= range_max_m) {
    p.fail("range_min_m", "is not below range_max_m; exchange or correct them");
  }
  p.number("detection_range_m", detection_range_m, {.min = 1.0, .max = 10'000.0});
  p.number("detection_reflectivity", detection_reflectivity, {.min = 0.001, .max = 1.0});
  p.number("range_noise_m", range_noise_m, {.min = 0.0, .max = 1.0});
  p.number("weak_range_noise_m", weak_range_noise_m, {.min = 0.0, .max = 1.0});
  p.number("range_step_m", range_step_m, {.min = 0.0, .max = 1.0});
  p.number("beam_bias_m", beam_bias_m, {.min = 0.0, .max = 1.0});
}

void LidarSpec::describe_pulse(Parameters& p) {
  std::vector<double> divergence_mrad = {to_milliradians(divergence_rad[0]),
                                         to_milliradians(divergence_rad[1])};
  p.numbers("divergence_mrad", divergence_mrad, 2, {.min = 0.0, .max = 100.0});
  for (std::size_t i = 0; i < 2; ++i) divergence_rad[i] = 1e-3 * divergence_mrad[i];
  p.number("pulse_ns", pulse_ns, {.min = 0.1, .max = 100.0});
  p.integer("sub_rays", sub_rays, {.min = 1.0, .max = 9.0});
  if (std::ranges::find(kSubRays, sub_rays) == kSubRays.end()) {
    p.fail("sub_rays", "is " + std::to_string(sub_rays) + ", needs 1, 5, 7 or 9");
  }
  p.choice("returns", returns, kReturnModes);
}

void LidarSpec::describe_beams(Parameters& p) {
  double cycle_us = to_microseconds(cycle);
  p.number("cycle_us", cycle_us, {.min = 1.0, .max = 1e4});
  cycle = from_microseconds(cycle_us);
  if (cycle > period()) p.fail("cycle_us", "is longer than a scan at rate_hz");

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

bool LidarSpec::repeats() const {
  return (head_rate_hz == 0.0 || head_rate_hz == rate_hz) && nod_amplitude_rad == 0.0;
}

double LidarSpec::turn_rate_rad_s() const {
  const double turns_1_s = head_rate_hz == 0.0 ? rate_hz : head_rate_hz;
  return (clockwise ? -2.0 : 2.0) * std::numbers::pi * turns_1_s;
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
