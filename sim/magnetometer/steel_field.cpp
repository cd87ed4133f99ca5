#include "sim/magnetometer/steel_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.h"

namespace locsim::sim {

namespace {

constexpr double kMu0Over4Pi = 1e-7;  // T·m/A
constexpr double kSquare_m = 16.0;

std::int64_t square_of(double coordinate_m) {
  return static_cast<std::int64_t>(std::floor(coordinate_m / kSquare_m));
}

std::int64_t square_key(std::int64_t ix, std::int64_t iy) {
  return ix * (std::int64_t{1} << 32) + iy;
}

}  // namespace

Vector3d dipole_field_T(const Vector3d& moment_A_m2, const Vector3d& offset_m, double radius_m) {
  const double rho = std::max(offset_m.norm(), radius_m);
  const double rho3 = rho * rho * rho;
  return kMu0Over4Pi / rho3 *
         (3.0 / (rho * rho) * moment_A_m2.dot(offset_m) * offset_m - moment_A_m2);
}

double steel_radius_m(double mass_kg) {
  return std::cbrt(3.0 * mass_kg / (4.0 * std::numbers::pi * steel::kBulkDensity_kg_m3));
}

SteelField::Dipole SteelField::make_dipole(const SteelBody& body, const Vector3d& draw,
                                           const Vector3d& earth_field_map_T) {
  Dipole dipole{
      .position = body.position,
      .permanent_A_m2 = steel::kPermanent_A_m2_kg / std::numbers::sqrt3 * body.mass_kg * draw,
      .induced_A_m2 = steel::kInduced_A_m2_kg_T * body.mass_kg * earth_field_map_T,
      .radius_m = steel_radius_m(body.mass_kg),
      .reach_m = 0.0};
  // The field on the dipole's axis, where it is strongest, is 2·μ₀/4π·m/r³.
  const double moment = dipole.permanent_A_m2.norm() + dipole.induced_A_m2.norm();
  dipole.reach_m = std::cbrt(2.0 * kMu0Over4Pi * moment / steel::kNegligible_T);
  return dipole;
}

SteelField::SteelField(const World& world, std::span<const Actor> actors,
                       const Vector3d& earth_field_map_T, std::uint64_t seed) {
  const RandomStream standing(seed, "steel/standing");
  standing_.reserve(world.steel.size());
  for (std::size_t i = 0; i < world.steel.size(); ++i) {
    standing_.push_back(make_dipole(world.steel[i], standing.gaussian3(i), earth_field_map_T));
  }
  index_standing();

  const RandomStream drawn(seed, "steel/actors");
  for (std::size_t a = 0; a < actors.size(); ++a) {
    if (actors[a].shape >= world.actor_steel.size()) continue;
    Moving moving{.actor = &actors[a], .reach_m = 0.0, .dipoles = {}};
    const std::vector<SteelBody>& bodies = world.actor_steel[actors[a].shape];
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Dipole& dipole = moving.dipoles.emplace_back(
          make_dipole(bodies[i], drawn.gaussian3(a, i), earth_field_map_T));
      moving.reach_m = std::max(moving.reach_m, dipole.position.norm() + dipole.reach_m);
    }
    if (!moving.dipoles.empty()) moving_.push_back(std::move(moving));
  }
}

void SteelField::index_standing() {
  for (std::size_t i = 0; i < standing_.size(); ++i) {
    const Vector3d& p = standing_[i].position;
    const double reach = standing_[i].reach_m;
    for (std::int64_t ix = square_of(p.x() - reach); ix <= square_of(p.x() + reach); ++ix) {
      for (std::int64_t iy = square_of(p.y() - reach); iy <= square_of(p.y() + reach); ++iy) {
        squares_[square_key(ix, iy)].push_back(static_cast<std::uint32_t>(i));
      }
    }
  }
}

Vector3d SteelField::at(const Vector3d& p_map, Stamp time) const {
  Vector3d field = Vector3d::Zero();
  if (const auto square = squares_.find(square_key(square_of(p_map.x()), square_of(p_map.y())));
      square != squares_.end()) {
    for (const std::uint32_t i : square->second) {
      const Dipole& dipole = standing_[i];
      const Vector3d offset = p_map - dipole.position;
      if (offset.squaredNorm() >= dipole.reach_m * dipole.reach_m) continue;
      field += dipole_field_T(dipole.permanent_A_m2 + dipole.induced_A_m2, offset, dipole.radius_m);
    }
  }
  for (const Moving& moving : moving_) {
    const Pose T_map_actor = moving.actor->pose_at(time);
    if ((p_map - T_map_actor.translation).squaredNorm() > moving.reach_m * moving.reach_m) continue;
    for (const Dipole& dipole : moving.dipoles) {
      const Vector3d offset = p_map - T_map_actor * dipole.position;
      if (offset.squaredNorm() >= dipole.reach_m * dipole.reach_m) continue;
      field += dipole_field_T(T_map_actor.rotation * dipole.permanent_A_m2 + dipole.induced_A_m2,
                              offset, dipole.radius_m);
    }
  }
  return field;
}

}  // namespace locsim::sim
