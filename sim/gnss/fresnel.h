#pragma once

#include <complex>
#include <string_view>

#include "core/physics.h"

namespace locsim::sim {

/// Of GPS L1 and Galileo E1; BeiDou B1I and GLONASS L1 are within 2 % of it.
inline constexpr double kL1Carrier_hz = 1575.42e6;
inline constexpr double kL1Wavelength_m = kSpeedOfLight_m_s / kL1Carrier_hz;

/// A half space as radio waves meet it.
struct RadioMaterial {
  double relative_permittivity = 5.24;
  double conductivity_s_m = 0.066;
  /// Of twigs and leaves: lets waves through, weakened, and has no face to mirror them.
  bool is_foliage = false;
  /// S: the square of it is the share of the power falling on a wall of it that is scattered all
  /// ways.
  double scattering = 0.0;
};

/// At 1.6 GHz, by the name of a material of the world (`town_materials()` or a mesh file's).
/// Concrete and glass after ITU-R P.2040, dry ground and steel after Hannah (2001); masonry, tiles
/// and road count as concrete, lacquered sheet as the metal under it, coated panes as the metal on
/// them. What is not known counts as concrete.
[[nodiscard]] RadioMaterial radio_material(std::string_view name);

/// Amplitude and phase of the reflected field over the incoming one.
struct LinearReflection {
  /// Field in the plane of the surface.
  std::complex<double> horizontal;
  /// Field in the plane of incidence.
  std::complex<double> vertical;
};
/// Fresnel's equations for a smooth half space met at `grazing_rad` (0…π/2, from the surface) out
/// of air. A pane counts as a half space too: what its back sends on is left out.
[[nodiscard]] LinearReflection reflect_linear(const RadioMaterial& material, double grazing_rad,
                                              double wavelength_m);

/// The same for circular polarisation: what keeps the sense of rotation, and what has it turned.
struct CircularReflection {
  std::complex<double> co;
  std::complex<double> cross;
};
[[nodiscard]] CircularReflection reflect_circular(const RadioMaterial& material, double grazing_rad,
                                                  double wavelength_m);

/// What a wall that scatters leaves to the mirror's direction: √(1 − S²/Γ²) of the field, Γ² the
/// share of power that a smooth one would reflect; nothing where it scatters more than that.
[[nodiscard]] CircularReflection reflect_rough(const RadioMaterial& material, double grazing_rad,
                                               double wavelength_m);

/// What a knife edge takes from a signal [dB], by Fresnel's parameter: positive in the shadow, 0
/// on its boundary; ITU-R P.526-15 eq. (31), nothing where v ≤ −0.78.
[[nodiscard]] double knife_edge_loss_db(double v);

}  // namespace locsim::sim
