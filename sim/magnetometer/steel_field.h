#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/pose.h"
#include "core/time.h"
#include "sim/actors.h"
#include "sim/world/world.h"

namespace locsim::sim {

/// Magnetism of steel structures and vehicles, thin-walled as they are. One tonne makes 1 nT at
/// 30 m by induction (Geometrics' rule of thumb; Breiner 1999, Applications Manual for Portable
/// Magnetometers): 135 A·m² on its axis, 270 A·m² beside it. Permanent magnets add a factor of
/// several for many objects; twice the induced part agrees with the 100 A·m² to 400 A·m² of
/// passenger cars.
namespace steel {
inline constexpr double kInduced_A_m2_kg_T = 3000.0;
/// Root mean square over bodies; each axis is normally distributed.
inline constexpr double kPermanent_A_m2_kg = 0.3;
/// Mass over the space that a body takes up: a car of 0.8 t fills 9 m³.
inline constexpr double kBulkDensity_kg_m3 = 90.0;
/// Fields below this are left out.
inline constexpr double kNegligible_T = 10e-9;
}  // namespace steel

/// Flux density [T] of a dipole of moment `moment_A_m2` at its middle, at `offset_m` from it:
///
///     B = μ₀/4π · (3·(m·r)·r/ρ⁵ − m/ρ³),   ρ = max(r, radius)
///
/// Outside `radius_m` that is the field of a point; within, it is bounded, and is at the middle
/// μ₀ times the demagnetising field of a sphere of that radius.
[[nodiscard]] Vector3d dipole_field_T(const Vector3d& moment_A_m2, const Vector3d& offset_m,
                                      double radius_m);

/// Radius of a ball of `mass_kg` at bulk density.
[[nodiscard]] double steel_radius_m(double mass_kg);

/// What the steel of the scene, standing and moving, adds to the earth's magnetic field.
///
/// Each body is a dipole: a part that the earth's field induces along itself, and a permanent
/// part that is drawn for each body and turns with it. Bodies do not magnetise each other.
class SteelField {
 public:
  /// `actors` must outlive the field. Shapes for which `world` names no steel have none.
  SteelField(const World& world, std::span<const Actor> actors, const Vector3d& earth_field_map_T,
             std::uint64_t seed);

  /// In the map frame [T].
  [[nodiscard]] Vector3d at(const Vector3d& p_map, Stamp time) const;

 private:
  /// In the map frame, or in that of the actor it belongs to.
  struct Dipole {
    Vector3d position;
    Vector3d permanent_A_m2;
    /// Always along the axes of the map.
    Vector3d induced_A_m2;
    double radius_m;
    double reach_m;
  };
  struct Moving {
    const Actor* actor;
    /// Beyond it from the actor's origin nothing is felt.
    double reach_m;
    std::vector<Dipole> dipoles;
  };

  [[nodiscard]] static Dipole make_dipole(const SteelBody& body, const Vector3d& draw,
                                          const Vector3d& earth_field_map_T);
  void index_standing();

  std::vector<Dipole> standing_;
  /// Of each square of the ground, the standing dipoles that reach it.
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> squares_;
  std::vector<Moving> moving_;
};

}  // namespace locsim::sim
