#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "sim/lidar/lidar_spec.h"
#include "tests/scenarios/lidar_preset.h"

namespace locsim::scenarios {
namespace {

using sim::LidarBeam;
using sim::LidarSpec;

// 0 at the start of a sweep, 1 in its middle, 0 at its end.
double triangle(double sweeps) {
  return 1.0 - std::abs(2.0 * (sweeps - std::floor(sweeps)) - 1.0);
}

TEST(Mid360, SweepsAsItsTableDoes) {
  const LidarSpec spec = lidar_preset("mid360");
  ASSERT_EQ(spec.beams.size(), 4U);
  // Mean zenith of the four lines in Livox's mid360.csv, which starts at the sweep's upper end.
  // It is rounded at both ends and reaches 1.6° less far down than an even one of four lines.
  constexpr std::array<std::pair<double, double>, 10> kTable_ms_deg = {{{0.0, 42.10},
                                                                        {6.5, 46.35},
                                                                        {16.6, 60.27},
                                                                        {27.0, 72.37},
                                                                        {40.0, 87.39},
                                                                        {52.3, 93.81},
                                                                        {56.0, 91.65},
                                                                        {95.68, 44.3},
                                                                        {99.7, 42.2},
                                                                        {250.8, 94.11}}};
  double middle_deg = 0.0;
  for (const LidarBeam& beam : spec.beams) middle_deg += 0.25 * elevation_deg(beam);
  const double amplitude_deg = spec.nod_amplitude_rad / kDegree;
  for (const auto& [time_ms, zenith_deg] : kTable_ms_deg) {
    const double sweeps = 1e-3 * time_ms * spec.nod_rate_hz;
    const double ours_deg =
        90.0 - middle_deg - amplitude_deg + 2.0 * amplitude_deg * triangle(sweeps);
    EXPECT_NEAR(ours_deg, zenith_deg, 4.4) << time_ms << " ms";
  }
  // Whole turns of its head, told by the azimuth of the lines' middle; the speed varies by 3 %
  // within a sweep, which the count at its middle feels (0.08 turns).
  for (const auto& [time_ms, turns] :
       {std::pair{27.8, 5.0}, {54.7, 10.0}, {98.6, 18.0}, {249.4, 45.49}}) {
    EXPECT_NEAR(1e-3 * time_ms * spec.head_rate_hz, turns, 0.09) << time_ms << " ms";
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(spec.beams[i].firing_time, Duration{0});
    if (i == 0) continue;
    const double gap_deg = elevation_deg(spec.beams[i]) - elevation_deg(spec.beams[i - 1]);
    EXPECT_GT(gap_deg, 1.9);
    EXPECT_LT(gap_deg, 2.75);
  }
  EXPECT_NEAR(elevation_deg(spec.beams.front()) - amplitude_deg, -7.0, 1e-6);
  EXPECT_NEAR(elevation_deg(spec.beams.back()) + amplitude_deg, 52.0, 1e-6);
}

TEST(Mid360, CoverageKeepsGrowing) {
  const LidarSpec spec = lidar_preset("mid360");
  constexpr std::size_t kColumns = 720;
  constexpr std::size_t kRows = 118;
  std::vector<bool> seen(kColumns * kRows);
  std::size_t cells = 0;
  std::vector<double> coverage;
  const auto scans = [&](std::int64_t count) { return count * 5000; };
  std::int64_t cycle = 0;
  for (const std::int64_t until : {scans(1), scans(2), scans(4), scans(8), scans(16)}) {
    for (; cycle < until; ++cycle) {
      const double time_s = static_cast<double>(cycle) * to_seconds(spec.cycle);
      const double turns = time_s * spec.head_rate_hz;
      const auto column = static_cast<std::size_t>((turns - std::floor(turns)) * kColumns);
      const double nod_rad =
          spec.nod_amplitude_rad * (2.0 * triangle(time_s * spec.nod_rate_hz) - 1.0);
      for (const LidarBeam& beam : spec.beams) {
        const double above_deg = (beam.elevation_rad + nod_rad) / kDegree + 7.0;
        const auto row =
            std::min(static_cast<std::size_t>(std::max(2.0 * above_deg, 0.0)), kRows - 1);
        const std::size_t cell = std::min(column, kColumns - 1) * kRows + row;
        if (!seen[cell]) ++cells;
        seen[cell] = true;
      }
    }
    coverage.push_back(static_cast<double>(cells) / static_cast<double>(seen.size()));
  }
  // Of cells of half a degree. One scan of 20 000 points into 84 960 cells hits at most 23.5 % of
  // them. Scans put at random would hit 1 − e^(−0.235 n); lines that run beside each other may cost
  // a quarter of the exponent. A pattern that repeats stands still.
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    const double scans_so_far = std::pow(2.0, static_cast<double>(i));
    EXPECT_GT(coverage[i], 1.0 - std::exp(-0.176 * scans_so_far)) << scans_so_far;
    EXPECT_LE(coverage[i], std::min(1.0, 0.2355 * scans_so_far)) << scans_so_far;
    if (i > 0) {
      EXPECT_GT(coverage[i], coverage[i - 1] + 0.02) << scans_so_far;
    }
    RecordProperty("coverage_" + std::to_string(i), std::to_string(coverage[i]));
  }
}

}  // namespace
}  // namespace locsim::scenarios
