#include "sim/world/bridges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "core/error.h"
#include "sim/world/materials.h"
#include "sim/world/route_street.h"

namespace locsim::sim {

namespace {

constexpr MaterialId kConcrete = id(TownMaterial::concrete);
constexpr MaterialId kSteel = id(TownMaterial::metal_painted);
constexpr MaterialId kRail = id(TownMaterial::metal_galvanised);

constexpr double kHalfWidth_m = 0.5 * kOverpassWidth_m;
constexpr double kGirderDepth_m = 0.9;
constexpr double kSlab_m = 0.3;
constexpr double kCap_m = 0.8;
constexpr double kPierRadius_m = 0.45;
constexpr std::array kGirders_m = {-4.0, -2.0, 0.0, 2.0, 4.0};
constexpr std::array kPiers_m = {-3.6, 0.0, 3.6};
/// Web of 0.9 m × 14 mm and two flanges of 0.4 m × 28 mm, at 7850 kg/m³.
constexpr double kGirder_kg_m = 275.0;
constexpr double kLump_m = 6.0;
constexpr double kAbutmentHalf_m = 1.5;

/// Its own axes: x along the deck, to the left of the route; y along its width, against the
/// route's course; z up. The origin is on the crown at the height of the girders' lower edges.
class Overpass {
 public:
  Overpass(TownSite& site, const Layout& layout, double s_m)
      : site_(site),
        street_(street_of_route(site.ground, layout, std::max(0.0, s_m - 10.0), s_m + 10.0)) {
    const CrossSection section = cross_section(layout.route, s_m);
    axis_ = section.left();
    center_ = section.plan(street_.crown_m);
    for (const Side side : {Side::left, Side::right}) {
      const std::optional<double> found_m = abutment(side);
      has_abutment_[index(side)] = found_m.has_value();
      reach_m_[index(side)] = found_m.value_or(frontage_m() + 12.0) + kAbutmentHalf_m;
    }
    T_map_deck_ = upright({center_.x(), center_.y(), lowest_m()}, axis_);
  }

  void build() {
    const Footprint ground = shadow();
    for (const Side side : {Side::left, Side::right}) {
      if (has_abutment_[index(side)]) add_abutment(side);
      add_piers(side);
    }
    add_deck();
    add_girders();
    site_.taken.insert(ground);
  }

  /// The ground below the deck, with room beside it.
  [[nodiscard]] Footprint shadow() const {
    constexpr double kBeside_m = 1.5;
    const double middle_m = 0.5 * (reach_m_[0] - reach_m_[1]);
    return {center_ + middle_m * axis_,
            axis_,
            {0.5 * (reach_m_[0] + reach_m_[1]) + 0.5, kHalfWidth_m + kBeside_m}};
  }

 private:
  enum class Side { left, right };
  static std::size_t index(Side side) { return side == Side::left ? 0 : 1; }
  static double sign(Side side) { return side == Side::left ? 1.0 : -1.0; }
  [[nodiscard]] double frontage_m() const { return street_.half_width_m + street_.pavement_m; }

  [[nodiscard]] Footprint block(double x_m, double y_m, const Vector2d& half_extent_m) const {
    const Vector2d across(-axis_.y(), axis_.x());
    return {center_ + x_m * axis_ + y_m * across, axis_, half_extent_m};
  }
  [[nodiscard]] Footprint abutment_block(double x_m) const {
    return block(x_m, 0.0, {kAbutmentHalf_m, kHalfWidth_m});
  }

  /// From the crown to the middle of an abutment behind the houses' line, where there is room.
  [[nodiscard]] std::optional<double> abutment(Side side) const {
    for (double out_m = frontage_m() + 4.0; out_m <= frontage_m() + 20.0; out_m += 1.0) {
      const double middle_m = out_m + kAbutmentHalf_m;
      if (site_.fits_off_pavement(abutment_block(sign(side) * middle_m))) return middle_m;
    }
    return std::nullopt;
  }

  /// Of the girders' lower edges, map frame.
  [[nodiscard]] double lowest_m() const {
    constexpr double kGrid_m = 0.5;
    double road_m = site_.height_m(center_);
    const Footprint below = shadow();
    const Vector2d half = below.half_extent_m;
    for (double u = -half.x(); u <= half.x(); u += kGrid_m) {
      for (double v = -half.y(); v <= half.y(); v += kGrid_m) {
        const Vector2d p = below.at(u, v);
        const GroundSample sample = site_.ground.at(p.x(), p.y());
        if (sample.carriageway_distance_m < 0.3) road_m = std::max(road_m, sample.height_m);
      }
    }
    return road_m + kOverpassClearance_m;
  }

  void box(const Vector3d& low, const Vector3d& high, MaterialId material) {
    add_box(site_.world.structures,
            T_map_deck_ * Pose{Eigen::Quaterniond::Identity(), 0.5 * (low + high)},
            0.5 * (high - low), material);
  }
  [[nodiscard]] double deck_low_m() const { return T_map_deck_.translation.z(); }

  void add_abutment(Side side) {
    const double out_m = sign(side) * (reach_m_[index(side)] - kAbutmentHalf_m);
    const Footprint base = abutment_block(out_m);
    double foot_m = site_.height_m(base.center);
    for (const Vector2d& corner : base.corners()) foot_m = std::min(foot_m, site_.height_m(corner));
    foot_m -= 0.6;
    box({out_m - kAbutmentHalf_m, -kHalfWidth_m, foot_m - deck_low_m()},
        {out_m + kAbutmentHalf_m, kHalfWidth_m, 0.0}, kConcrete);
    site_.add_collider(base, foot_m, deck_low_m());
  }

  /// A row of piers under a beam, as near to the kerb as all of them stand free.
  void add_piers(Side side) {
    constexpr double kRoom_m = 0.25;
    for (double out_m = street_.half_width_m + 1.0; out_m <= frontage_m() + 3.0; out_m += 0.2) {
      const auto pier = [&](double y_m) {
        return block(sign(side) * out_m, y_m, Vector2d::Constant(kPierRadius_m));
      };
      if (!std::ranges::all_of(
              kPiers_m, [&](double y_m) { return site_.fits_beside_road(pier(y_m), kRoom_m); })) {
        continue;
      }
      const double x_m = sign(side) * out_m;
      box({x_m - kPierRadius_m - 0.05, -kHalfWidth_m + 0.2, -kCap_m},
          {x_m + kPierRadius_m + 0.05, kHalfWidth_m - 0.2, 0.0}, kConcrete);
      for (const double y_m : kPiers_m) {
        const Footprint base = pier(y_m);
        const double foot_m = site_.height_m(base.center) - 0.5;
        add_frustum(site_.world.structures,
                    upright({base.center.x(), base.center.y(), foot_m}, axis_), kPierRadius_m,
                    kPierRadius_m, deck_low_m() - kCap_m - foot_m, 14, kConcrete);
        site_.add_collider(base, foot_m, deck_low_m() - kCap_m);
      }
      return;
    }
  }

  void add_deck() {
    constexpr double kParapet_m = 0.28;
    constexpr double kParapetHeight_m = 0.9;
    const double left_m = reach_m_[0];
    const double right_m = -reach_m_[1];
    const double low_m = kGirderDepth_m;
    const double top_m = low_m + kSlab_m;
    box({right_m, -kHalfWidth_m, low_m}, {left_m, kHalfWidth_m, top_m}, kConcrete);
    for (const double side : {-1.0, 1.0}) {
      const double outer_m = side * kHalfWidth_m;
      const double inner_m = side * (kHalfWidth_m - kParapet_m);
      box({right_m, std::min(outer_m, inner_m), top_m},
          {left_m, std::max(outer_m, inner_m), top_m + kParapetHeight_m}, kConcrete);
      const double middle_m = 0.5 * (outer_m + inner_m);
      const double rail_m = top_m + kParapetHeight_m + 0.25;
      box({right_m, middle_m - 0.05, rail_m - 0.05}, {left_m, middle_m + 0.05, rail_m + 0.05},
          kRail);
      for (double x_m = right_m + 0.5; x_m < left_m; x_m += 2.0) {
        box({x_m - 0.04, middle_m - 0.04, top_m + kParapetHeight_m},
            {x_m + 0.04, middle_m + 0.04, rail_m - 0.05}, kRail);
      }
    }
  }

  void add_girders() {
    const double left_m = reach_m_[0];
    const double right_m = -reach_m_[1];
    const int lumps = std::max(1, static_cast<int>(std::lround((left_m - right_m) / kLump_m)));
    const double lump_m = (left_m - right_m) / lumps;
    for (const double y_m : kGirders_m) {
      box({right_m, y_m - 0.2, 0.0}, {left_m, y_m + 0.2, 0.03}, kSteel);
      box({right_m, y_m - 0.015, 0.03}, {left_m, y_m + 0.015, kGirderDepth_m - 0.03}, kSteel);
      box({right_m, y_m - 0.2, kGirderDepth_m - 0.03}, {left_m, y_m + 0.2, kGirderDepth_m}, kSteel);
      for (int i = 0; i < lumps; ++i) {
        const Vector3d middle(right_m + (i + 0.5) * lump_m, y_m, 0.5 * kGirderDepth_m);
        site_.world.steel.push_back({T_map_deck_ * middle, kGirder_kg_m * lump_m});
      }
    }
    add_braces(right_m, left_m);
  }

  /// Crosswise between the girders, every few metres.
  void add_braces(double right_m, double left_m) {
    constexpr double kEvery_m = 5.0;
    constexpr double kHalf_m = 0.05;
    for (double x_m = right_m + 0.5 * kEvery_m; x_m < left_m; x_m += kEvery_m) {
      for (std::size_t i = 0; i + 1 < kGirders_m.size(); ++i) {
        const auto at = [&](double y_m, double z_m) {
          return T_map_deck_ * Vector3d(x_m, y_m, z_m);
        };
        const double low_m = 0.1;
        const double high_m = kGirderDepth_m - 0.1;
        add_bar(site_.world.structures, at(kGirders_m[i], low_m), at(kGirders_m[i + 1], high_m),
                kHalf_m, kHalf_m, kSteel);
        add_bar(site_.world.structures, at(kGirders_m[i], high_m), at(kGirders_m[i + 1], low_m),
                kHalf_m, kHalf_m, kSteel);
      }
    }
  }

  TownSite& site_;
  RouteStreet street_;
  Vector2d axis_;
  Vector2d center_;
  std::array<double, 2> reach_m_{};
  std::array<bool, 2> has_abutment_{};
  Pose T_map_deck_;
};

}  // namespace

void add_overpasses(TownSite& site, const Layout& layout, std::span<const double> overpasses_m) {
  for (const double s_m : overpasses_m) {
    if (s_m < 0.0 || s_m > layout.route.length_m()) {
      throw InputError("overpasses_m: " + metres(s_m) + " is not on the route, which is " +
                       metres(layout.route.length_m()) + " long");
    }
    Overpass overpass(site, layout, s_m);
    if (!site.taken.is_free(overpass.shadow())) {
      throw InputError("overpasses_m: at " + metres(s_m) +
                       " stands another overpass or the tunnel, needs a place of its own");
    }
    overpass.build();
  }
}

}  // namespace locsim::sim
