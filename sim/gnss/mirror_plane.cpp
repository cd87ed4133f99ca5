#include "sim/gnss/mirror_plane.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "sim/gnss/fresnel_zone.h"

namespace locsim::sim {

MirrorPlane::MirrorPlane(std::span<const RadioMaterial> radio, const Vector3d& normal,
                         const Vector3d& on_plane, std::uint32_t bearer, double sine,
                         double least_cosine)
    : radio_(radio),
      normal_(normal),
      on_plane_(on_plane),
      bearer_(bearer),
      sine_(sine),
      least_cosine_(least_cosine),
      grazing_rad_(std::asin(std::min(sine, 1.0))) {}

std::optional<MirrorPlane::Met> MirrorPlane::met(const RayBundle::Ray& ray,
                                                 const RadioRays::End& end) const {
  if (!end.is_met() || end.actor != bearer_ || end.normal.dot(normal_) < least_cosine_) {
    return std::nullopt;
  }
  const Vector3d point = ray.origin + end.range_m * ray.direction;
  const double before_m = normal_.dot(point - on_plane_);
  if (std::abs(before_m) > kRelief_m) return std::nullopt;
  return Met{.point = point, .material = end.material, .before_m = before_m};
}

CircularReflection MirrorPlane::reflection(const Met& met) {
  if (known_material_ != met.material) {
    known_material_ = met.material;
    known_ = reflect_rough(radio_[met.material], grazing_rad_, kL1Wavelength_m);
  }
  const std::complex<double> turn =
      std::polar(1.0, 4.0 * std::numbers::pi * met.before_m * sine_ / kL1Wavelength_m);
  return {.co = turn * known_.co, .cross = turn * known_.cross};
}

}  // namespace locsim::sim
