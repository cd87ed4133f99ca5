#pragma once

#include <array>
#include <cstdint>

#include "core/geodesy.h"
#include "sim/gnss/satellites.h"
#include "sim/gnss/smooth_noise.h"

namespace locsim::sim {

/// The broadcast model of the ionosphere (IS-GPS-200, 20.3.3.5.2.5): α [s, s/semicircle, …],
/// β likewise.
struct KlobucharModel {
  std::array<double, 4> alpha = {};
  std::array<double, 4> beta = {};

  /// Delay of GPS L1 seen at `elevation_rad`, `azimuth_rad` (from north over east) from `place` at
  /// `time` [m]; other carriers scale with 1/f². 0 at and below the horizon.
  [[nodiscard]] double delay_m(const GeodeticPoint& place, double azimuth_rad, double elevation_rad,
                               GpsTime time) const;
};

/// The ionosphere: the broadcast model times e^(s·g − s²/2), where g is a smooth Gaussian field
/// over earth and time, drawn by seed: half its variance is the same everywhere (the day is quieter
/// or livelier than the model), half changes over some 1500 km. The factor has mean 1 and standard
/// deviation 0.4 (the model takes off more than half of the delay's RMS, as IS-GPS-200 claims of
/// it), and changes within hours. A pure function.
class Ionosphere {
 public:
  /// Without errors it is the model.
  Ionosphere(bool has_errors, std::uint64_t seed);

  /// α and β of 2004-01-01.
  [[nodiscard]] const KlobucharModel& broadcast() const { return model_; }
  /// As it is, GPS L1 [m]; arguments as for KlobucharModel.
  [[nodiscard]] double delay_m(const GeodeticPoint& place, double azimuth_rad, double elevation_rad,
                               GpsTime time) const;

 private:
  static constexpr std::size_t kWaves = 6;

  KlobucharModel model_;
  bool has_errors_;
  SmoothNoise noise_;
  // Of the field that differs from place to place, by the earth's radius.
  std::array<Vector3d, kWaves> wave_vectors_;
};

}  // namespace locsim::sim
