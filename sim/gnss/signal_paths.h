#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "core/pose.h"
#include "core/time.h"
#include "sim/gnss/fresnel.h"
#include "sim/gnss/reflectors.h"
#include "sim/ray_scene.h"
#include "sim/world/world.h"

namespace locsim::sim {

enum class PathKind : std::uint8_t { direct, diffracted, reflected };

/// One way from a satellite to an antenna. All in the map frame.
///
/// An antenna at velocity v makes `excess_m` change at (to_satellite − arrival)·(v −
/// surface_velocity_m_s); its phase turns by −2π/λ of that, beside the phase of co and cross.
struct SignalPath {
  PathKind kind = PathKind::direct;
  /// Longer than the straight line by this.
  double excess_m = 0.0;
  /// Field that arrives in the sense of rotation it was sent with, and in the other, over that of
  /// the unobstructed direct path; without the antenna's pattern.
  std::complex<double> co = 1.0;
  std::complex<double> cross = 0.0;
  /// Unit, from the antenna to where the signal comes from.
  Vector3d arrival = Vector3d::UnitZ();
  /// Depth of foliage crossed.
  double foliage_m = 0.0;
  /// Where it is reflected or bent; nothing on a direct path.
  Vector3d turn = Vector3d::Zero();
  /// Of a reflection: angle between ray and surface, what it is of, and how it moves.
  double grazing_rad = 0.0;
  MaterialId material = 0;
  Vector3d surface_velocity_m_s = Vector3d::Zero();

  /// Of both senses together, over the unobstructed direct path.
  [[nodiscard]] double power_db() const;
};

/// Finds how signals reach an antenna in a scene: the direct path, clear, through foliage, or bent
/// over an edge (single knife edge, ITU-R P.526), and first-order specular reflections on flat
/// surfaces (image method), on what stands and on actors. Panes and walls are opaque; there are no
/// diffuse, double or diffracted reflections, and no reflection off the car that bears the antenna
/// unless it is an actor of the scene.
///
/// Satellites are plane waves: at 20 000 km and a lateral offset ρ of a reflection's turning point
/// from the direct ray, that errs by ρ²/2R in the excess path: 0.6 mm at 150 m.
///
/// Nothing changes after construction: any thread may ask. The scene must outlive it.
class PathFinder {
 public:
  /// Reflections turn within this distance of the antenna.
  static constexpr double kReach_m = 150.0;

  PathFinder(const World& world, const RayScene& scene);

  /// Every path with a power of more than about −40 dB, a direct or diffracted one first. None
  /// where the antenna is cut off. `to_satellite` is a unit vector.
  [[nodiscard]] std::vector<SignalPath> find(const Vector3d& antenna_map,
                                             const Vector3d& to_satellite, Stamp time) const;
  /// The same for many satellites, looking around the antenna once.
  [[nodiscard]] std::vector<std::vector<SignalPath>> find(const Vector3d& antenna_map,
                                                          std::span<const Vector3d> to_satellites,
                                                          Stamp time) const;
  /// What may reflect, of what stands still.
  [[nodiscard]] const Reflectors& standing() const { return standing_; }

 private:
  static constexpr std::uint32_t kStands = ~std::uint32_t{0};
  struct Mirror {
    Reflector surface;
    /// kStands for what is no actor.
    std::uint32_t actor = kStands;
  };
  /// How a ray ends, leaves let through.
  struct Leg {
    std::optional<Hit> end;
    std::vector<double> leaves_m;
  };
  /// `max_range_m` counts from `origin`, as do the ranges returned.
  [[nodiscard]] Leg walk(const Vector3d& origin, const Vector3d& direction, double max_range_m,
                         Stamp time) const;
  [[nodiscard]] double foliage_m(const Vector3d& origin, const Vector3d& direction,
                                 double max_range_m, Stamp time) const;
  [[nodiscard]] std::vector<Mirror> mirrors(const Vector3d& antenna, Stamp time) const;
  [[nodiscard]] std::optional<SignalPath> direct(const Vector3d& antenna,
                                                 const Vector3d& to_satellite, Stamp time) const;
  [[nodiscard]] std::optional<SignalPath> reflect(const Mirror& mirror, const Vector3d& antenna,
                                                  const Vector3d& to_satellite, Stamp time) const;

  const RayScene& scene_;
  /// By material.
  std::vector<RadioMaterial> radio_;
  Reflectors standing_;
  /// By actor shape, in its frame.
  std::vector<Reflectors> shapes_;
};

}  // namespace locsim::sim
