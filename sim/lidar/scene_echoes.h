#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/pose.h"
#include "core/time.h"
#include "sim/lidar/firing_block.h"
#include "sim/lidar/return_model.h"
#include "sim/ray_scene.h"

namespace locsim::sim {

/// What the rays of `kLanes` successive firing cycles have in common.
struct FiringBlock {
  std::size_t first_cycle = 0;
  std::size_t cycles = 0;
  /// Starts of the cycles and the end of the last, and where the sensor is then.
  std::array<Stamp, kLanes + 1> times;
  std::array<Pose, kLanes + 1> T_map_lidar;
  std::array<HeadTurn, kLanes> heads;
  /// Cycles within which the car is set down elsewhere: their rays start between the two places.
  std::array<bool, kLanes> is_torn{};

  [[nodiscard]] std::span<const HeadTurn> head_turns() const { return {heads.data(), cycles}; }
};

/// What a packet of rays met first.
struct SurfaceEchoes {
  /// Infinite where nothing was met.
  Lanes range_m;
  /// As the reflectivity of a diffuse target met squarely.
  Lanes strength;
};

/// What a ray met beyond a pane or in its mirror.
struct FurtherEcho {
  /// Along the path of the light.
  float range_m = 0.0F;
  float strength = 0.0F;
  /// The same ray's next one, as an index; −1 for none.
  std::int32_t next = -1;
};

class SceneEchoes {
 public:
  /// A packet for each ray of a firing cycle.
  std::vector<SurfaceEchoes> surfaces;

  /// Forgets what was met, for so many packets.
  void reset(std::size_t packets);
  void add_further(std::uint32_t packet, int lane, float range_m, float strength);
  /// Calls `take(range_m, strength)` for each of a ray's further echoes.
  template <typename Take>
  void for_further(std::size_t packet, int lane, Take&& take) const {
    for (std::int32_t i = first_of(packet, lane); i >= 0;) {
      const FurtherEcho& echo = further_[static_cast<std::size_t>(i)];
      take(echo.range_m, echo.strength);
      i = echo.next;
    }
  }
  [[nodiscard]] bool has_further(std::size_t packet, int lane) const {
    return first_of(packet, lane) >= 0;
  }
  [[nodiscard]] bool has_further() const { return !further_.empty(); }
  /// Weakens everything that the rays of a packet met.
  void weaken(std::size_t packet, const Lanes& gain);

 private:
  [[nodiscard]] std::int32_t first_of(std::size_t packet, int lane) const {
    return first_[packet * kLanes + static_cast<std::size_t>(lane)];
  }

  std::vector<FurtherEcho> further_;
  std::vector<std::int32_t> first_;
};

/// Casts the rays of firing blocks at a scene: what stands still in the map frame, each actor in
/// its own, by its exact pose; panes let light through and mirror it.
class SceneCaster {
 public:
  /// The angles by which a ray may lie off its beam's elevation and off the head's azimuth, for
  /// telling early which actors it cannot meet.
  struct Spread {
    double azimuth_rad = 0.0;
    double elevation_rad = 0.0;
  };

  /// Nothing is looked for beyond `range_m`, nor, on the way on from a pane, where a white diffuse
  /// target would send back less than `least_power` (see return_model.h).
  SceneCaster(const RayScene& scene, std::span<const BeamRay> rays, std::span<const Optics> optics,
              const Spread& spread, float range_m, float least_power)
      : scene_(scene),
        rays_(rays),
        optics_(optics),
        spread_(spread),
        range_m_(range_m),
        least_power_(least_power) {}

  /// Writes what the block's rays meet to `echoes`. `near_actors`: none but these may be met.
  void cast(const FiringBlock& block, std::span<const std::uint32_t> near_actors,
            SceneEchoes& echoes) const;

 private:
  /// A pane that a ray met first, and the normal there in the map frame, either way up.
  struct PaneHit {
    std::uint32_t ray;
    int lane;
    float range_m;
    Vector3f normal;
    float refractive_index;
  };
  /// Light on its way on from a pane, map frame.
  struct Segment {
    std::uint32_t ray;
    int lane;
    Vector3f origin;
    Vector3f direction;
    /// Of the way before `origin`, and the share of the power that comes back along it.
    float path_m;
    float gain;
    /// As far as it is worth following.
    float reach_m;
    int panes_passed;
  };
  /// Kept apart, so that what is cast together stays together.
  struct Light {
    std::vector<Segment> through;
    std::vector<Segment> mirrored;

    void clear() {
      through.clear();
      mirrored.clear();
    }
  };
  /// Where an actor is during a block.
  struct ActorPlace {
    std::uint32_t actor;
    Vector3f center;
    float radius_m;
  };
  struct Met {
    float range_m;
    Optics optics;
    float cos_incidence;
    Vector3f normal;
  };

  void meet_standing(const FiringBlock& block, const BlockMotion& motion, SceneEchoes& echoes,
                     std::vector<PaneHit>& panes) const;
  void meet_actor(std::uint32_t actor, const FiringBlock& block, SceneEchoes& echoes,
                  std::vector<PaneHit>& panes) const;
  void follow(const FiringBlock& block, const BlockMotion& motion,
              std::span<const std::uint32_t> near_actors, const std::vector<PaneHit>& panes,
              SceneEchoes& echoes) const;
  void send_on(const PaneHit& pane, const Vector3f& point, const Vector3f& direction, float path_m,
               float gain, int panes_passed, Light& light, float& own_strength) const;
  void follow_all(const FiringBlock& block, std::span<const ActorPlace> actors,
                  std::span<const Segment> segments, Light& onward, SceneEchoes& echoes) const;
  [[nodiscard]] std::vector<ActorPlace> places_of(const FiringBlock& block,
                                                  std::span<const std::uint32_t> near_actors) const;
  void meet(const FiringBlock& block, std::span<const ActorPlace> actors,
            std::span<const Segment> segments, std::span<Met> met) const;
  void meet_actors(const FiringBlock& block, std::span<const ActorPlace> actors,
                   const Segment& segment, Met& met) const;

  const RayScene& scene_;
  std::span<const BeamRay> rays_;
  std::span<const Optics> optics_;
  Spread spread_;
  float range_m_;
  float least_power_;
};

}  // namespace locsim::sim
