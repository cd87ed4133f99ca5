#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/pose.h"
#include "core/time.h"
#include "sim/actors.h"
#include "sim/world/world.h"

namespace locsim::sim {

/// What a ray met.
enum class Surface : std::uint8_t { ground, structures, parked_cars, interiors, actor };

struct Hit {
  double range_m = 0.0;
  MaterialId material = 0;
  /// Unit normal on the ray's side of the surface, map frame.
  Vector3d normal = Vector3d::UnitZ();
  Surface surface = Surface::ground;
  /// Index of the actor where `surface` says so.
  std::uint32_t actor = 0;
};

/// A world and its moving actors, ready for rays. Nothing changes after construction: any thread
/// may ask anything at any time, and answers depend neither on threads nor on earlier questions.
///
/// What stands still is one Embree scene in the map frame. A moving actor is met in its own frame,
/// where it stands still too: rays are taken there by its exact pose at their time, so motion is
/// neither cut into pieces nor bound to a window of time.
///
/// Origins become floats in the map frame: within ±4 km of the world's origin a ray starts within
/// 0.13 mm of where it should, on each axis.
class RayScene {
 public:
  /// Copies what it needs. Throws InputError for an actor's shape or a triangle's material that
  /// the world does not have, std::runtime_error where Embree fails (out of memory).
  RayScene(const World& world, std::span<const Actor> actors);

  /// First surface along `direction` (unit vector) within `max_range_m`, everything where it is
  /// at `time`; map frame.
  [[nodiscard]] std::optional<Hit> cast(const Vector3d& origin, const Vector3d& direction,
                                        Stamp time, double max_range_m) const;
  struct ActorHit {
    float range_m = 0.0F;
    MaterialId material = 0;
    /// Unit, map frame, either way up.
    Vector3f normal = Vector3f::UnitZ();
  };
  /// First surface of one actor between `min_range_m` and `max_range_m`.
  [[nodiscard]] std::optional<ActorHit> cast_at_actor(std::uint32_t actor, const Vector3d& origin,
                                                      const Vector3d& direction, Stamp time,
                                                      double min_range_m, double max_range_m) const;
  /// Whether anything, standing or moving, lies within `max_range_m` along `direction` (unit).
  [[nodiscard]] bool is_blocked(const Vector3d& origin, const Vector3d& direction,
                                double max_range_m, Stamp time) const;

  /// Every actor that may come within `reach_m` of `center` during [from, to], and few others.
  [[nodiscard]] std::vector<std::uint32_t> actors_near(const Vector3d& center, double reach_m,
                                                       Stamp from, Stamp to) const;
  [[nodiscard]] std::span<const Actor> actors() const { return actors_; }
  /// A sphere that holds the actor's shape, in the actor's frame.
  struct Sphere {
    Vector3d center = Vector3d::Zero();
    double radius_m = 0.0;
  };
  [[nodiscard]] const Sphere& bounds(std::uint32_t actor) const {
    return shapes_[actors_[actor].shape].bounds;
  }

  /// For packets: the scene of what stands still (map frame), and that of one actor's shape
  /// (actor frame). geomID and primID of a hit go to the functions below.
  [[nodiscard]] RTCScene standing_scene() const { return standing_.get(); }
  [[nodiscard]] RTCScene actor_scene(std::uint32_t actor) const {
    return shapes_[actors_[actor].shape].scene.get();
  }
  [[nodiscard]] MaterialId standing_material(unsigned geometry, unsigned primitive) const {
    return standing_materials_[geometry][primitive];
  }
  [[nodiscard]] MaterialId actor_material(std::uint32_t actor, unsigned primitive) const {
    return shapes_[actors_[actor].shape].materials[primitive];
  }
  /// The world's table, that material ids go into.
  [[nodiscard]] std::span<const Material> materials() const { return materials_; }

 private:
  struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  using DevicePtr = std::unique_ptr<RTCDeviceTy, ReleaseDevice>;
  using ScenePtr = std::unique_ptr<RTCSceneTy, ReleaseScene>;
  struct Shape {
    ScenePtr scene;
    std::vector<MaterialId> materials;
    Sphere bounds;
  };

  [[nodiscard]] ScenePtr build(std::span<const TriangleMesh* const> meshes) const;

  DevicePtr device_;
  ScenePtr standing_;
  std::vector<std::vector<MaterialId>> standing_materials_;
  std::vector<Material> materials_;
  std::vector<Shape> shapes_;
  std::vector<Actor> actors_;
};

}  // namespace locsim::sim
