#pragma once

#include <vector>

#include "core/parameters.h"
#include "core/time.h"

namespace locsim::sim {

/// What the weather is at one time of a scenario. Both visibilities are meteorological optical
/// ranges, where contrast has fallen to 5 %.
struct WeatherSpec {
  /// This far and no fog or dust are the same.
  static constexpr double kClearVisibility_m = 1e5;

  /// After the scenario's start.
  double at_s = 0.0;
  double rain_mm_h = 0.0;
  /// Melted.
  double snow_mm_h = 0.0;
  double fog_visibility_m = kClearVisibility_m;
  double dust_visibility_m = kClearVisibility_m;

  void describe(Parameters& p);
};

/// Drops or flakes: N(D) = number_1_m3_mm · exp(−slope_1_mm · D) per m³ and mm of diameter.
struct Particles {
  double number_1_m3_mm = 0.0;
  double slope_1_mm = 1.0;
  /// Of one of them, as a flat diffuse target that covers its cross section π·D²/4.
  double reflectivity = 0.0;
};

/// Raindrops (Marshall & Palmer 1948) at a rate above 0, as spheres of water in near infrared.
[[nodiscard]] Particles raindrops(double rain_mm_h);
/// Snowflakes (Gunn & Marshall 1958) at a melted rate above 0, as white spheres of 100 kg/m³.
[[nodiscard]] Particles snowflakes(double snow_mm_h);
/// One-way extinction [1/m] of particles that are large against the wavelength: each takes twice
/// its cross section out of the beam, half by diffraction.
[[nodiscard]] double extinction_1_m(const Particles& particles);

/// The air between a LIDAR and its targets.
struct Atmosphere {
  /// One way, of everything in it.
  double extinction_1_m = 0.0;
  /// Of what fills the air evenly (fog, dust).
  double backscatter_1_m_sr = 0.0;
  Particles rain;
  Particles snow;

  /// Whether it is as good as vacuum: no extinction, nothing in it.
  [[nodiscard]] bool is_clear() const;
};

/// Weather that changes in time: straight between the times given (rates as they are, visibilities
/// by their extinction), constant before and after them. The same everywhere.
///
/// Extinction of fog and dust is ln 20/visibility (Koschmieder). Fog sends back 0.046/visibility
/// per m and sr (Rasshofer et al. 2011, Hahner et al. 2021), dust a 45th of its extinction: desert
/// dust has lidar ratios from about 20 sr near its source to 80 sr (Mattis et al. 2002 have
/// 50…80 sr), mostly 40…50 sr in near infrared.
class Weather {
 public:
  Weather() = default;
  /// Throws InputError where a value is out of its limits or times do not rise.
  explicit Weather(std::vector<WeatherSpec> specs, Stamp start = Stamp{});

  [[nodiscard]] Atmosphere at(Stamp time) const;
  /// Nothing to be modelled at any time.
  [[nodiscard]] bool is_clear() const;

 private:
  std::vector<WeatherSpec> specs_;
  Stamp start_;
};

}  // namespace locsim::sim
