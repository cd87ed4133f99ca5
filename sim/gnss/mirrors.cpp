#include "sim/gnss/mirrors.h"

#include <algorithm>
#include <cmath>

#include "sim/gnss/fresnel.h"
#include "sim/gnss/radio_rays.h"

namespace locsim::sim {

namespace {

// Waves along a surface do not turn on it.
constexpr float kLeastSine = 1e-3F;
// What rounding and the reflector's own unevenness may add to its bounds, squared.
constexpr float kSlack2_m2 = 0.15F * 0.15F;

}  // namespace

Reflector moved(const Reflector& reflector, const Pose& T_map_actor) {
  Reflector there = reflector;
  there.bounds.setEmpty();
  for (int corner = 0; corner < 8; ++corner) {
    there.bounds.extend(T_map_actor * Vector3d(reflector.bounds.corner(
                                          static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
  }
  there.center = T_map_actor * reflector.center;
  there.normal = T_map_actor.rotation * reflector.normal;
  return there;
}

Specular::Specular(const Vector3d& normal, const Vector3d& on_plane, const Vector3d& antenna,
                   const Vector3d& to_satellite)
    : off_m(normal.dot(antenna - on_plane)), sine(normal.dot(to_satellite)) {
  range_m = off_m / sine;
  // The antenna's image sees the satellite through the point.
  turn = antenna - 2.0 * off_m * normal + range_m * to_satellite;
}

Mirrors::Mirrors(const Vector3d& antenna, double reach_m, std::vector<const Reflector*> standing,
                 std::vector<std::pair<Reflector, std::uint32_t>> moving)
    : reach_m_(reach_m), moving_(std::move(moving)) {
  mirrors_.reserve(standing.size() + moving_.size());
  for (const Reflector* one : standing) mirrors_.push_back({one, RadioRays::kStands});
  for (const auto& [one, bearer] : moving_) mirrors_.push_back({&one, bearer});
  constexpr std::size_t kLanes = Block::Lanes::SizeAtCompileTime;
  blocks_.resize((mirrors_.size() + kLanes - 1) / kLanes);
  for (Block& block : blocks_) {
    block.off_m = -1.0F;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      block.normal[axis] = block.middle_m[axis] = block.half_m[axis] = 0.0F;
    }
  }
  for (std::size_t i = 0; i < mirrors_.size(); ++i) {
    const Reflector& s = *mirrors_[i].surface;
    Block& block = blocks_[i / kLanes];
    const auto lane = static_cast<Eigen::Index>(i % kLanes);
    block.off_m[lane] = static_cast<float>(s.normal.dot(antenna - s.center));
    const Vector3d middle = s.bounds.center() - antenna;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      block.normal[k][lane] = static_cast<float>(s.normal[axis]);
      block.middle_m[k][lane] = static_cast<float>(middle[axis]);
      block.half_m[k][lane] = static_cast<float>(0.5 * s.bounds.sizes()[axis]);
    }
  }
}

std::vector<Mirror> Mirrors::facing(const Vector3d& to_satellite) const {
  using Lanes = Block::Lanes;
  const Vector3f s = to_satellite.cast<float>();
  const auto reach_m = static_cast<float>(reach_m_);
  constexpr auto kZone2_m = static_cast<float>(kZoneReach * kZoneReach * kL1Wavelength_m);
  std::vector<Mirror> found;
  std::size_t first = 0;
  for (const Block& block : blocks_) {
    const Lanes sine = s.x() * block.normal[0] + s.y() * block.normal[1] + s.z() * block.normal[2];
    const Lanes per_sine = sine.max(kLeastSine).inverse();
    const Lanes range_m = block.off_m * per_sine;
    // Less than nothing where the turning point is in reach and in front.
    Lanes excess = (range_m - reach_m).max(kLeastSine - sine).max(-block.off_m);
    // Neighbours face much the same way: most blocks are out of question here.
    if (excess.minCoeff() >= 0.0F) {
      first += static_cast<std::size_t>(Lanes::SizeAtCompileTime);
      continue;
    }
    const Lanes zone2_m2 = kZone2_m * range_m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // How far the turning point lies out of the bounds, against half the extent of the Fresnel
      // zone: an ellipse in the plane, longer by 1/sine along the wave.
      const Lanes& n = block.normal[axis];
      const float s_axis = s[static_cast<Eigen::Index>(axis)];
      const Lanes across = s_axis - sine * n;
      const Lanes out_m =
          ((range_m * (across - sine * n) - block.middle_m[axis]).abs() - block.half_m[axis])
              .max(0.0F);
      excess = excess.max(out_m.square() - kSlack2_m2 -
                          zone2_m2 * (1.0F - n.square() + (across * per_sine).square()));
    }
    if (excess.minCoeff() < 0.0F) {
      for (Eigen::Index lane = 0; lane < excess.size(); ++lane) {
        if (excess[lane] < 0.0F) found.push_back(mirrors_[first + static_cast<std::size_t>(lane)]);
      }
    }
    first += static_cast<std::size_t>(Lanes::SizeAtCompileTime);
  }
  std::ranges::stable_sort(found, std::ranges::greater{},
                           [](const Mirror& mirror) { return mirror.surface->area_m2; });
  return found;
}

}  // namespace locsim::sim
