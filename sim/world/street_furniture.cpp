#include "sim/world/street_furniture.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/random.h"
#include "sim/world/materials.h"

namespace locsim::sim {

namespace {

constexpr MaterialId kGalvanised = id(TownMaterial::metal_galvanised);
constexpr MaterialId kPainted = id(TownMaterial::metal_painted);

/// Steel [kg]: a lamp post is 10 kg a metre, a sign's tube with its plate 5, a bollard's thick
/// tube 12; a shelter's posts, roof and frame; sheet and fittings of bins, boxes and benches.
constexpr double kLamp_kg = 80.0;
constexpr double kSign_kg = 18.0;
constexpr double kShelter_kg = 450.0;
constexpr double kBollard_kg = 13.0;
constexpr double kBin_kg = 25.0;
constexpr double kPowerBox_kg = 60.0;
constexpr double kBench_kg = 20.0;

/// Furnishes one side of one street.
class Furnisher {
 public:
  Furnisher(TownSite& site, const StreetSide& side, const std::string& name, std::uint64_t seed)
      : site_(site), side_(side), random_(seed, "town/furniture/" + name) {}

  /// Lamps stand on one side, and on both only in wide streets.
  void add_lamps(double spacing_m) {
    for (double s = random_.uniform(1.0, spacing_m); s < side_.length_m();
         s += spacing_m * random_.uniform(0.8, 1.2)) {
      const Vector2d place = side_.at(s, side_.kerb_m() + random_.uniform(0.5, 0.7));
      if (!take(square_footprint(place, 0.12), 7.0)) continue;
      const double height_m = random_.uniform(6.5, 8.5);
      const Pose pole = frame(place, -side_.outward(s));
      add_frustum(mesh(), pole * up(-0.3), 0.09, 0.05, height_m + 0.3, 7, kGalvanised);
      add_box(mesh(), pole * up(0.5), {0.11, 0.11, 0.5}, kGalvanised);
      const double arm_m = random_.uniform(0.7, 1.6);
      add_box(mesh(), pole * Pose{{1, 0, 0, 0}, {0.5 * arm_m, 0.0, height_m - 0.05}},
              {0.5 * arm_m, 0.03, 0.03}, kGalvanised);
      add_box(mesh(), pole * Pose{{1, 0, 0, 0}, {arm_m + 0.25, 0.0, height_m - 0.05}},
              {0.35, 0.12, 0.06}, kPainted);
      add_steel(place, 0.42 * height_m, kLamp_kg);
    }
  }

  void add_signs(double spacing_m) {
    for (double s = random_.uniform(2.0, spacing_m); s < side_.length_m();
         s += spacing_m * random_.uniform(0.5, 1.5)) {
      const Vector2d place = side_.at(s, side_.kerb_m() + random_.uniform(0.95, 1.2));
      if (!take({place, side_.traffic_direction(s), {0.08, kSignReach_m}}, 2.5)) continue;
      // x towards the traffic that is to read it.
      const Pose pole = frame(place, -side_.traffic_direction(s));
      const double top_m = random_.uniform(2.5, 3.2);
      add_frustum(mesh(), pole * up(-0.3), 0.035, 0.035, top_m + 0.3, 6, kGalvanised);
      add_plate(pole, top_m - 0.35);
      add_steel(place, 0.5 * top_m, kSign_kg);
      if (random_.chance(0.3)) {
        add_box(mesh(), pole * Pose{{1, 0, 0, 0}, {0.05, 0.0, top_m - 0.9}}, {0.012, 0.3, 0.13},
                id(TownMaterial::sign_retroreflective));
      }
    }
  }

  void add_bus_stops(double spacing_m) {
    for (double s = random_.uniform(0.2, 0.9) * spacing_m; s < side_.length_m();
         s += spacing_m * random_.uniform(0.7, 1.3)) {
      constexpr double kDepth_m = 0.65;
      const double half_m = random_.uniform(1.7, 2.4);
      const Vector2d place = side_.at(s, side_.frontage_m() - kDepth_m - 0.05);
      Footprint base{place, -side_.outward(s), {kDepth_m, half_m}};
      if (!take(base, 2.4)) continue;
      const Pose pose = frame(place, base.axis);
      const auto box = [&](const Vector3d& middle, const Vector3d& half, TownMaterial material) {
        add_box(mesh(), pose * Pose{{1, 0, 0, 0}, middle}, half, id(material));
      };
      box({0.0, 0.0, 2.4}, {kDepth_m, half_m, 0.06}, TownMaterial::metal_painted);
      for (const double y : {-half_m + 0.05, 0.0, half_m - 0.05}) {
        box({-kDepth_m + 0.05, y, 1.1}, {0.04, 0.04, 1.3}, TownMaterial::metal_painted);
      }
      box({-kDepth_m + 0.05, 0.0, 1.3}, {0.01, half_m - 0.1, 0.95}, TownMaterial::glass);
      box({0.0, half_m - 0.05, 1.25}, {kDepth_m - 0.1, 0.05, 1.0}, TownMaterial::window_frame);
      box({-kDepth_m + 0.35, -0.3, 0.45}, {0.2, 0.6 * half_m, 0.04}, TownMaterial::wood);
      for (const double y : {-0.8, 0.4}) {
        box({-kDepth_m + 0.35, y, 0.1}, {0.05, 0.05, 0.31}, TownMaterial::metal_painted);
      }
      for (const double y : {-0.5 * half_m, 0.5 * half_m}) {
        const Vector3d middle = pose * Vector3d(0.0, y, 1.6);
        site_.world.steel.push_back({middle, 0.5 * kShelter_kg});
      }
    }
  }

  void add_small_things(double spacing_m) {
    for (double s = random_.uniform(0.0, spacing_m); s < side_.length_m();
         s += spacing_m * random_.uniform(0.3, 1.7)) {
      const double draw = random_.uniform();
      if (draw < 0.35) {
        add_bollards(s);
      } else if (draw < 0.6) {
        const Vector2d place = side_.at(s, side_.kerb_m() + random_.uniform(0.7, 0.9));
        if (!take(square_footprint(place, 0.22), 1.0)) continue;
        add_frustum(mesh(), frame(place, Vector2d::UnitX()) * up(-0.1), 0.19, 0.22, 1.05, 9,
                    kPainted);
        add_steel(place, 0.5, kBin_kg);
      } else if (draw < 0.85) {
        add_power_box(s);
      } else {
        add_bench(s);
      }
    }
  }

 private:
  TriangleMesh& mesh() { return site_.world.structures; }
  static Pose up(double height_m) { return {Eigen::Quaterniond::Identity(), {0, 0, height_m}}; }
  [[nodiscard]] Pose frame(const Vector2d& place, const Vector2d& axis) const {
    return upright(site_.on_ground(place), axis);
  }

  /// From a sign's pole to the border of its plate, at most.
  static constexpr double kSignReach_m = 0.46;

  /// Takes the footprint where it is free, with a collider of `height_m`.
  bool take(const Footprint& base, double height_m) {
    if (!site_.fits_beside_road(base, 0.15)) return false;
    site_.taken.insert(base);
    const double foot_m = site_.height_m(base.center);
    site_.add_collider(base, foot_m - 0.2, foot_m + height_m);
    return true;
  }

  void add_steel(const Vector2d& place, double height_m, double mass_kg) {
    site_.world.steel.push_back({site_.on_ground(place) + Vector3d(0.0, 0.0, height_m), mass_kg});
  }

  /// A disc, triangle, octagon or oblong, retroreflective, its back of bare metal.
  void add_plate(const Pose& pole, double middle_m) {
    constexpr std::array kSides = {16, 3, 8, 4, 3, 16};
    const int sides = kSides[random_.pick(kSides.size())];
    const double radius_m = sides == 3 ? 0.45 : random_.uniform(0.3, 0.38);
    const auto at = [&](int i, double x) {
      const double turn = sides == 3 ? 0.0 : 0.5;
      const double angle = std::numbers::pi * (0.5 + 2.0 * (i + turn) / sides);
      return pole * Vector3d(x, radius_m * std::cos(angle), middle_m + radius_m * std::sin(angle));
    };
    const Vector3d front = pole * Vector3d(0.06, 0.0, middle_m);
    const Vector3d back = pole * Vector3d(0.04, 0.0, middle_m);
    for (int i = 0; i < sides; ++i) {
      mesh().add_triangle(front, at(i, 0.06), at(i + 1, 0.06),
                          id(TownMaterial::sign_retroreflective));
      mesh().add_triangle(back, at(i + 1, 0.04), at(i, 0.04), kGalvanised);
      mesh().add_quad(at(i, 0.04), at(i + 1, 0.04), at(i + 1, 0.06), at(i, 0.06), kGalvanised);
    }
  }

  void add_bollards(double s) {
    const std::size_t count = 3 + random_.pick(4);
    const double step_m = random_.uniform(1.3, 1.9);
    for (std::size_t i = 0; i < count; ++i, s += step_m) {
      if (s > side_.length_m()) return;
      const Vector2d place = side_.at(s, side_.kerb_m() + 0.55);
      if (!take(square_footprint(place, 0.08), 0.9)) continue;
      add_frustum(mesh(), frame(place, Vector2d::UnitX()) * up(-0.2), 0.075, 0.065, 1.1, 7,
                  kPainted);
      add_steel(place, 0.35, kBollard_kg);
    }
  }

  void add_power_box(double s) {
    const double half_m = random_.uniform(0.35, 0.7);
    const Vector2d place = side_.at(s, side_.frontage_m() - 0.25);
    const Footprint base{place, -side_.outward(s), {0.19, half_m}};
    if (!take(base, 1.3)) return;
    const double height_m = random_.uniform(0.9, 1.4);
    add_box(mesh(), frame(place, base.axis) * up(0.5 * height_m - 0.1),
            {0.17, half_m - 0.03, 0.5 * height_m + 0.1}, id(TownMaterial::concrete));
    add_box(mesh(), frame(place, base.axis) * up(height_m + 0.03), {0.19, half_m, 0.03},
            kGalvanised);
    add_steel(place, 0.5 * height_m, kPowerBox_kg);
  }

  void add_bench(double s) {
    const Vector2d place = side_.at(s, side_.frontage_m() - 0.4);
    const Footprint base{place, -side_.outward(s), {0.3, 0.85}};
    if (!take(base, 0.9)) return;
    const Pose pose = frame(place, base.axis);
    const auto box = [&](const Vector3d& middle, const Vector3d& half, MaterialId material) {
      add_box(mesh(), pose * Pose{{1, 0, 0, 0}, middle}, half, material);
    };
    box({0.05, 0.0, 0.45}, {0.22, 0.85, 0.03}, id(TownMaterial::wood));
    box({-0.2, 0.0, 0.75}, {0.03, 0.85, 0.14}, id(TownMaterial::wood));
    for (const double y : {-0.7, 0.7}) {
      box({0.0, y, 0.15}, {0.2, 0.04, 0.27}, kPainted);
      box({-0.24, y, 0.5}, {0.02, 0.04, 0.38}, kPainted);
    }
    add_steel(place, 0.4, kBench_kg);
  }

  TownSite& site_;
  const StreetSide& side_;
  RandomSequence random_;
};

}  // namespace

void add_street_furniture(TownSite& site, const Layout& layout, const FurniturePlan& plan,
                          std::uint64_t seed) {
  for (std::size_t i = 0; i < layout.streets.size(); ++i) {
    for (const auto name : {StreetSide::Side::left, StreetSide::Side::right}) {
      const StreetSide side(layout.streets[i], i, name);
      const bool is_right = name == StreetSide::Side::right;
      Furnisher furnisher(site, side, std::to_string(i) + (is_right ? "/right" : "/left"), seed);
      furnisher.add_bus_stops(plan.bus_stop_spacing_m);
      furnisher.add_lamps(is_right ? plan.lamp_spacing_m : 1.6 * plan.lamp_spacing_m);
      furnisher.add_signs(plan.sign_spacing_m);
      furnisher.add_small_things(plan.small_spacing_m);
    }
  }
}

}  // namespace locsim::sim
