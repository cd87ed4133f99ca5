#include "sim/weather/weather.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>

#include "core/error.h"

namespace locsim::sim {

namespace {

// −ln of the contrast at the visibility.
const double kVisibilityContrast = std::log(20.0);
constexpr double kFogBackscatter = 0.046;
constexpr double kDustLidarRatio_sr = 45.0;

constexpr double kWaterIndex = 1.328;  // at 905 nm, as LISA has it
constexpr double kWaterDensity_kg_m3 = 1000.0;
// Holroyd (1971) has 170 kg/m³·mm/D, which is this at 1.7 mm; one density for all sizes keeps
// their distribution exponential.
constexpr double kFlakeDensity_kg_m3 = 100.0;
constexpr double kSnowAlbedo = 0.9;

// A sphere's rays near its axis come back from its front and, focused, from its rear. With the
// impact parameter b = r·i at an angle of incidence i, they leave at δ = 2i and (4/n − 2)i from
// the axis; (b/δ)² gives r²/4 and r²/4·(n/(2−n))² per sr, times the Fresnel reflectances on the
// way. A flat diffuse target of the same outline has ρ·r².
double drop_reflectivity(double index) {
  const double fresnel = std::pow((index - 1.0) / (index + 1.0), 2);
  const double rear = std::pow((1.0 - fresnel) * index / (2.0 - index), 2);
  return fresnel * (1.0 + rear) / 4.0;
}

double extinction_of_visibility(double visibility_m) {
  return visibility_m < WeatherSpec::kClearVisibility_m ? kVisibilityContrast / visibility_m : 0.0;
}

bool is_clear(const WeatherSpec& spec) {
  return spec.rain_mm_h == 0.0 && spec.snow_mm_h == 0.0 &&
         extinction_of_visibility(spec.fog_visibility_m) == 0.0 &&
         extinction_of_visibility(spec.dust_visibility_m) == 0.0;
}

}  // namespace

void WeatherSpec::describe(Parameters& p) {
  constexpr Bounds kVisibility_m{.min = 5.0, .max = kClearVisibility_m};
  p.number("at_s", at_s, {.min = 0.0, .max = 1e7});
  p.number("rain_mm_h", rain_mm_h, {.min = 0.0, .max = 200.0});
  p.number("snow_mm_h", snow_mm_h, {.min = 0.0, .max = 50.0});
  p.number("fog_visibility_m", fog_visibility_m, kVisibility_m);
  p.number("dust_visibility_m", dust_visibility_m, kVisibility_m);
}

Particles raindrops(double rain_mm_h) {
  return {.number_1_m3_mm = 8000.0,
          .slope_1_mm = 4.1 * std::pow(rain_mm_h, -0.21),
          .reflectivity = drop_reflectivity(kWaterIndex)};
}

Particles snowflakes(double snow_mm_h) {
  // Gunn and Marshall count melted diameters; a flake is wider than its drop by this.
  const double widening = std::cbrt(kWaterDensity_kg_m3 / kFlakeDensity_kg_m3);
  return {.number_1_m3_mm = 3800.0 * std::pow(snow_mm_h, -0.87) / widening,
          .slope_1_mm = 2.55 * std::pow(snow_mm_h, -0.48) / widening,
          // Lambert's law on a sphere: ⅔ of the flat disk's.
          .reflectivity = kSnowAlbedo * 2.0 / 3.0};
}

double extinction_1_m(const Particles& particles) {
  // 2 · ∫ N(D) · π·D²/4 dD, in mm²/m³.
  return 1e-6 * std::numbers::pi * particles.number_1_m3_mm / std::pow(particles.slope_1_mm, 3);
}

bool Atmosphere::is_clear() const {
  return extinction_1_m == 0.0 && backscatter_1_m_sr == 0.0 && rain.number_1_m3_mm == 0.0 &&
         snow.number_1_m3_mm == 0.0;
}

Weather::Weather(std::vector<WeatherSpec> specs, Stamp start)
    : specs_(std::move(specs)), start_(start) {
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    const std::string place = "weather[" + std::to_string(i) + "]";
    check_parameters(specs_[i], place);
    if (i == 0 || specs_[i].at_s > specs_[i - 1].at_s) continue;
    std::ostringstream message;
    message << place << ": at_s: is " << specs_[i].at_s << ", not after " << specs_[i - 1].at_s
            << " of the entry before; sort the list by time, one entry a time";
    throw InputError(message.str());
  }
}

Atmosphere Weather::at(Stamp time) const {
  if (is_clear()) return {};
  const double t_s = to_seconds(time - start_);
  const auto next = std::ranges::upper_bound(specs_, t_s, {}, &WeatherSpec::at_s);
  const WeatherSpec& b = next == specs_.end() ? specs_.back() : *next;
  const WeatherSpec& a = next == specs_.begin() ? b : *(next - 1);
  const double share = b.at_s > a.at_s ? (t_s - a.at_s) / (b.at_s - a.at_s) : 0.0;

  const double fog_1_m = std::lerp(extinction_of_visibility(a.fog_visibility_m),
                                   extinction_of_visibility(b.fog_visibility_m), share);
  const double dust_1_m = std::lerp(extinction_of_visibility(a.dust_visibility_m),
                                    extinction_of_visibility(b.dust_visibility_m), share);
  Atmosphere air{.extinction_1_m = fog_1_m + dust_1_m,
                 .backscatter_1_m_sr = fog_1_m * kFogBackscatter / kVisibilityContrast +
                                       dust_1_m / kDustLidarRatio_sr,
                 .rain = {},
                 .snow = {}};
  const double rain_mm_h = std::lerp(a.rain_mm_h, b.rain_mm_h, share);
  const double snow_mm_h = std::lerp(a.snow_mm_h, b.snow_mm_h, share);
  if (rain_mm_h > 0.0) air.rain = raindrops(rain_mm_h);
  if (snow_mm_h > 0.0) air.snow = snowflakes(snow_mm_h);
  air.extinction_1_m += extinction_1_m(air.rain) + extinction_1_m(air.snow);
  return air;
}

bool Weather::is_clear() const {
  return std::ranges::all_of(specs_, [](const WeatherSpec& spec) { return sim::is_clear(spec); });
}

}  // namespace locsim::sim
