#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/pose.h"
#include "core/time.h"
#include "sim/gnss/fresnel.h"
#include "sim/ray_scene.h"

namespace locsim::sim {

/// Rays that are cast together.
struct RayBundle {
  static constexpr std::size_t kMost = 16;
  struct Ray {
    Vector3d origin = Vector3d::Zero();
    /// Unit.
    Vector3d direction = Vector3d::UnitZ();
    double max_range_m = 0.0;
  };
  std::array<Ray, kMost> rays;
  std::size_t size = 0;

  void add(const Vector3d& origin, const Vector3d& direction, double max_range_m) {
    rays[size++] = {origin, direction, max_range_m};
  }
};

/// How radio meets a scene at one instant: leaves are noted and let through. Valid as long as the
/// scene and the table of materials.
class RadioRays {
 public:
  static constexpr std::uint32_t kStands = ~std::uint32_t{0};
  /// How far to look towards a satellite: nothing of a world that is 10° up stands higher than this
  /// reaches.
  static constexpr double kSky_m = 1000.0;
  /// Off a surface before looking on from it: more than a float of the map frame.
  static constexpr double kOff_m = 0.01;

  /// `radio` by material. Actors further than `reach_m` from `center` are left out.
  RadioRays(const RayScene& scene, std::span<const RadioMaterial> radio, const Vector3d& center,
            double reach_m, Stamp time);

  /// Where a ray ends.
  struct End {
    static constexpr double kNowhere_m = std::numeric_limits<double>::infinity();
    /// kNowhere_m where it meets nothing but leaves.
    double range_m = kNowhere_m;
    MaterialId material = 0;
    /// Unit, on the ray's side.
    Vector3d normal = Vector3d::UnitZ();
    /// kStands for what is no actor.
    std::uint32_t actor = kStands;

    [[nodiscard]] bool is_met() const { return range_m < kNowhere_m; }
  };
  using Ends = std::array<End, RayBundle::kMost>;

  /// Ends of the first `bundle.size` rays. Adds the ranges of leaves met before them.
  [[nodiscard]] Ends cast(const RayBundle& bundle, std::vector<double>& leaves_m) const;
  /// What a ray leads through.
  struct Shade {
    /// It ends on something other than leaves.
    bool is_dark = false;
    /// Ranges of leaves on the way; mean nothing where it is dark.
    std::vector<double> leaves_m;
  };
  using Shades = std::array<Shade, RayBundle::kMost>;
  /// Whether the first `bundle.size` rays meet anything, and through which leaves the others go:
  /// less work than cast() where it does not matter what they meet.
  [[nodiscard]] Shades shades(const RayBundle& bundle) const;
  /// The same without actors.
  [[nodiscard]] Shades standing_shades(const RayBundle& bundle) const;
  [[nodiscard]] End cast(const Vector3d& origin, const Vector3d& direction,
                         double max_range_m) const;

  /// Depth of foliage that leaves at these ranges, of rays side by side, stand for. Sorts them.
  [[nodiscard]] static double depth_m(std::vector<double>& leaves_m);

 private:
  struct Body {
    std::uint32_t actor = 0;
    Pose T_actor_map;
    Vector3d center = Vector3d::Zero();
    double radius_m = 0.0;
  };
  struct Leaf {
    std::size_t ray = 0;
    double range_m = 0.0;
  };
  void cast_at_standing(const RayBundle& bundle, Ends& ends, std::vector<Leaf>& leaves) const;
  void cast_at_body(const Body& body, const RayBundle::Ray& ray, std::size_t number, End& end,
                    std::vector<Leaf>& leaves) const;

  const RayScene& scene_;
  std::span<const RadioMaterial> radio_;
  std::vector<Body> bodies_;
};

}  // namespace locsim::sim
