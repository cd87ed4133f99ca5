#include "sim/world/tunnel.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/random.h"
#include "sim/world/materials.h"
#include "sim/world/tunnel_fittings.h"

namespace locsim::sim {

namespace {

constexpr MaterialId kConcrete = id(TownMaterial::concrete);
constexpr MaterialId kEarth = id(TownMaterial::grass);

constexpr double kSection_m = 2.0;
constexpr double kWalkway_m = 1.0;
constexpr double kWall_m = 1.2;
constexpr double kRoof_m = 1.8;
constexpr double kShortest_m = 20.0;
/// What is left of a section's length at the inner side of a bend, at least.
constexpr double kLeastShrink = 0.2;
/// 100 kg of rebar in a cubic metre: walls of 1.2 m by 6.5 m, half a roof of 1 m by 6 m.
constexpr double kWallRebar_kg_m = 780.0;
constexpr double kRoofRebar_kg_m = 600.0;

class Tube {
 public:
  Tube(TownSite& site, const Layout& layout, const TunnelSpan& span, std::uint64_t seed)
      : site_(site),
        street_(street_of_route(site.ground, layout, span.from_m, span.to_m)),
        profile_(tunnel_profile(street_)),
        random_(seed, "town/tunnel") {
    const double length_m = span.to_m - span.from_m;
    const auto count = static_cast<std::size_t>(std::ceil(length_m / kSection_m));
    for (std::size_t i = 0; i <= count; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(count);
      rings_.push_back(ring(layout.route, span.from_m + share * length_m));
    }
    check(span);
  }

  void build() {
    const std::vector<WallFitting> left = plan_wall_fittings(rings_.size() - 1, true, random_);
    const std::vector<WallFitting> right = plan_wall_fittings(rings_.size() - 1, false, random_);
    for (std::size_t i = 0; i + 1 < rings_.size(); ++i) {
      add_shell(i, left[i], right[i]);
      add_rebar(i);
      add_colliders(i);
    }
    add_portal(rings_.front(), false);
    add_portal(rings_.back(), true);
    std::vector<CrossSection> sections;
    for (const Ring& ring : rings_) sections.push_back(ring.section);
    add_tunnel_fittings(mesh(), sections, profile_, street_.crown_m);
    for (std::size_t i = 0; i + 1 < rings_.size(); ++i) site_.taken.insert(ground_of(i));
  }

 private:
  /// The profile in its place.
  struct Ring {
    CrossSection section;
    double foot_m = 0.0;
    std::array<Vector3d, 6> inner;
    std::array<Vector3d, 6> outer;
  };

  TriangleMesh& mesh() { return site_.world.structures; }

  [[nodiscard]] Ring ring(const Route& route, double s_m) const {
    constexpr double kBelowGround_m = 0.8;
    Ring ring{.section = cross_section(route, s_m), .inner = {}, .outer = {}};
    const double road_m = ring.section.origin.z();
    double ground_m = road_m;
    for (const Vector2d& foot : {profile_.inner.front(), profile_.outer.front(),
                                 profile_.inner.back(), profile_.outer.back()}) {
      ground_m = std::min(ground_m, site_.height_m(ring.section.plan(foot.x())));
    }
    ring.foot_m = ground_m - road_m - kBelowGround_m;
    for (std::size_t k = 0; k < ring.inner.size(); ++k) {
      const bool is_foot = k == 0 || k + 1 == ring.inner.size();
      const auto placed = [&](const Vector2d& corner) {
        return ring.section.at(corner.x(), is_foot ? ring.foot_m : corner.y());
      };
      ring.inner[k] = placed(profile_.inner[k]);
      ring.outer[k] = placed(profile_.outer[k]);
    }
    return ring;
  }

  void check(const TunnelSpan& span) const {
    const auto fail = [&](const std::string& problem) {
      throw InputError("tunnel: from_m " + metres(span.from_m) + " to_m " + metres(span.to_m) +
                       ": " + problem);
    };
    const double section_m = (span.to_m - span.from_m) / static_cast<double>(rings_.size() - 1);
    for (std::size_t i = 0; i + 1 < rings_.size(); ++i) {
      const Vector2d ahead = rings_[i].section.ahead;
      for (const Vector2d& foot : {profile_.outer.front(), profile_.outer.back()}) {
        const Vector2d step =
            rings_[i + 1].section.plan(foot.x()) - rings_[i].section.plan(foot.x());
        if (step.dot(ahead) < kLeastShrink * section_m) {
          fail("the street bends too tightly for its walls, needs a straighter stretch");
        }
      }
    }
    for (const Ring& ring : rings_) {
      for (const auto* feet : {&profile_.inner, &profile_.outer}) {
        for (const Vector2d& foot : {feet->front(), feet->back()}) {
          if (site_.corridor.clearance_m(ring.section.plan(foot.x())) < kLaneClearance_m) {
            fail(
                "a wall would stand in the route's lane, needs a stretch that the route "
                "neither crosses nor leaves");
          }
        }
      }
    }
  }

  void add_shell(std::size_t i, const WallFitting& left, const WallFitting& right) {
    const Ring& a = rings_[i];
    const Ring& b = rings_[i + 1];
    const auto& in_a = a.inner;
    const auto& in_b = b.inner;
    // Seen from the lane, each wall's foot runs to the right.
    add_tunnel_wall(mesh(), {in_a[0], in_b[0], in_b[1], in_a[1]}, left);
    add_tunnel_wall(mesh(), {in_b[5], in_a[5], in_a[4], in_b[4]}, right);
    for (std::size_t k = 1; k < 4; ++k) {
      mesh().add_quad(in_a[k], in_b[k], in_b[k + 1], in_a[k + 1], kConcrete);
    }
    for (std::size_t k = 0; k < 5; ++k) {
      const bool is_wall = k == 0 || k == 4;
      mesh().add_quad(a.outer[k + 1], b.outer[k + 1], b.outer[k], a.outer[k],
                      is_wall ? kConcrete : kEarth);
    }
    mesh().add_quad(in_a[0], a.outer[0], b.outer[0], in_b[0], kConcrete);
    mesh().add_quad(a.outer[5], in_a[5], in_b[5], b.outer[5], kConcrete);
  }

  void add_rebar(std::size_t i) {
    if (i % 2 != 0) return;
    const CrossSection& section = rings_[i].section;
    const std::size_t end = std::min(i + 2, rings_.size() - 1);
    const double length_m = (rings_[end].section.origin - section.origin).norm();
    const CrossSection middle = rings_[std::min(i + 1, end)].section;
    const double left_m = profile_.inner.front().x();
    const double right_m = profile_.inner.back().x();
    const auto lump = [&](double at_m, double up_m, double kg_m) {
      site_.world.steel.push_back({middle.at(at_m, up_m), kg_m * length_m});
    };
    lump(left_m + 0.5 * kWall_m, 0.5 * kTunnelHeight_m, kWallRebar_kg_m);
    lump(right_m - 0.5 * kWall_m, 0.5 * kTunnelHeight_m, kWallRebar_kg_m);
    const double quarter_m = 0.25 * (left_m - right_m);
    lump(left_m - quarter_m, kTunnelHeight_m + 0.5, kRoofRebar_kg_m);
    lump(right_m + quarter_m, kTunnelHeight_m + 0.5, kRoofRebar_kg_m);
  }

  void add_colliders(std::size_t i) {
    for (const std::size_t k : {std::size_t{0}, std::size_t{5}}) {
      const Vector2d inner_a = rings_[i].inner[k].head<2>();
      const Vector2d inner_b = rings_[i + 1].inner[k].head<2>();
      const double side = k == 0 ? 1.0 : -1.0;
      Footprint wall;
      wall.axis = (inner_b - inner_a).normalized();
      wall.half_extent_m = {0.5 * (inner_b - inner_a).norm(), 0.5 * kWall_m};
      wall.center = 0.5 * (inner_a + inner_b) + side * 0.5 * kWall_m * wall.across();
      const double road_m = rings_[i].section.origin.z();
      site_.add_collider(wall, road_m + rings_[i].foot_m, road_m + kTunnelHeight_m);
    }
  }

  /// The face between the tube's inner and outer surface, and a wall about it that holds the earth
  /// back.
  void add_portal(const Ring& ring, bool is_exit) {
    for (std::size_t k = 0; k < 5; ++k) {
      std::array<Vector3d, 4> face = {ring.inner[k], ring.inner[k + 1], ring.outer[k + 1],
                                      ring.outer[k]};
      if (is_exit) std::swap(face[1], face[3]);
      mesh().add_quad(face[0], face[1], face[2], face[3], kConcrete);
    }
    constexpr double kBeside_m = 2.5;
    constexpr double kAbove_m = 1.0;
    constexpr double kHalfThick_m = 0.3;
    const double left_m = profile_.outer.front().x();
    const double right_m = profile_.outer.back().x();
    const double top_m = kTunnelHeight_m + kRoof_m + kAbove_m;
    const double inward_m = is_exit ? -kHalfThick_m : kHalfThick_m;
    const CrossSection& section = ring.section;
    const auto block = [&](double from_m, double to_m, double low_m, double high_m) {
      Vector3d middle = section.at(0.5 * (from_m + to_m), 0.5 * (low_m + high_m));
      middle.head<2>() += inward_m * section.ahead;
      add_box(mesh(), upright(middle, section.ahead),
              {kHalfThick_m, 0.5 * std::abs(to_m - from_m), 0.5 * (high_m - low_m)}, kConcrete);
    };
    const double foot_m = ring.foot_m - 0.5;
    block(left_m, left_m + kBeside_m, foot_m, top_m);
    block(right_m - kBeside_m, right_m, foot_m, top_m);
    block(right_m, left_m, kTunnelHeight_m + 0.02, top_m);
    add_portal_sign(mesh(), section, street_.crown_m, is_exit);
  }

  [[nodiscard]] Footprint ground_of(std::size_t i) const {
    constexpr double kBeside_m = 3.0;
    constexpr double kAlong_m = 1.0;
    const CrossSection& a = rings_[i].section;
    const CrossSection& b = rings_[i + 1].section;
    const double half_m = 0.5 * (profile_.outer.front().x() - profile_.outer.back().x());
    Footprint ground;
    const Vector2d from = a.plan(street_.crown_m);
    const Vector2d to = b.plan(street_.crown_m);
    ground.axis = (to - from).normalized();
    ground.center = 0.5 * (from + to);
    ground.half_extent_m = {0.5 * (to - from).norm() + kAlong_m, half_m + kBeside_m};
    return ground;
  }

  TownSite& site_;
  RouteStreet street_;
  TunnelProfile profile_;
  RandomSequence random_;
  std::vector<Ring> rings_;
};

}  // namespace

void TunnelSpan::describe(Parameters& p) {
  p.number("from_m", from_m, {.min = 0.0, .max = 1e6});
  p.number("to_m", to_m, {.min = 0.0, .max = 1e6});
  if (to_m < from_m) p.fail("to_m", "is less than from_m, needs from_m or more");
}

TunnelProfile tunnel_profile(const RouteStreet& street) {
  constexpr double kHaunchWidth_m = 0.9;
  constexpr double kHaunchHeight_m = 0.9;
  constexpr double kBevel_m = 1.2;
  const double left_m = street.crown_m + street.half_width_m + kWalkway_m;
  const double right_m = street.crown_m - street.half_width_m - kWalkway_m;
  const double wall_m = kTunnelHeight_m - kHaunchHeight_m;
  const double top_m = kTunnelHeight_m + kRoof_m;
  const auto profile = [](double left, double right, double side_m, double high_m, double in_m) {
    return std::array<Vector2d, 6>{Vector2d(left, 0.0),           Vector2d(left, side_m),
                                   Vector2d(left - in_m, high_m), Vector2d(right + in_m, high_m),
                                   Vector2d(right, side_m),       Vector2d(right, 0.0)};
  };
  return {profile(left_m, right_m, wall_m, kTunnelHeight_m, kHaunchWidth_m),
          profile(left_m + kWall_m, right_m - kWall_m, kTunnelHeight_m, top_m, kBevel_m)};
}

void add_tunnel(TownSite& site, const Layout& layout, const TunnelSpan& span, std::uint64_t seed) {
  if (!span.is_built()) return;
  if (span.to_m > layout.route.length_m()) {
    throw InputError("tunnel: to_m is " + metres(span.to_m) + ", the route is " +
                     metres(layout.route.length_m()) + " long");
  }
  if (span.to_m - span.from_m < kShortest_m) {
    throw InputError("tunnel: is " + metres(span.to_m - span.from_m) + " long, needs " +
                     metres(kShortest_m) + " or more");
  }
  Tube(site, layout, span, seed).build();
}

}  // namespace locsim::sim
