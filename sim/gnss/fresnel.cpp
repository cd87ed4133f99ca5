#include "sim/gnss/fresnel.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace locsim::sim {

namespace {

// Scattering: walls of real buildings at 1.3 GHz, S of 0.2 to 0.4 (Degli-Esposti et al. 2007).
constexpr RadioMaterial kConcrete{5.24, 0.066, false, 0.4};
constexpr RadioMaterial kGlass{6.31, 0.0066, false, 0.3};
constexpr RadioMaterial kDryGround{4.0, 1e-5};
constexpr RadioMaterial kMetal{1.0, 1.45e6, false, 0.3};
// ITU-R P.2040, f in GHz: wood 1.99, 0.0047 f^1.0718.
constexpr RadioMaterial kWood{1.99, 0.0077};
// Likewise: brick 3.91, 0.0238 f^0.16.
constexpr RadioMaterial kBrick{3.91, 0.0256, false, 0.4};
constexpr RadioMaterial kFoliage{1.0, 0.0, true};

struct Named {
  std::string_view name;
  RadioMaterial material;
};
constexpr std::array kNamed = {
    Named{"asphalt", kConcrete},
    Named{"lane_marking", kConcrete},
    Named{"kerb", kConcrete},
    Named{"pavement", kConcrete},
    Named{"grass", kDryGround},
    Named{"ground", kDryGround},
    Named{"brick", kBrick},
    Named{"plaster_light", kConcrete},
    Named{"plaster_dark", kConcrete},
    Named{"concrete", kConcrete},
    Named{"glass", kGlass},
    Named{"window_frame", kWood},
    Named{"roof_tile", kBrick},
    Named{"coated_glass", kMetal},
    Named{"metal", kMetal},
    Named{"metal_painted", kMetal},
    Named{"metal_galvanised", kMetal},
    Named{"wood", kWood},
    Named{"bark", kWood},
    Named{"foliage", kFoliage},
    Named{"sign_retroreflective", kMetal},
    Named{"car_paint_light", kMetal},
    Named{"car_paint_dark", kMetal},
    Named{"licence_plate", kMetal},
};

}  // namespace

RadioMaterial radio_material(std::string_view name) {
  for (const Named& known : kNamed) {
    if (known.name == name) return known.material;
  }
  return kConcrete;
}

LinearReflection reflect_linear(const RadioMaterial& material, double grazing_rad,
                                double wavelength_m) {
  assert(grazing_rad >= 0.0 && grazing_rad <= 0.5 * std::numbers::pi + 1e-9 && wavelength_m > 0.0);
  constexpr double kVacuumPermittivity_f_m = 8.8541878128e-12;
  const double angular_rate = 2.0 * std::numbers::pi * kSpeedOfLight_m_s / wavelength_m;
  const std::complex<double> permittivity(
      material.relative_permittivity,
      -material.conductivity_s_m / (angular_rate * kVacuumPermittivity_f_m));
  const double sine = std::sin(grazing_rad);
  const double cosine = std::cos(grazing_rad);
  const std::complex<double> root = std::sqrt(permittivity - cosine * cosine);
  return {.horizontal = (sine - root) / (sine + root),
          .vertical = (permittivity * sine - root) / (permittivity * sine + root)};
}

CircularReflection reflect_circular(const RadioMaterial& material, double grazing_rad,
                                    double wavelength_m) {
  const LinearReflection linear = reflect_linear(material, grazing_rad, wavelength_m);
  return {.co = 0.5 * (linear.horizontal + linear.vertical),
          .cross = 0.5 * (linear.horizontal - linear.vertical)};
}

CircularReflection reflect_rough(const RadioMaterial& material, double grazing_rad,
                                 double wavelength_m) {
  CircularReflection reflection = reflect_circular(material, grazing_rad, wavelength_m);
  const double power = std::norm(reflection.co) + std::norm(reflection.cross);
  const double scattered = material.scattering * material.scattering;
  const double left = std::sqrt(std::max(0.0, 1.0 - scattered / power));
  reflection.co *= left;
  reflection.cross *= left;
  return reflection;
}

double knife_edge_loss_db(double v) {
  if (v <= -0.78) return 0.0;
  const double x = v - 0.1;
  return 6.9 + 20.0 * std::log10(std::sqrt(x * x + 1.0) + x);
}

}  // namespace locsim::sim
