#include "sim/world/roofs.h"

#include <algorithm>
#include <array>

#include "sim/world/materials.h"

namespace locsim::sim {

namespace {

constexpr MaterialId kTile = id(TownMaterial::roof_tile);

Vector3d point(const Footprint& footprint, double along_m, double across_m, double z_m) {
  const Vector2d p = footprint.at(along_m, across_m);
  return {p.x(), p.y(), z_m};
}

/// A closed upright box in the footprint's coordinates.
void add_upright_box(TriangleMesh& mesh, const Footprint& base, const Vector3d& low,
                     const Vector3d& high, MaterialId material) {
  const Vector3d middle = 0.5 * (low + high);
  add_box(mesh, upright(point(base, middle.x(), middle.y(), middle.z()), base.axis),
          0.5 * (high - low), material);
}

/// Two slopes that meet in a ridge along the footprint's axis, set off the middle by `ridge_v_m`
/// and ending `inset_m` short of the ends: 0 gives gables of `end_material`, more a hip.
struct Ridge {
  double z_m = 0.0;
  double v_m = 0.0;
  double inset_m = 0.0;
};
void add_ridged_solid(TriangleMesh& mesh, const Footprint& base, double z0_m, const Ridge& ridge,
                      MaterialId end_material) {
  const double x = base.half_extent_m.x();
  const double y = base.half_extent_m.y();
  const Vector3d a = point(base, -x, -y, z0_m);
  const Vector3d b = point(base, x, -y, z0_m);
  const Vector3d c = point(base, x, y, z0_m);
  const Vector3d d = point(base, -x, y, z0_m);
  const Vector3d low = point(base, -x + ridge.inset_m, ridge.v_m, ridge.z_m);
  const Vector3d high = point(base, x - ridge.inset_m, ridge.v_m, ridge.z_m);
  mesh.add_quad(a, b, high, low, kTile);
  mesh.add_quad(c, d, low, high, kTile);
  mesh.add_triangle(b, c, high, end_material);
  mesh.add_triangle(d, a, low, end_material);
  mesh.add_quad(d, c, b, a, kTile);
}

/// A solid between two rectangles, the upper smaller by `inset_m` on every side.
void add_tapered_solid(TriangleMesh& mesh, const Footprint& base, double z0_m, double z1_m,
                       double inset_m) {
  Footprint upper = base;
  upper.half_extent_m.array() -= inset_m;
  std::array<Vector3d, 4> low;
  std::array<Vector3d, 4> high;
  for (std::size_t i = 0; i < 4; ++i) {
    low[i] << base.corners()[i], z0_m;
    high[i] << upper.corners()[i], z1_m;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t k = (i + 1) % 4;
    mesh.add_quad(low[i], low[k], high[k], high[i], kTile);
  }
  mesh.add_quad(high[0], high[1], high[2], high[3], kTile);
  mesh.add_quad(low[3], low[2], low[1], low[0], kTile);
}

void add_chimneys(TriangleMesh& mesh, const RoofPlan& plan, double from_m, RandomSequence& random) {
  const Vector2d half = plan.footprint.half_extent_m;
  const std::size_t count = 1 + random.pick(3);
  for (std::size_t i = 0; i < count; ++i) {
    const double u = random.uniform(-0.85, 0.85) * half.x();
    const double v = random.uniform(-0.5, 0.6) * half.y();
    const double wide_m = random.uniform(0.25, 0.55);
    const double deep_m = random.uniform(0.22, 0.35);
    const double top_m = plan.ridge_m + random.uniform(0.1, 0.9);
    add_upright_box(mesh, plan.footprint, {u - wide_m, v - deep_m, from_m},
                    {u + wide_m, v + deep_m, top_m}, id(TownMaterial::brick));
    add_upright_box(mesh, plan.footprint, {u - wide_m - 0.06, v - deep_m - 0.06, top_m},
                    {u + wide_m + 0.06, v + deep_m + 0.06, top_m + 0.12},
                    id(TownMaterial::concrete));
  }
}

/// Dormers that stand on the street slope, which rises by `slope` per metre from `eaves_m`.
void add_dormers(TriangleMesh& mesh, const RoofPlan& plan, double slope, RandomSequence& random) {
  const Vector2d half = plan.footprint.half_extent_m;
  double u = -half.x() + random.uniform(1.2, 2.5);
  while (u < half.x() - 1.5) {
    const double wide_m = random.uniform(0.55, 0.95);
    const double set_back_m = random.uniform(0.5, 0.9);
    const double front = -half.y() + set_back_m;
    const double foot_m = plan.eaves_m + slope * set_back_m - 0.1;
    const double top_m = std::min(foot_m + random.uniform(1.3, 1.7), plan.ridge_m - 0.2);
    const double back = std::min(front + (top_m - foot_m) / slope + 0.1, half.y());
    if (top_m - foot_m > 0.8) {
      add_upright_box(mesh, plan.footprint, {u - wide_m, front, foot_m}, {u + wide_m, back, top_m},
                      plan.wall);
      add_upright_box(mesh, plan.footprint, {u - wide_m + 0.15, front - 0.03, foot_m + 0.25},
                      {u + wide_m - 0.15, front, top_m - 0.15}, id(TownMaterial::glass));
      Footprint cap = plan.footprint;
      cap.center = plan.footprint.at(u, 0.5 * (front + back) - 0.1);
      cap.axis = plan.footprint.across();
      cap.half_extent_m = {0.5 * (back - front) + 0.1, wide_m + 0.15};
      add_ridged_solid(mesh, cap, top_m, {.z_m = top_m + 0.45}, plan.wall);
    }
    u += random.uniform(2.6, 5.5);
  }
}

}  // namespace

void add_flat_roof(TriangleMesh& mesh, const RoofPlan& plan, RandomSequence& random) {
  const double x = plan.footprint.half_extent_m.x();
  const double y = plan.footprint.half_extent_m.y();
  constexpr double kThick_m = 0.25;
  const auto box = [&](const Vector3d& low, const Vector3d& high, TownMaterial material) {
    add_upright_box(mesh, plan.footprint, low, high, id(material));
  };
  const double z0 = plan.eaves_m;
  const double z1 = plan.ridge_m;
  const auto wall = static_cast<TownMaterial>(plan.wall);
  box({-x, -y, z0}, {x, -y + kThick_m, z1}, wall);
  box({-x, y - kThick_m, z0}, {x, y, z1}, wall);
  box({-x, -y + kThick_m, z0}, {-x + kThick_m, y - kThick_m, z1}, wall);
  box({x - kThick_m, -y + kThick_m, z0}, {x, y - kThick_m, z1}, wall);
  const double u = random.uniform(-0.5, 0.5) * x;
  const double v = random.uniform(0.0, 0.5) * y;
  box({u - 1.4, v - 1.2, z0}, {u + 1.4, v + 1.2, z0 + random.uniform(2.0, 2.8)},
      TownMaterial::concrete);
  const std::size_t machines = 1 + random.pick(4);
  for (std::size_t i = 0; i < machines; ++i) {
    const double mu = random.uniform(-0.8, 0.8) * x;
    const double mv = random.uniform(-0.7, 0.7) * y;
    const double half_m = random.uniform(0.25, 0.7);
    box({mu - half_m, mv - 0.4, z0}, {mu + half_m, mv + 0.4, z0 + random.uniform(0.5, 1.3)},
        TownMaterial::metal_galvanised);
  }
}

void add_pitched_roof(TriangleMesh& mesh, const RoofPlan& plan, RandomSequence& random) {
  const double overhang_m = random.uniform(0.2, 0.5);
  Footprint base = plan.footprint;
  const double z0 = plan.eaves_m;
  const double rise_m = plan.ridge_m - z0;
  const double kind = random.uniform();
  if (kind < 0.2) {
    // Gables to the street and the yard.
    base.axis = plan.footprint.across();
    base.half_extent_m = {plan.footprint.half_extent_m.y() + 0.1, plan.footprint.half_extent_m.x()};
    add_ridged_solid(mesh, base, z0, {.z_m = plan.ridge_m}, plan.wall);
    add_chimneys(mesh, plan, z0 + 0.1, random);
    return;
  }
  if (kind < 0.4 && rise_m > 3.0) {
    const double lower_m = 0.7 * rise_m;
    const double inset_m = 0.35 * lower_m;
    add_tapered_solid(mesh, base, z0, z0 + lower_m, inset_m);
    base.half_extent_m.array() -= inset_m;
    add_ridged_solid(mesh, base, z0 + lower_m,
                     {.z_m = plan.ridge_m, .inset_m = 0.5 * base.half_extent_m.x()}, kTile);
    add_dormers(mesh, plan, 1.0 / 0.35, random);
    add_chimneys(mesh, plan, z0 + 0.1, random);
    return;
  }
  base.half_extent_m.y() += overhang_m;
  const double ridge_v_m = random.uniform(-0.15, 0.15) * base.half_extent_m.y();
  const bool is_hipped = kind > 0.8;
  const double inset_m =
      is_hipped ? std::min(0.8 * base.half_extent_m.y(), 0.7 * base.half_extent_m.x()) : 0.0;
  add_ridged_solid(mesh, base, z0, {.z_m = plan.ridge_m, .v_m = ridge_v_m, .inset_m = inset_m},
                   is_hipped ? kTile : plan.wall);
  const double slope = rise_m / (ridge_v_m + base.half_extent_m.y());
  if (!is_hipped && random.chance(0.6)) {
    RoofPlan raised = plan;
    raised.eaves_m = z0 + slope * overhang_m;
    add_dormers(mesh, raised, slope, random);
  }
  add_chimneys(mesh, plan, z0 + 0.1, random);
}

}  // namespace locsim::sim
