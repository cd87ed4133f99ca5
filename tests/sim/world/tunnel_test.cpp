#include "sim/world/tunnel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/random.h"
#include "sim/ray_scene.h"
#include "sim/world/ground_mesh.h"
#include "sim/world/materials.h"
#include "sim/world/town.h"
#include "sim/world/town_layout.h"
#include "tests/sim/world/street_towns.h"

namespace locsim::sim {
namespace {

/// Ground and tunnel, nothing else.
World bare_tunnel(const Layout& layout, const TunnelSpan& span) {
  World world;
  world.materials = town_materials();
  TownSite site(layout, world);
  world.ground = build_ground_mesh(layout, site.ground);
  add_tunnel(site, layout, span, 5);
  return world;
}

/// Left and right bends of 40 m radius, up and down by 5 %.
Layout winding_street() {
  std::vector<Vector3d> centre = {Vector3d::Zero()};
  double yaw_rad = 0.3;
  for (int i = 0; i < 200; ++i) {
    const double s_m = 2.0 * i;
    yaw_rad += 2.0 / 40.0 * std::sin(s_m / 30.0);
    centre.push_back(centre.back() + 2.0 * Vector3d(std::cos(yaw_rad), std::sin(yaw_rad),
                                                    0.05 * std::cos(s_m / 25.0)));
  }
  return layout_along(centre);
}

/// A wall across the whole street at each portal, as parked cars.
void close_portals(World& world, const Layout& layout, const TunnelSpan& span) {
  for (const double s_m : {span.from_m, span.to_m}) {
    const CrossSection section = cross_section(layout.route, s_m);
    world.parked_cars.add_quad(section.at(-20.0, -5.0), section.at(20.0, -5.0),
                               section.at(20.0, 20.0), section.at(-20.0, 20.0), 0);
  }
}

struct Ray {
  Vector3d origin, direction;
};
std::vector<Ray> rays_within(const Layout& layout, const TunnelSpan& span, int count) {
  RandomSequence random(1, "tunnel_test");
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const CrossSection section =
        cross_section(layout.route, random.uniform(span.from_m + 0.5, span.to_m - 0.5));
    const Vector3d origin = section.at(random.uniform(-1.5, 4.5), random.uniform(0.3, 4.0));
    const Vector3d direction(random.gaussian(), random.gaussian(), random.gaussian());
    rays.push_back({origin, direction.normalized()});
  }
  return rays;
}

void expect_watertight(const Layout& layout, const TunnelSpan& span) {
  World world = bare_tunnel(layout, span);
  close_portals(world, layout, span);
  const RayScene scene(world, {});
  int at_portals = 0;
  int leaks = 0;
  for (const Ray& ray : rays_within(layout, span, 60'000)) {
    const auto hit = scene.cast(ray.origin, ray.direction, Stamp{}, 2000.0);
    if (!hit) {
      ++leaks;
      continue;
    }
    if (hit->surface == Surface::parked_cars) ++at_portals;
    const Vector3d p = ray.origin + hit->range_m * ray.direction;
    const RouteProjection place = layout.route.project(p);
    // Half a street of 3.5 m, 1 m of walkway, niches of 0.85 m; the lane is 1.75 m off the crown.
    // In bends, chords of 2 m cut 5 mm off, and the crown is 0.2 m off the median in hairpins.
    EXPECT_LT(std::abs(place.lateral_m - 1.75), 3.5 + 1.0 + 0.85 + 0.3);
    // Slopes of 5 % take 0.1 m between the ends of a section.
    EXPECT_LT(p.z() - layout.route.at(place.s_m).position.z(), kTunnelHeight_m + 0.2);
  }
  EXPECT_EQ(leaks, 0);
  EXPECT_GT(at_portals, 30);
}

TEST(Tunnel, NoRayLeavesButThroughThePortals) {
  expect_watertight(straight_street(200.0, 0.05), {40.0, 150.0});
  expect_watertight(winding_street(), {60.0, 330.0});
}

TEST(Tunnel, NoRayLeavesThroughATownsTurns) {
  TownLayoutConfig config;
  config.length_m = 400.0;
  config.turn_share = 1.0;
  const Layout layout = make_town_layout(config, 2);
  expect_watertight(layout, {80.0, 380.0});
}

TEST(Tunnel, OpenPortalsLetRaysOut) {
  const Layout layout = straight_street(200.0, 0.0);
  const World world = bare_tunnel(layout, {60.0, 140.0});
  const RayScene scene(world, {});
  const Vector3d origin = cross_section(layout.route, 100.0).at(0.0, 1.5);
  for (const double side : {-1.0, 1.0}) {
    EXPECT_FALSE(scene.cast(origin, Vector3d(side, 0.0, 0.02).normalized(), Stamp{}, 1000.0));
  }
}

TEST(Tunnel, IsASolidOfItsWallsVolume) {
  const Layout layout = straight_street(300.0, 0.0);
  const double length_m = 200.0;
  const World world = bare_tunnel(layout, {50.0, 50.0 + length_m});
  double volume_m3 = 0.0;
  Vector3d closure_m2 = Vector3d::Zero();
  double area_m2 = 0.0;
  for (std::size_t t = 0; t < world.structures.triangles.size(); ++t) {
    const Vector3d normal = world.structures.area_normal(t);
    volume_m3 += (world.structures.corner(t, 0) - Vector3d(150.0, 0.0, 0.0)).dot(normal) / 6.0;
    closure_m2 += 0.5 * normal;
    area_m2 += 0.5 * normal.norm();
  }
  // Corners are floats within 300 m: each face is off by 1e-5 of its area at most.
  EXPECT_LT(closure_m2.norm(), 1e-5 * area_m2);
  // Walls and roof as in `tunnel_profile`, feet 0.8 m below the ground, which lies within 0.2 m of
  // the road there: outside 11.4 m by 7 m less bevels of 1.2 m by 1.8 m, inside 9 m by 5.2 m less
  // haunches of 0.9 m. Portals, niches and fittings are within a tenth of it.
  const double foot_m = 0.8;
  const double section_m2 =
      (11.4 * (7.0 + foot_m) - 1.2 * 1.8) - (9.0 * (5.2 + foot_m) - 0.9 * 0.9);
  EXPECT_NEAR(volume_m3 / (section_m2 * length_m), 1.0, 0.1);
}

TEST(Tunnel, LeavesTheCarriagewayFree) {
  const Layout layout = straight_street(300.0, 0.03);
  const World world = bare_tunnel(layout, {50.0, 250.0});
  std::size_t low = 0;
  for (const Vector3f& v : world.structures.vertices) {
    const double up_m = v.z() - 0.03 * v.x();
    if (up_m < -0.05 || up_m > 4.0) continue;
    ++low;
    // The cable tray hangs over the walkway.
    EXPECT_GT(std::abs(v.y()), 3.5 + 0.6);
  }
  EXPECT_GT(low, 50U);
}

TEST(Tunnel, HasRebarEveryFewMetres) {
  const Layout layout = straight_street(300.0, 0.0);
  const World world = bare_tunnel(layout, {50.0, 250.0});
  std::vector<double> places_m;
  double mass_kg = 0.0;
  for (const SteelBody& body : world.steel) {
    places_m.push_back(body.position.x());
    mass_kg += body.mass_kg;
    EXPECT_TRUE(std::abs(body.position.y()) > 4.5 || body.position.z() > kTunnelHeight_m);
  }
  std::ranges::sort(places_m);
  ASSERT_GT(places_m.size(), 100U);
  for (std::size_t i = 1; i < places_m.size(); ++i) EXPECT_LT(places_m[i] - places_m[i - 1], 4.5);
  // 100 kg in each of (1.2 m × 6.5 m × 2 + 1 m × 12 m) × 200 m.
  EXPECT_NEAR(mass_kg, 100.0 * (1.2 * 6.5 * 2.0 + 12.0) * 200.0, 0.02 * mass_kg);
}

TEST(Tunnel, NothingOfTheTownStandsInIt) {
  const Layout layout = straight_street(300.0, 0.02);
  const TunnelSpan span{60.0, 240.0};
  TownConfig config;
  config.tunnel = span;
  World town = build_town(config, layout, 5, {});
  World bare = bare_tunnel(layout, span);
  close_portals(town, layout, span);
  close_portals(bare, layout, span);
  const RayScene in_town(town, {});
  const RayScene in_bare(bare, {});
  for (const Ray& ray : rays_within(layout, span, 20'000)) {
    const auto a = in_town.cast(ray.origin, ray.direction, Stamp{}, 2000.0);
    const auto b = in_bare.cast(ray.origin, ray.direction, Stamp{}, 2000.0);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
      EXPECT_NEAR(a->range_m, b->range_m, 1e-4);
    }
  }
  // Houses keep off it, and stand elsewhere.
  std::size_t houses = 0;
  for (const Collider& box : town.colliders) {
    const double top_m = box.T_map_box.translation.z() + box.half_extent_m.z();
    const Vector3d middle = box.T_map_box.translation;
    if (top_m - 0.02 * middle.x() < 8.5) continue;
    ++houses;
    EXPECT_FALSE(middle.x() > span.from_m && middle.x() < span.to_m &&
                 std::abs(middle.y()) - box.half_extent_m.y() < 5.7);
  }
  EXPECT_GT(houses, 5U);
}

TEST(Tunnel, RefusesWhereItCannotStand) {
  World world;
  const auto refuses = [&](const Layout& layout, const TunnelSpan& span) {
    TownSite site(layout, world);
    EXPECT_THROW(add_tunnel(site, layout, span, 1), InputError);
  };
  const Layout straight = straight_street(200.0, 0.0);
  refuses(straight, {100.0, 400.0});
  refuses(straight, {100.0, 110.0});
  // A bend of 6 m radius: the inner wall would run backwards.
  std::vector<Vector3d> hairpin;
  for (double x = -60.0; x < 0.0; x += 2.0) hairpin.emplace_back(x, -6.0, 0.0);
  for (int i = 0; i < 20; ++i) {
    const double angle = -0.5 * std::numbers::pi + std::numbers::pi * i / 20.0;
    hairpin.emplace_back(6.0 * std::cos(angle), 6.0 * std::sin(angle), 0.0);
  }
  for (double x = 0.0; x > -60.0; x -= 2.0) hairpin.emplace_back(x, 6.0, 0.0);
  refuses(layout_along(hairpin), {40.0, 100.0});
  // A loop of 60 m radius that crosses its own start.
  std::vector<Vector3d> loop;
  for (double x = -100.0; x < 0.0; x += 2.0) loop.emplace_back(x, 0.0, 0.0);
  for (int i = 0; i < 180; ++i) {
    const double angle = -0.5 * std::numbers::pi + 2.0 * i / 60.0;
    loop.emplace_back(60.0 * std::cos(angle), 60.0 + 60.0 * std::sin(angle), 0.0);
  }
  refuses(layout_along(loop), {30.0, 99.0});
  TownSite site(straight, world);
  EXPECT_NO_THROW(add_tunnel(site, straight, {}, 1));
  EXPECT_TRUE(world.structures.empty());
}

}  // namespace
}  // namespace locsim::sim
