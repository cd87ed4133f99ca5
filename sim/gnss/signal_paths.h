#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/pose.h"
#include "core/time.h"
#include "sim/gnss/fresnel.h"
#include "sim/gnss/mirrors.h"
#include "sim/gnss/radio_rays.h"
#include "sim/gnss/reflectors.h"
#include "sim/gnss/signal_path.h"
#include "sim/ray_scene.h"
#include "sim/world/world.h"

namespace locsim::sim {

/// Finds how signals reach an antenna in a scene: the direct path, clear, through foliage, or bent
/// over an edge (single knife edge, ITU-R P.526), first-order specular reflections on flat surfaces
/// (image method), on what stands and on actors, two or three reflections from wall to wall
/// (Bounces), and what rough walls scatter (Scatterers). Panes and walls are opaque; there are no
/// diffracted reflections, and none off the car that bears the antenna unless it is an actor of
/// the scene.
///
/// A reflection comes from the whole of its first Fresnel zone, metres across: sixteen points of
/// it, spread so that an edge across it weakens as a knife edge does, are tried by rays to the
/// antenna and to the satellite. What they meet within 0.35 m of the plane (panes behind a wall,
/// mullions before it) adds its Fresnel coefficient with the phase of its own depth. A facade is
/// one reflection, which comes and goes over metres, not between its windows.
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

  /// Every path with a power of more than about −40 dB, scattered ones of −45 dB: a direct or
  /// diffracted one first, then reflected, then scattered ones. None where the antenna is cut off.
  /// `to_satellite` is a unit vector.
  [[nodiscard]] std::vector<SignalPath> find(const Vector3d& antenna_map,
                                             const Vector3d& to_satellite, Stamp time) const;
  /// The same for many satellites, looking around the antenna once.
  [[nodiscard]] std::vector<std::vector<SignalPath>> find(const Vector3d& antenna_map,
                                                          std::span<const Vector3d> to_satellites,
                                                          Stamp time) const;
  /// What may reflect, of what stands still.
  [[nodiscard]] const Reflectors& standing() const { return standing_; }

 private:
  /// A plane that has been looked at for a satellite, and what bears it.
  struct Plane {
    Vector3d normal = Vector3d::UnitZ();
    Vector3d point = Vector3d::Zero();
    std::uint32_t bearer = 0;

    [[nodiscard]] bool has(const Mirror& mirror, const Vector3d& turn) const;
  };
  [[nodiscard]] Mirrors mirrors(std::vector<const Reflector*> standing, const Vector3d& antenna,
                                Stamp time) const;
  /// Those of one satellite.
  [[nodiscard]] std::vector<SignalPath> reflections(const RadioRays& rays, const Mirrors& mirrors,
                                                    const Vector3d& antenna,
                                                    const Vector3d& to_satellite, Stamp time) const;
  [[nodiscard]] std::optional<SignalPath> reflect(const RadioRays& rays, const Plane& plane,
                                                  MaterialId material, const Vector3d& antenna,
                                                  const Vector3d& to_satellite) const;

  const RayScene& scene_;
  /// By material.
  std::vector<RadioMaterial> radio_;
  Reflectors standing_;
  /// By actor shape, in its frame.
  std::vector<Reflectors> shapes_;
};

}  // namespace locsim::sim
