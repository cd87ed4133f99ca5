#include <algorithm>
#include <array>
#include <string>

#include "core/random.h"
#include "sim/world/cars.h"
#include "sim/world/materials.h"

namespace locsim::sim {

namespace {

constexpr double kHalfGap_m = 0.35;
/// How far a car may stand beyond the pavement, where nothing else does.
constexpr double kBeyondPavement_m = 0.6;

CarShape draw_car(RandomSequence& random) {
  constexpr std::array kKinds = {CarKind::sedan,     CarKind::sedan,  CarKind::hatchback,
                                 CarKind::hatchback, CarKind::estate, CarKind::estate,
                                 CarKind::van};
  const auto paint =
      random.chance(0.55) ? TownMaterial::car_paint_light : TownMaterial::car_paint_dark;
  CarShape shape = usual_car(kKinds[random.pick(kKinds.size())], id(paint));
  shape.length_m *= random.uniform(0.95, 1.06);
  shape.height_m *= random.uniform(0.97, 1.04);
  return shape;
}

/// On its four wheels: tilted as the ground under them.
Pose pose_on_ground(const TownSite& site, const Footprint& footprint) {
  const double x = 0.62 * footprint.half_extent_m.x();
  const double y = 0.8 * footprint.half_extent_m.y();
  const Vector3d front_left = site.on_ground(footprint.at(x, y));
  const Vector3d front_right = site.on_ground(footprint.at(x, -y));
  const Vector3d rear_left = site.on_ground(footprint.at(-x, y));
  const Vector3d rear_right = site.on_ground(footprint.at(-x, -y));
  const Vector3d forward = (front_left + front_right - rear_left - rear_right).normalized();
  const Vector3d left = front_left + rear_left - front_right - rear_right;
  const Vector3d up = forward.cross(left).normalized();
  Matrix3d axes;
  axes << forward, up.cross(forward), up;
  return {Eigen::Quaterniond(axes), 0.25 * (front_left + front_right + rear_left + rear_right)};
}

/// Whether another road than the own one comes within a few metres of the place: a junction.
bool is_junction(const TownSite& site, const StreetSide& side, double s_m) {
  const double kerb_m = side.kerb_m();
  return std::ranges::any_of(std::array{-6.0, 0.0, 6.0}, [&](double ahead_m) {
    return std::ranges::any_of(std::array{0.3, 2.0, 4.5}, [&](double beyond_m) {
      const Vector2d p = side.at(s_m + ahead_m, kerb_m + beyond_m);
      return site.ground.at(p.x(), p.y()).carriageway_distance_m < 0.6 * beyond_m;
    });
  });
}

/// Parks a car about `s_m` as near to the carriageway as its lanes allow. Returns whether it did.
bool park(TownSite& site, const StreetSide& side, double s_m, const CarShape& shape,
          const ParkingPlan& plan, RandomSequence& random) {
  const double half_width_m = 0.5 * shape.width_m;
  const Street& street = side.street();
  // Traffic passes on streets of the route, and needs its 3.3 m.
  const double lane_m = street.carries_route ? 3.3 : 2.4;
  const double first_m = std::max(lane_m, side.kerb_m() - shape.width_m - 0.1);
  const double last_m = side.frontage_m() - shape.width_m + kBeyondPavement_m;
  Vector2d axis = side.traffic_direction(s_m);
  if (random.chance(0.08)) axis = -axis;
  const double slip_m = random.uniform(0.0, 0.15);
  for (double face_m = first_m; face_m <= last_m; face_m += 0.2) {
    const double offset_m = std::min(face_m + slip_m, last_m) + half_width_m;
    const Footprint outline{side.at(s_m, offset_m), axis, {0.5 * shape.length_m, half_width_m}};
    if (site.corridor.clearance_m(outline) < plan.lane_clearance_m) continue;
    Footprint spot = outline;
    spot.half_extent_m.x() += kHalfGap_m;
    if (!site.taken.is_free(spot)) continue;
    const Pose pose = pose_on_ground(site, outline);
    site.world.parked_cars.append(car_mesh(shape), pose);
    site.taken.insert(spot);
    const Vector3d half = shape.half_extent_m();
    site.world.colliders.push_back(
        {pose * Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, half.z()}}, half});
    return true;
  }
  return false;
}

}  // namespace

void park_cars(TownSite& site, const Layout& layout, const ParkingPlan& plan, std::uint64_t seed) {
  constexpr double kSpot_m = 5.6;
  for (std::size_t i = 0; i < layout.streets.size(); ++i) {
    for (const auto name : {StreetSide::Side::left, StreetSide::Side::right}) {
      const StreetSide side(layout.streets[i], i, name);
      RandomSequence random(seed, "town/parking/" + std::to_string(i) +
                                      (name == StreetSide::Side::left ? "/left" : "/right"));
      for (double s = 4.0; s < side.length_m() - 4.0; s += kSpot_m + random.uniform(0.0, 0.5)) {
        if (!random.chance(plan.share)) continue;
        const CarShape shape = draw_car(random);
        if (is_junction(site, side, s)) continue;
        park(site, side, s, shape, plan, random);
      }
    }
  }
}

}  // namespace locsim::sim
