#include "sim/world/buildings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "sim/world/facade.h"
#include "sim/world/materials.h"
#include "sim/world/roofs.h"

namespace locsim::sim {

namespace {

Storeys draw_storeys(const BuildingPlan& plan, double wall_m, RandomSequence& random) {
  Storeys storeys;
  storeys.foot_m = plan.foot_m - plan.floor_m;
  storeys.street_m = plan.street_m - plan.floor_m;
  storeys.ground_floor_m = random.uniform(3.0, 4.3);
  const double wanted_m = random.uniform(2.75, 3.5);
  const double upper_m = wall_m - storeys.ground_floor_m;
  storeys.upper_floors = std::max(1, static_cast<int>(std::lround(upper_m / wanted_m)));
  storeys.floor_m = upper_m / storeys.upper_floors;
  return storeys;
}

/// A bay window over some upper floors: a closed solid of its own before the wall.
void add_bay_window(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                    const Storeys& storeys, const FacadeStyle& style, RandomSequence& random) {
  const double wide_m = random.uniform(2.2, 3.2);
  const double out_m = random.uniform(0.6, 1.0);
  const double u0 = random.uniform(0.8, width_m - wide_m - 0.8);
  const int floors = storeys.upper_floors - static_cast<int>(random.pick(2));
  const double v0 = storeys.ground_floor_m;
  const double v1 = v0 + floors * storeys.floor_m - 0.2;
  const auto at = [&](double u, double v, double w) { return wall.at(u0 + u, v, w); };
  const WallFrame front{at(0, 0, out_m), wall.right};
  for (int floor = 0; floor < floors; ++floor) {
    const double low = v0 + floor * storeys.floor_m;
    const double high = floor + 1 == floors ? v1 : low + storeys.floor_m;
    const double top = std::min(low + style.sill_m + style.window_height_m, high - 0.25);
    const double middle = wide_m * random.uniform(0.46, 0.54);
    const MaterialId glass = id(TownMaterial::glass);
    add_storey(mesh, front, wide_m, low, high,
               {{0.25, middle - 0.1, low + style.sill_m, top, 0.1, glass},
                {middle + 0.1, wide_m - 0.25, low + style.sill_m, top, 0.1, glass}},
               style.wall);
  }
  mesh.add_quad(at(wide_m, v0, out_m), at(wide_m, v0, 0), at(wide_m, v1, 0), at(wide_m, v1, out_m),
                style.wall);
  mesh.add_quad(at(0, v0, 0), at(0, v0, out_m), at(0, v1, out_m), at(0, v1, 0), style.wall);
  mesh.add_quad(at(0, v1, out_m), at(wide_m, v1, out_m), at(wide_m, v1, 0), at(0, v1, 0),
                style.trim);
  mesh.add_quad(at(0, v0, 0), at(wide_m, v0, 0), at(wide_m, v0, out_m), at(0, v0, out_m),
                style.trim);
  mesh.add_quad(at(wide_m, v0, 0), at(0, v0, 0), at(0, v1, 0), at(wide_m, v1, 0), style.wall);
}

/// Single sheets. They end before the panes, those of the ground floor behind the deepest door.
void add_interior(TriangleMesh& mesh, const WallFrame& street, double width_m, double depth_m,
                  const Storeys& storeys) {
  constexpr double kOffPane_m = 0.3;
  constexpr double kOffDoor_m = 1.45;
  constexpr double kInWall_m = 0.05;
  constexpr double kRoom_m = 4.5;
  const double back_m = depth_m - kInWall_m;
  const auto floor = [&](double v, TownMaterial material) {
    mesh.add_quad(
        street.at(kInWall_m, v, -kInWall_m), street.at(width_m - kInWall_m, v, -kInWall_m),
        street.at(width_m - kInWall_m, v, -back_m), street.at(kInWall_m, v, -back_m), id(material));
  };
  floor(0.0, TownMaterial::concrete);
  for (int i = 0; i < storeys.upper_floors; ++i) {
    floor(storeys.ground_floor_m + i * storeys.floor_m, TownMaterial::wood);
  }
  const double room_m = std::clamp(0.42 * depth_m, 3.0, 5.0);
  mesh.add_quad(street.at(kInWall_m, 0.0, -room_m), street.at(width_m - kInWall_m, 0.0, -room_m),
                street.at(width_m - kInWall_m, storeys.top_m(), -room_m),
                street.at(kInWall_m, storeys.top_m(), -room_m), id(TownMaterial::plaster_light));
  const int rooms = std::max(1, static_cast<int>(std::lround(width_m / kRoom_m)));
  for (int i = 1; i < rooms; ++i) {
    const double u = width_m * i / rooms;
    const auto partition = [&](double v0, double v1, double from_m) {
      mesh.add_quad(street.at(u, v0, -from_m), street.at(u, v0, -back_m + kOffPane_m),
                    street.at(u, v1, -back_m + kOffPane_m), street.at(u, v1, -from_m),
                    id(TownMaterial::plaster_light));
    };
    partition(0.0, storeys.ground_floor_m, kOffDoor_m);
    partition(storeys.ground_floor_m, storeys.top_m(), kOffPane_m);
  }
}

/// Buildings of one side of one street, one after another.
class Row {
 public:
  Row(TownSite& site, const StreetSide& side, const BuildingRows& rows, std::uint64_t seed)
      : site_(site),
        side_(side),
        rows_(rows),
        seed_(seed),
        random_(seed, "town/buildings/" + std::to_string(side.index()) +
                          (side.side() == StreetSide::Side::left ? "/left" : "/right")) {}

  void build() {
    if (side_.side() == StreetSide::Side::left && !side_.street().carries_route) {
      close_end(false);
      close_end(true);
    }
    double s = random_.uniform(0.5, 4.0);
    bool is_after_gap = true;
    while (s < side_.length_m() - 6.0) {
      const double density = density_at(side_.at(s, side_.frontage_m()));
      // Mean building of 15 m, mean gap of 8 m: this chance of a gap leaves the share asked for.
      const double leaning = std::clamp(1.6 - 1.2 * density, 0.4, 1.6);
      const double share = std::min(rows_.gap_share, 0.95);
      const bool is_gap_next = random_.chance(leaning * share / (1.0 - share) * 15.0 / 8.0);
      const std::optional<double> end = place(s, density, is_after_gap, is_gap_next);
      if (!end) {
        s += 0.75;
        is_after_gap = true;
        continue;
      }
      s = *end + 0.06;
      is_after_gap = is_gap_next;
      if (is_gap_next) s += random_.uniform(3.0, 13.0) / (1.0 - 0.9 * share);
    }
  }

 private:
  [[nodiscard]] double density_at(const Vector2d& place) const {
    return std::max(town_density(place, seed_), rows_.density_min);
  }

  /// Tries narrower and further back until one fits. Returns where it ends along the street.
  std::optional<double> place(double s, double density, bool is_after_gap, bool is_gap_next) {
    const double wide_m = 8.0 + 17.0 * std::pow(random_.uniform(), 1.5);
    const double deep_m = random_.uniform(8.5, 13.5);
    if (s - block_from_m_ > block_length_m_) {
      block_from_m_ = s;
      block_length_m_ = random_.uniform(40.0, 110.0);
      block_setback_m_ = density > 0.42 ? random_.uniform(0.4, 1.6) : random_.uniform(2.5, 6.0);
      block_rise_ = random_.uniform();
    }
    const double jitter_m = random_.chance(0.15) ? random_.uniform(0.8, 2.2) : 0.0;
    const double setback_m = block_setback_m_ + random_.uniform(0.0, 0.35) + jitter_m;
    for (const double shrink : {1.0, 0.7, 0.5}) {
      const double width_m = std::max(wide_m * shrink, 8.0);
      for (const double extra_m : {0.0, 1.2, 2.8}) {
        BuildingPlan plan;
        const double end = front(plan.footprint, s, width_m, setback_m + extra_m, deep_m * shrink);
        if (end > side_.length_m() + 3.0 || !site_.fits_off_pavement(plan.footprint)) continue;
        plan.room_m = setback_m - 0.1;
        plan.density = density;
        const bool is_left = side_.side() == StreetSide::Side::left;
        plan.is_free_low = is_left ? is_after_gap : is_gap_next;
        plan.is_free_high = is_left ? is_gap_next : is_after_gap;
        finish(plan);
        return end;
      }
      if (width_m <= 8.0) break;
    }
    return std::nullopt;
  }

  /// A building across the end of a street that stops, so that the view along it ends in a wall.
  void close_end(bool is_far_end) {
    const double s = is_far_end ? side_.length_m() : 0.0;
    BuildingPlan plan;
    const Vector2d tangent = side_.at(s, 0.0) - side_.at(s > 0.0 ? s - 2.0 : 2.0, 0.0);
    const Vector2d ahead = tangent.normalized();
    const double deep_m = random_.uniform(9.0, 12.0);
    const double wide_m = random_.uniform(14.0, 22.0);
    plan.footprint.axis = {ahead.y(), -ahead.x()};
    plan.footprint.half_extent_m = {0.5 * wide_m, 0.5 * deep_m};
    plan.room_m = random_.uniform(0.5, 3.0);
    plan.footprint.center =
        side_.at(s, 0.0) + (side_.frontage_m() + plan.room_m + 0.5 * deep_m) * ahead;
    plan.is_free_low = plan.is_free_high = true;
    plan.density = density_at(plan.footprint.center);
    if (site_.fits_off_pavement(plan.footprint)) finish(plan);
  }

  /// The rectangle whose street wall is the chord from s on. Returns where the chord ends.
  double front(Footprint& footprint, double s, double width_m, double setback_m,
               double deep_m) const {
    const double offset_m = side_.frontage_m() + setback_m;
    const Vector2d from = side_.at(s, offset_m);
    // In a bend, what lies off the crown is longer or shorter than the crown.
    double end = s + width_m;
    for (int i = 0; i < 3; ++i) {
      end += width_m - (side_.at(end, offset_m) - from).norm();
      end = std::clamp(end, s + 0.4 * width_m, s + 2.0 * width_m);
    }
    const Vector2d to = side_.at(end, offset_m);
    const bool is_left = side_.side() == StreetSide::Side::left;
    footprint.axis = (is_left ? to - from : from - to).normalized();
    footprint.half_extent_m = {0.5 * (to - from).norm(), 0.5 * deep_m};
    footprint.center = 0.5 * (from + to) + 0.5 * deep_m * footprint.across();
    return end;
  }

  void finish(BuildingPlan& plan) {
    const Vector2d half = plan.footprint.half_extent_m;
    double lowest_m = std::numeric_limits<double>::max();
    double highest_front_m = std::numeric_limits<double>::lowest();
    for (const double u : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      for (const double v : {-1.0, 0.0, 1.0}) {
        const double z = site_.height_m(plan.footprint.at(u * half.x(), v * half.y()));
        lowest_m = std::min(lowest_m, z);
        if (v < 0.0) highest_front_m = std::max(highest_front_m, z);
      }
    }
    plan.street_m = site_.height_m(plan.footprint.at(0.0, -half.y()));
    plan.floor_m = highest_front_m + random_.uniform(0.05, 0.4);
    plan.foot_m = std::min(lowest_m, plan.street_m) - 0.6;
    const double share =
        std::clamp(0.15 + 0.5 * plan.density * block_rise_ +
                       0.35 * plan.density * random_.uniform() + random_.uniform(-0.15, 0.15),
                   0.0, 1.0);
    const bool is_low = rows_.low_share > 0.0 && random_.chance(rows_.low_share);
    const double least_m = is_low ? rows_.low_height_min_m : rows_.height_min_m;
    const double most_m = is_low ? rows_.low_height_max_m : rows_.height_max_m;
    plan.height_m = least_m + share * (most_m - least_m);
    plan.curtain_wall_share = rows_.curtain_wall_share;
    add_building(site_.world.structures, site_.world.interiors, plan, random_);
    site_.taken.insert(plan.footprint);
    site_.add_collider(plan.footprint, plan.foot_m, plan.floor_m + plan.height_m);
  }

  TownSite& site_;
  const StreetSide& side_;
  const BuildingRows& rows_;
  std::uint64_t seed_;
  RandomSequence random_;
  double block_from_m_ = -1e9;
  double block_length_m_ = 0.0;
  double block_setback_m_ = 0.0;
  double block_rise_ = 0.0;
};

}  // namespace

void add_building(TriangleMesh& mesh, TriangleMesh& interiors, const BuildingPlan& plan,
                  RandomSequence& random) {
  const Footprint& base = plan.footprint;
  constexpr double kTower_m = 40.0;
  const bool is_flat = random.chance(0.25 + 0.25 * plan.density) || plan.height_m >= kTower_m;
  const double roof_m = is_flat
                            ? random.uniform(0.4, 1.1)
                            : std::min(random.uniform(0.35, 0.75) * base.half_extent_m.y() * 1.6,
                                       0.45 * plan.height_m);
  FacadeStyle style = draw_facade_style(random, plan.density);
  if (plan.curtain_wall_share > 0.0 && random.chance(plan.curtain_wall_share)) {
    style.is_curtain_wall = true;
    style.spandrel = id(random.chance(0.5) ? TownMaterial::metal_painted : TownMaterial::concrete);
  }
  const Storeys storeys = draw_storeys(plan, plan.height_m - roof_m, random);
  const auto corners = base.corners();
  const auto wall = [&](std::size_t from, const Vector2d& right) {
    return WallFrame{{corners[from].x(), corners[from].y(), plan.floor_m},
                     {right.x(), right.y(), 0.0}};
  };
  const double width_m = 2.0 * base.half_extent_m.x();
  const double depth_m = 2.0 * base.half_extent_m.y();
  const WallFrame street = wall(0, base.axis);
  add_street_facade(mesh, street, width_m, storeys, style, plan.room_m, random);
  if (width_m > 7.0 && storeys.upper_floors > 1 && random.chance(0.22) && !style.is_curtain_wall) {
    add_bay_window(mesh, street, width_m, storeys, style, random);
  }
  add_plain_facade(mesh, wall(1, base.across()), depth_m, storeys, style, plan.is_free_high,
                   random);
  add_plain_facade(mesh, wall(2, -base.axis), width_m, storeys, style, true, random);
  add_plain_facade(mesh, wall(3, -base.across()), depth_m, storeys, style, plan.is_free_low,
                   random);
  add_interior(interiors, street, width_m, depth_m, storeys);
  const double eaves_m = plan.floor_m + storeys.top_m();
  std::array<Vector3d, 4> top;
  std::array<Vector3d, 4> foot;
  for (std::size_t i = 0; i < 4; ++i) {
    top[i] << corners[i], eaves_m;
    foot[i] << corners[i], plan.foot_m;
  }
  mesh.add_quad(top[0], top[1], top[2], top[3], id(TownMaterial::concrete));
  mesh.add_quad(foot[3], foot[2], foot[1], foot[0], id(TownMaterial::concrete));
  const RoofPlan roof{base, eaves_m, plan.floor_m + plan.height_m, style.wall};
  if (is_flat) {
    add_flat_roof(mesh, roof, random);
  } else {
    add_pitched_roof(mesh, roof, random);
  }
}

void add_building_rows(TownSite& site, const Layout& layout, const BuildingRows& rows,
                       std::uint64_t seed) {
  for (std::size_t i = 0; i < layout.streets.size(); ++i) {
    for (const auto side : {StreetSide::Side::left, StreetSide::Side::right}) {
      const StreetSide street_side(layout.streets[i], i, side);
      Row(site, street_side, rows, seed).build();
    }
  }
}

double town_density(const Vector2d& place, std::uint64_t seed) {
  const RandomStream stream(seed, "town/density");
  double sum = 0.0;
  for (std::uint64_t wave = 0; wave < 3; ++wave) {
    const double course = stream.uniform(0.0, 2.0 * std::numbers::pi, 0, wave);
    const double phase = stream.uniform(0.0, 2.0 * std::numbers::pi, 1, wave);
    const double length_m = stream.uniform(180.0, 520.0, 2, wave);
    const double along_m = place.x() * std::cos(course) + place.y() * std::sin(course);
    sum += std::sin(2.0 * std::numbers::pi * along_m / length_m + phase);
  }
  return std::clamp(0.6 + 0.22 * sum, 0.0, 1.0);
}

}  // namespace locsim::sim
