#include "sim/world/vegetation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim/world/buildings.h"
#include "sim/world/materials.h"

namespace locsim::sim {

namespace {

constexpr MaterialId kBark = id(TownMaterial::bark);
constexpr MaterialId kFoliage = id(TownMaterial::foliage);

Vector3d random_direction(RandomSequence& random) {
  const double z = random.uniform(-1.0, 1.0);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// A triangle of random attitude with its corners about `size_m` from `middle`, none below
/// `lowest_m`.
void add_leaf(TriangleMesh& mesh, const Vector3d& middle, double size_m, double lowest_m,
              RandomSequence& random) {
  const Vector3d x = random_direction(random);
  const Vector3d y = x.unitOrthogonal();
  const auto corner = [&](double along, double across) {
    Vector3d p = middle + size_m * (along * x + across * y);
    p.z() = std::max(p.z(), lowest_m);
    return p;
  };
  mesh.add_triangle(corner(1.0, 0.0), corner(-0.5, 0.87), corner(-0.5, -0.87), kFoliage);
}

/// A limb from `from` to `to`.
void add_limb(TriangleMesh& mesh, const Vector3d& from, const Vector3d& to, double radius_m,
              int sides) {
  const Vector3d along = to - from;
  const Pose T_mesh_limb{Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), along), from};
  add_frustum(mesh, T_mesh_limb, radius_m, 0.45 * radius_m, along.norm(), sides, kBark);
}

/// What stands at the border of a plot.
enum class Front { hedge, wall, fence, open };

void add_fence(TriangleMesh& mesh, const Footprint& line, double foot_m, double height_m,
               MaterialId material, RandomSequence& random) {
  const Pose middle = upright({line.center.x(), line.center.y(), foot_m}, line.axis);
  const double half_m = line.half_extent_m.x();
  const auto box = [&](double u, double z, const Vector3d& half) {
    add_box(mesh, middle * Pose{Eigen::Quaterniond::Identity(), {u, 0.0, z}}, half, material);
  };
  for (const double share : {0.3, 0.85}) {
    box(0.0, share * height_m, {half_m, 0.02, 0.04});
  }
  double u = -half_m + 0.05;
  while (u < half_m) {
    box(u, 0.5 * height_m - 0.1, {0.04, 0.035, 0.5 * height_m + 0.1});
    u += random.uniform(0.3, 0.5);
  }
}

}  // namespace

void add_tree(TriangleMesh& mesh, const TreePlan& plan, RandomSequence& random) {
  const double trunk_m = 0.012 * plan.height_m + random.uniform(0.02, 0.07);
  const double fork_m = std::max(plan.clear_m - 0.6, 0.35 * plan.height_m);
  const double lean_m = 0.015 * plan.height_m;
  const Vector3d fork = plan.foot + Vector3d(lean_m * random.uniform(-1.0, 1.0),
                                             lean_m * random.uniform(-1.0, 1.0), fork_m);
  add_limb(mesh, plan.foot - Vector3d(0, 0, 0.3), fork, trunk_m, 8);
  const double crown_m = plan.height_m - plan.clear_m;
  const std::size_t tufts = 6 + random.pick(5);
  const double lowest_m = plan.foot.z() + plan.clear_m;
  std::vector<Vector3d> middles;
  for (std::size_t i = 0; i < tufts; ++i) {
    const double up = (static_cast<double>(i) + 0.6) / static_cast<double>(tufts);
    // Widest a little below the middle.
    const double radius_m =
        plan.crown_radius_m * 0.7 * std::sqrt(std::max(0.08, 1.0 - std::pow(1.7 * up - 0.7, 2)));
    const double angle = 2.4 * static_cast<double>(i) + random.uniform(-0.6, 0.6);
    const Vector3d middle =
        plan.foot + Vector3d(radius_m * std::cos(angle), radius_m * std::sin(angle),
                             plan.clear_m + up * crown_m * 0.92);
    middles.push_back(middle);
    add_limb(mesh, fork, middle, 0.4 * trunk_m, 4);
  }
  for (int i = 0; i < plan.leaves; ++i) {
    const Vector3d& middle = middles[random.pick(middles.size())];
    const double spread_m = 0.55 * plan.crown_radius_m * std::cbrt(random.uniform());
    const Vector3d p = middle + spread_m * random_direction(random);
    add_leaf(mesh, p, random.uniform(0.16, 0.33), lowest_m, random);
  }
}

void add_hedge(TriangleMesh& mesh, const Footprint& footprint, double foot_m, double height_m,
               RandomSequence& random) {
  const Vector2d half = footprint.half_extent_m;
  const Pose middle = upright({footprint.center.x(), footprint.center.y(), foot_m}, footprint.axis);
  const double up_m = 0.5 * height_m;
  add_box(mesh, middle * Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, up_m - 0.2}},
          {half.x() - 0.05, half.y() - 0.08, up_m + 0.1}, kFoliage);
  const int leaves = static_cast<int>(2.0 * half.x() * (height_m + half.y()) * 14.0);
  for (int i = 0; i < leaves; ++i) {
    const double u = random.uniform(-half.x(), half.x());
    const bool is_top = random.chance(0.3);
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    const double v = is_top ? random.uniform(-half.y(), half.y()) : side * (half.y() - 0.06);
    const double z = is_top ? height_m - 0.08 : random.uniform(0.1, height_m);
    add_leaf(mesh, middle * Vector3d(u, v, z), random.uniform(0.07, 0.15), foot_m - 1.0, random);
  }
}

void add_trees(TownSite& site, const Layout& layout, double spacing_m, std::uint64_t seed) {
  constexpr double kTrunk_m = 0.35;
  for (std::size_t i = 0; i < layout.streets.size(); ++i) {
    for (const auto side_name : {StreetSide::Side::left, StreetSide::Side::right}) {
      const StreetSide side(layout.streets[i], i, side_name);
      RandomSequence random(
          seed, "town/trees/" + std::to_string(2 * i + (side_name == StreetSide::Side::right)));
      // Along the kerb, in stretches with and without an avenue.
      for (double s = random.uniform(2.0, spacing_m); s < side.length_m() - 2.0;
           s += spacing_m * random.uniform(0.6, 1.4)) {
        const Vector2d place = side.at(s, side.kerb_m() + random.uniform(0.75, 0.95));
        const Footprint trunk = square_footprint(place, kTrunk_m);
        const bool is_avenue = town_density(place * 1.7, seed + 1) > 0.5;
        if (!is_avenue || side.street().pavement_width_m < 1.8) continue;
        if (!site.fits_beside_road(trunk, 0.2)) continue;
        TreePlan plan;
        plan.foot = site.on_ground(place);
        plan.height_m = random.uniform(6.5, 11.0);
        plan.crown_radius_m = random.uniform(1.4, 2.3);
        plan.leaves = 260 + static_cast<int>(random.pick(160));
        add_tree(site.world.structures, plan, random);
        site.taken.insert(trunk);
        site.add_collider(square_footprint(place, 0.2), plan.foot.z(), plan.foot.z() + 4.0);
      }
      // Behind the pavement, wherever there is room.
      for (double s = random.uniform(0.0, spacing_m); s < side.length_m();
           s += spacing_m * random.uniform(0.5, 1.3)) {
        const double behind_m = 1.5 + 22.0 * std::pow(random.uniform(), 1.5);
        const Vector2d place = side.at(s, side.frontage_m() + behind_m);
        const double crown_m = random.uniform(1.3, 2.8);
        const Footprint trunk = square_footprint(place, 0.6 * crown_m);
        if (!site.fits_off_pavement(trunk)) continue;
        TreePlan plan;
        plan.foot = site.on_ground(place);
        plan.height_m = random.uniform(4.0, 13.0);
        plan.crown_radius_m = crown_m;
        plan.clear_m = behind_m > 8.0 ? random.uniform(0.8, 2.0) : 4.2;
        if (plan.clear_m > 4.0) plan.height_m = std::max(plan.height_m, 6.5);
        plan.leaves = 180 + static_cast<int>(random.pick(160));
        add_tree(site.world.structures, plan, random);
        site.taken.insert(trunk);
        site.add_collider(square_footprint(place, 0.2), plan.foot.z(), plan.foot.z() + 4.0);
      }
    }
  }
}

void add_garden_fronts(TownSite& site, const Layout& layout, std::uint64_t seed) {
  for (std::size_t i = 0; i < layout.streets.size(); ++i) {
    for (const auto side_name : {StreetSide::Side::left, StreetSide::Side::right}) {
      const StreetSide side(layout.streets[i], i, side_name);
      RandomSequence random(
          seed, "town/fronts/" + std::to_string(2 * i + (side_name == StreetSide::Side::right)));
      double plot_end_m = 0.0;
      Front kind = Front::open;
      double height_m = 1.0;
      TownMaterial fence = TownMaterial::wood;
      double s = 0.5;
      while (s < side.length_m() - 1.0) {
        if (s >= plot_end_m) {
          plot_end_m = s + random.uniform(7.0, 22.0);
          const double draw = random.uniform();
          kind = draw < 0.35   ? Front::hedge
                 : draw < 0.58 ? Front::wall
                 : draw < 0.85 ? Front::fence
                               : Front::open;
          height_m = random.uniform(0.8, 1.9);
          fence = random.chance(0.5) ? TownMaterial::wood : TownMaterial::metal_painted;
          s += random.uniform(0.0, 1.4);  // the gate
        }
        const double panel_m = random.uniform(1.8, 2.6);
        const double thick_m = kind == Front::hedge ? 0.35 : 0.12;
        const double offset_m = side.frontage_m() + thick_m + 0.15;
        const Vector2d from = side.at(s, offset_m);
        const Vector2d to = side.at(s + panel_m, offset_m);
        s += panel_m;
        if (kind == Front::open) continue;
        Footprint panel{
            0.5 * (from + to), (to - from).normalized(), {0.5 * (to - from).norm(), thick_m}};
        // A garden is to lie behind it, not a wall.
        Footprint garden = panel;
        garden.half_extent_m.y() = 0.6;
        garden.center = side.at(s - 0.5 * panel_m, side.frontage_m() + 1.3 + thick_m);
        if (!site.fits_off_pavement(panel) || !site.taken.is_free(garden)) continue;
        const double low_m = std::min(site.height_m(from), site.height_m(to));
        TriangleMesh& mesh = site.world.structures;
        if (kind == Front::hedge) {
          add_hedge(mesh, panel, low_m, height_m, random);
        } else if (kind == Front::wall) {
          add_box(mesh,
                  upright({panel.center.x(), panel.center.y(), low_m + 0.5 * height_m - 0.2},
                          panel.axis),
                  {panel.half_extent_m.x(), 0.12, 0.5 * height_m + 0.2}, id(TownMaterial::brick));
        } else {
          add_fence(mesh, panel, low_m, height_m, id(fence), random);
        }
        site.taken.insert(panel);
        site.add_collider(panel, low_m, low_m + height_m);
      }
    }
  }
}

}  // namespace locsim::sim
