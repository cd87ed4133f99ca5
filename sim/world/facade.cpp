#include "sim/world/facade.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/world/curtain_wall.h"
#include "sim/world/materials.h"

namespace locsim::sim {

namespace {

constexpr MaterialId kGlass = id(TownMaterial::glass);
constexpr MaterialId kFrame = id(TownMaterial::window_frame);
constexpr MaterialId kWood = id(TownMaterial::wood);
constexpr MaterialId kMetal = id(TownMaterial::metal_painted);

void add_panel(TriangleMesh& mesh, const WallFrame& wall, double u0, double v0, double u1,
               double v1, double w, MaterialId material) {
  if (u1 - u0 < 1e-6 || v1 - v0 < 1e-6) return;
  mesh.add_quad(wall.at(u0, v0, w), wall.at(u1, v0, w), wall.at(u1, v1, w), wall.at(u0, v1, w),
                material);
}

void add_recess(TriangleMesh& mesh, const WallFrame& wall, const Opening& o, MaterialId reveal) {
  const auto at = [&](double u, double v, double w) { return wall.at(u, v, w); };
  const double d = -o.depth_m;
  add_panel(mesh, wall, o.u0_m, o.v0_m, o.u1_m, o.v1_m, d, o.pane);
  mesh.add_quad(at(o.u0_m, o.v0_m, 0), at(o.u0_m, o.v0_m, d), at(o.u0_m, o.v1_m, d),
                at(o.u0_m, o.v1_m, 0), reveal);
  mesh.add_quad(at(o.u1_m, o.v0_m, d), at(o.u1_m, o.v0_m, 0), at(o.u1_m, o.v1_m, 0),
                at(o.u1_m, o.v1_m, d), reveal);
  mesh.add_quad(at(o.u0_m, o.v0_m, 0), at(o.u1_m, o.v0_m, 0), at(o.u1_m, o.v0_m, d),
                at(o.u0_m, o.v0_m, d), reveal);
  mesh.add_quad(at(o.u0_m, o.v1_m, d), at(o.u1_m, o.v1_m, d), at(o.u1_m, o.v1_m, 0),
                at(o.u0_m, o.v1_m, 0), reveal);
}

/// A column of windows, one above the other.
struct Bay {
  double middle_m = 0.0;
  double window_m = 1.0;
  bool has_balconies = false;
};

/// Columns of unequal widths that fill the facade: no two facades, and no two bays of one, repeat.
std::vector<Bay> draw_bays(double width_m, const FacadeStyle& style, RandomSequence& random) {
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(width_m / style.bay_m)));
  std::vector<double> widths_m(count);
  double sum = 0.0;
  for (double& w : widths_m) sum += w = random.uniform(0.72, 1.28);
  std::vector<Bay> bays;
  double u_m = 0.0;
  for (const double w : widths_m) {
    const double bay_m = w / sum * width_m;
    Bay bay;
    bay.window_m =
        std::clamp(bay_m * style.window_share * random.uniform(0.85, 1.15), 0.5, bay_m - 0.5);
    const double slack_m = bay_m - bay.window_m - 0.4;
    bay.middle_m = u_m + 0.5 * bay_m + 0.25 * slack_m * random.uniform(-1.0, 1.0);
    bay.has_balconies = random.chance(style.balcony_share);
    bays.push_back(bay);
    u_m += bay_m;
  }
  return bays;
}

void add_balcony(TriangleMesh& mesh, const WallFrame& wall, double middle_m, double width_m,
                 double v_m, const FacadeStyle& style, RandomSequence& random) {
  const double u0 = middle_m - 0.5 * width_m;
  const double u1 = middle_m + 0.5 * width_m;
  const double out_m = random.uniform(0.9, 1.3);
  constexpr double kBar_m = 0.035;
  add_block(mesh, wall, {u0, v_m - 0.18, 0.0}, {u1, v_m, out_m}, id(TownMaterial::concrete));
  if (random.chance(0.45)) {
    add_block(mesh, wall, {u0, v_m, out_m - 0.08}, {u1, v_m + 1.0, out_m}, style.trim);
    add_block(mesh, wall, {u0, v_m, 0.0}, {u0 + 0.08, v_m + 1.0, out_m - 0.08}, style.trim);
    add_block(mesh, wall, {u1 - 0.08, v_m, 0.0}, {u1, v_m + 1.0, out_m - 0.08}, style.trim);
    return;
  }
  for (const double rail_m : {0.2, 0.6, 1.0}) {
    const double v1 = v_m + rail_m + kBar_m;
    add_block(mesh, wall, {u0, v_m + rail_m, out_m - kBar_m}, {u1, v1, out_m}, kMetal);
    add_block(mesh, wall, {u0, v_m + rail_m, 0.0}, {u0 + kBar_m, v1, out_m - kBar_m}, kMetal);
    add_block(mesh, wall, {u1 - kBar_m, v_m + rail_m, 0.0}, {u1, v1, out_m - kBar_m}, kMetal);
  }
  for (const double u : {u0, u1 - kBar_m}) {
    add_block(mesh, wall, {u, v_m, out_m - kBar_m}, {u + kBar_m, v_m + 1.0, out_m}, kMetal);
  }
}

void add_window_parts(TriangleMesh& mesh, const WallFrame& wall, const Opening& o,
                      const FacadeStyle& style, RandomSequence& random) {
  const double middle = 0.5 * (o.u0_m + o.u1_m) + random.uniform(-0.1, 0.1);
  const double front = -o.depth_m + 0.05;
  add_block(mesh, wall, {middle - 0.04, o.v0_m, -o.depth_m}, {middle + 0.04, o.v1_m, front},
            kFrame);
  add_block(mesh, wall, {o.u0_m - 0.08, o.v0_m - 0.1, 0.0}, {o.u1_m + 0.08, o.v0_m, 0.12},
            style.trim);
  if (style.has_frames) {
    add_block(mesh, wall, {o.u0_m - 0.12, o.v1_m, 0.0}, {o.u1_m + 0.12, o.v1_m + 0.16, 0.09},
              style.trim);
  }
  if (random.chance(style.shutter_share)) {
    const double leaf_m = std::min(0.45, 0.5 * (o.u1_m - o.u0_m));
    for (const double u : {o.u0_m - leaf_m - 0.02, o.u1_m + 0.02}) {
      add_block(mesh, wall, {u, o.v0_m, 0.01}, {u + leaf_m, o.v1_m, 0.06}, kWood);
    }
  } else if (random.chance(0.25)) {
    // A roller blind let down part of the way.
    const double v = o.v1_m - random.uniform(0.2, 0.9) * (o.v1_m - o.v0_m);
    add_block(mesh, wall, {o.u0_m, v, -o.depth_m}, {o.u1_m, o.v1_m, -0.5 * o.depth_m}, kFrame);
  }
}

void add_upper_floors(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                      const Storeys& storeys, const FacadeStyle& style,
                      const std::vector<Bay>& bays, RandomSequence& random) {
  for (int floor = 0; floor < storeys.upper_floors; ++floor) {
    const double v0 = storeys.ground_floor_m + floor * storeys.floor_m;
    std::vector<Opening> openings;
    for (const Bay& bay : bays) {
      if (random.chance(style.blind_share)) continue;
      const double half_m = 0.5 * bay.window_m;
      Opening o{.u0_m = bay.middle_m - half_m, .u1_m = bay.middle_m + half_m, .pane = kGlass};
      o.v0_m = v0 + (bay.has_balconies ? 0.06 : style.sill_m);
      o.v1_m = std::min(v0 + style.sill_m + style.window_height_m, v0 + storeys.floor_m - 0.25);
      o.depth_m = style.recess_m;
      openings.push_back(o);
    }
    add_storey(mesh, wall, width_m, v0, v0 + storeys.floor_m, openings, style.wall);
    for (const Opening& o : openings) {
      if (o.v0_m < v0 + 0.1) {
        const double balcony_m = o.u1_m - o.u0_m + random.uniform(0.5, 0.9);
        add_balcony(mesh, wall, 0.5 * (o.u0_m + o.u1_m), std::min(balcony_m, 0.9 * style.bay_m), v0,
                    style, random);
      } else {
        add_window_parts(mesh, wall, o, style, random);
      }
    }
    if (style.has_string_courses && (floor == 0 || floor + 1 == storeys.upper_floors)) {
      add_block(mesh, wall, {0.0, v0 - 0.15, 0.0}, {width_m, v0 + 0.02, 0.14}, style.trim);
    }
  }
}

void add_shop_front(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                    const Storeys& storeys, const FacadeStyle& style, RandomSequence& random) {
  const double top_m = storeys.ground_floor_m - random.uniform(0.75, 1.0);
  std::vector<Opening> openings;
  double u = random.uniform(0.4, 0.8);
  bool door = random.chance(0.5);
  while (u < width_m - 2.0) {
    const double wide_m =
        std::min(door ? random.uniform(1.1, 1.6) : random.uniform(1.8, 4.2), width_m - u - 0.4);
    Opening o{.u0_m = u, .u1_m = u + wide_m, .v1_m = top_m, .pane = kGlass};
    o.v0_m = door ? 0.02 : random.uniform(0.3, 0.6);
    o.depth_m = door ? random.uniform(0.6, 1.1) : random.uniform(0.12, 0.25);
    openings.push_back(o);
    u += wide_m + random.uniform(0.25, 0.7);
    door = !door && random.chance(0.6);
  }
  add_storey(mesh, wall, width_m, 0.0, storeys.ground_floor_m, openings, style.wall);
  const double left_m = openings.front().u0_m - 0.2;
  const double right_m = openings.back().u1_m + 0.2;
  add_block(mesh, wall, {left_m, top_m + 0.1, 0.0},
            {right_m, top_m + 0.6, random.uniform(0.1, 0.25)},
            random.chance(0.5) ? kMetal : style.trim);
  for (const Opening& o : openings) {
    if (o.v0_m > 0.1 && random.chance(0.3)) {
      // An awning, let out stiffly.
      const double out_m = random.uniform(0.8, 1.2);
      const double v = top_m - 0.05;
      const auto at = [&](double side_m, double dv, double w) {
        return wall.at(side_m, v + dv, w);
      };
      const double a = o.u0_m - 0.1;
      const double b = o.u1_m + 0.1;
      mesh.add_quad(at(a, -0.35, out_m), at(b, -0.35, out_m), at(b, 0.1, 0), at(a, 0.1, 0), kWood);
      mesh.add_quad(at(a, 0.0, 0), at(b, 0.0, 0), at(b, -0.35, out_m), at(a, -0.35, out_m), kWood);
      mesh.add_quad(at(b, 0.0, 0), at(a, 0.0, 0), at(a, 0.1, 0), at(b, 0.1, 0), kWood);
      mesh.add_triangle(at(a, 0.0, 0), at(a, -0.35, out_m), at(a, 0.1, 0), kWood);
      mesh.add_triangle(at(b, 0.0, 0), at(b, 0.1, 0), at(b, -0.35, out_m), kWood);
    }
    if (o.v0_m > 0.1) {
      const double middle = random.uniform(o.u0_m + 0.3, o.u1_m - 0.3);
      add_block(mesh, wall, {middle - 0.03, o.v0_m, -o.depth_m},
                {middle + 0.03, o.v1_m, -o.depth_m + 0.06}, kMetal);
    }
  }
}

void add_ground_floor(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                      const Storeys& storeys, const FacadeStyle& style,
                      const std::vector<Bay>& bays, double room_m, RandomSequence& random) {
  const std::size_t door = random.pick(bays.size());
  const bool is_gateway = width_m > 14.0 && random.chance(0.3);
  std::vector<Opening> openings;
  for (std::size_t i = 0; i < bays.size(); ++i) {
    const double half_m = 0.5 * bays[i].window_m;
    Opening o{.u0_m = bays[i].middle_m - half_m, .u1_m = bays[i].middle_m + half_m, .pane = kGlass};
    o.v0_m = style.sill_m;
    o.v1_m = std::min(style.sill_m + style.window_height_m, storeys.ground_floor_m - 0.35);
    o.depth_m = style.recess_m;
    if (i == door) {
      const double wide_m = is_gateway ? 1.0 : 0.55;
      o.u0_m = std::max(bays[i].middle_m - wide_m, 0.1);
      o.u1_m = std::min(bays[i].middle_m + wide_m, width_m - 0.1);
      o.v0_m = 0.02;
      o.v1_m = is_gateway ? 2.9 : 2.2;
      o.depth_m = is_gateway ? 1.4 : random.uniform(0.25, 0.7);
      o.pane = kWood;
    }
    openings.push_back(o);
  }
  add_storey(mesh, wall, width_m, 0.0, storeys.ground_floor_m, openings, style.wall);
  for (std::size_t i = 0; i < openings.size(); ++i) {
    if (i != door) add_window_parts(mesh, wall, openings[i], style, random);
  }
  const Opening& o = openings[door];
  if (random.chance(0.6)) {
    add_block(mesh, wall, {o.u0_m - 0.3, o.v1_m + 0.1, 0.0},
              {o.u1_m + 0.3, o.v1_m + 0.25, random.uniform(0.4, 1.0)}, style.trim);
  }
  const double step_m = std::min(room_m, 0.7);
  if (step_m > 0.25 && storeys.street_m < -0.05) {
    add_block(mesh, wall, {o.u0_m - 0.2, storeys.foot_m, 0.0}, {o.u1_m + 0.2, 0.0, 0.5 * step_m},
              id(TownMaterial::concrete));
    add_block(mesh, wall, {o.u0_m - 0.2, storeys.foot_m, 0.5 * step_m},
              {o.u1_m + 0.2, 0.5 * storeys.street_m, step_m}, id(TownMaterial::concrete));
  }
}

}  // namespace

void add_storey(TriangleMesh& mesh, const WallFrame& wall, double width_m, double v0_m, double v1_m,
                const std::vector<Opening>& openings, MaterialId material) {
  double u = 0.0;
  for (const Opening& o : openings) {
    add_panel(mesh, wall, u, v0_m, o.u0_m, v1_m, 0.0, material);
    add_panel(mesh, wall, o.u0_m, v0_m, o.u1_m, o.v0_m, 0.0, material);
    add_panel(mesh, wall, o.u0_m, o.v1_m, o.u1_m, v1_m, 0.0, material);
    add_recess(mesh, wall, o, material);
    u = o.u1_m;
  }
  add_panel(mesh, wall, u, v0_m, width_m, v1_m, 0.0, material);
}

void add_block(TriangleMesh& mesh, const WallFrame& wall, const Vector3d& low, const Vector3d& high,
               MaterialId material) {
  Matrix3d axes;
  axes << wall.right, Vector3d::UnitZ(), wall.outward();
  const Vector3d middle = 0.5 * (low + high);
  add_box(mesh, {Eigen::Quaterniond(axes), wall.at(middle.x(), middle.y(), middle.z())},
          0.5 * (high - low), material);
}

FacadeStyle draw_facade_style(RandomSequence& random, double density) {
  using enum TownMaterial;
  constexpr std::array kWalls = {brick,        plaster_light, plaster_light,
                                 plaster_dark, concrete,      brick};
  FacadeStyle style;
  const TownMaterial wall = kWalls[random.pick(kWalls.size())];
  style.wall = id(wall);
  style.trim = id(wall == plaster_light ? concrete : plaster_light);
  style.window_share = random.uniform(0.36, 0.58);
  style.window_height_m = random.uniform(1.25, 1.95);
  style.sill_m = random.uniform(0.6, 1.0);
  style.recess_m = random.uniform(0.1, 0.25);
  style.bay_m = random.uniform(2.3, 3.9);
  style.has_shop = random.chance(0.55 * density);
  style.has_string_courses = random.chance(0.6);
  style.has_pilasters = random.chance(0.3);
  style.has_frames = random.chance(0.5);
  style.shutter_share = random.chance(0.25) ? random.uniform(0.5, 0.95) : 0.0;
  style.balcony_share = random.chance(0.5) ? random.uniform(0.15, 0.45) : 0.0;
  style.blind_share = random.uniform(0.0, 0.08);
  return style;
}

void add_street_facade(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                       const Storeys& storeys, const FacadeStyle& style, double room_m,
                       RandomSequence& random) {
  const std::vector<Bay> bays = draw_bays(width_m, style, random);
  add_panel(mesh, wall, 0.0, storeys.foot_m, width_m, 0.0, 0.0, style.wall);
  if (style.has_shop && width_m > 5.0) {
    add_shop_front(mesh, wall, width_m, storeys, style, random);
  } else {
    add_ground_floor(mesh, wall, width_m, storeys, style, bays, room_m, random);
  }
  if (style.is_curtain_wall) {
    add_curtain_wall(mesh, wall, width_m, storeys, style.spandrel);
    return;
  }
  add_upper_floors(mesh, wall, width_m, storeys, style, bays, random);
  const double top_m = storeys.top_m();
  if (style.has_pilasters) {
    double u = 0.0;
    for (std::size_t i = 0; i + 1 < bays.size(); ++i) {
      u = 0.5 * (bays[i].middle_m + 0.5 * bays[i].window_m + bays[i + 1].middle_m -
                 0.5 * bays[i + 1].window_m);
      if (i % 2 == 0) {
        add_block(mesh, wall, {u - 0.16, storeys.ground_floor_m, 0.0}, {u + 0.16, top_m - 0.3, 0.1},
                  style.trim);
      }
    }
  }
  const double cornice_m = random.uniform(0.15, 0.45);
  add_block(mesh, wall, {0.0, top_m - 0.35, 0.0}, {width_m, top_m - 0.15, 0.5 * cornice_m},
            style.trim);
  add_block(mesh, wall, {0.0, top_m - 0.15, 0.0}, {width_m, top_m, cornice_m}, style.trim);
  // A downpipe beside the party wall.
  add_block(mesh, wall, {0.12, storeys.foot_m, 0.02}, {0.22, top_m - 0.35, 0.12},
            id(TownMaterial::metal_galvanised));
}

void add_plain_facade(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                      const Storeys& storeys, const FacadeStyle& style, bool has_windows,
                      RandomSequence& random) {
  if (!has_windows) {
    add_panel(mesh, wall, 0.0, storeys.foot_m, width_m, storeys.top_m(), 0.0, style.wall);
    return;
  }
  if (style.is_curtain_wall) {
    add_panel(mesh, wall, 0.0, storeys.foot_m, width_m, storeys.ground_floor_m, 0.0, style.wall);
    add_curtain_wall(mesh, wall, width_m, storeys, style.spandrel);
    return;
  }
  FacadeStyle plain = style;
  plain.bay_m = random.uniform(3.0, 5.0);
  plain.blind_share = 0.25;
  plain.window_share = 0.75 * style.window_share;
  const std::vector<Bay> bays = draw_bays(width_m, plain, random);
  add_panel(mesh, wall, 0.0, storeys.foot_m, width_m, 0.0, 0.0, style.wall);
  for (int floor = -1; floor < storeys.upper_floors; ++floor) {
    const double v0 = floor < 0 ? 0.0 : storeys.ground_floor_m + floor * storeys.floor_m;
    const double v1 = storeys.ground_floor_m + (floor + 1) * storeys.floor_m;
    std::vector<Opening> openings;
    for (const Bay& bay : bays) {
      if (random.chance(plain.blind_share)) continue;
      const double half_m = 0.4 * bay.window_m;
      openings.push_back({bay.middle_m - half_m, bay.middle_m + half_m, v0 + style.sill_m,
                          std::min(v0 + style.sill_m + style.window_height_m, v1 - 0.3),
                          style.recess_m, kGlass});
    }
    add_storey(mesh, wall, width_m, v0, v1, openings, style.wall);
  }
}

}  // namespace locsim::sim
