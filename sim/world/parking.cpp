#include "sim/world/parking.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/random.h"
#include "sim/world/cars.h"
#include "sim/world/materials.h"

namespace locsim::sim {

namespace {

constexpr double kHalfGap_m = 0.35;
/// How far a car may stand beyond the pavement, where nothing else does.
constexpr double kBeyondPavement_m = 0.6;
/// From one spot's middle to the next one's, at least.
constexpr double kSpot_m = 5.6;
/// How a resident's car stands elsewhere from day to day: along, across and turned. Within its
/// gap, and within `kSlack_m` of its sides with the corners of a car of 6 m.
constexpr double kDayAlong_m = 0.3;
constexpr double kDayAcross_m = 0.05;
constexpr double kDayTurn_rad = 0.9 * std::numbers::pi / 180.0;
constexpr double kSlack_m = 0.1;

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

/// A place beside the road where cars may stand.
struct Spot {
  const StreetSide* side;
  std::string name;
  double s_m;
  bool is_residents;
};

class Parking {
 public:
  Parking(const TownSite& site, const ParkingPlan& plan) : site_(site), plan_(plan) {}

  /// Where a car fits about `s_m`, as near to the carriageway as its lanes allow, with
  /// `slack_m` on each side.
  [[nodiscard]] std::optional<Footprint> place(const Spot& spot, const CarShape& shape,
                                               double slack_m, RandomSequence& random) const {
    const StreetSide& side = *spot.side;
    const double half_width_m = 0.5 * shape.width_m;
    // Traffic passes on streets of the route, and needs its 3.3 m.
    const double lane_m = side.street().carries_route ? 3.3 : 2.4;
    const double first_m = std::max(lane_m, side.kerb_m() - shape.width_m - 0.1);
    const double last_m = side.frontage_m() - shape.width_m + kBeyondPavement_m;
    Vector2d axis = side.traffic_direction(spot.s_m);
    if (random.chance(0.08)) axis = -axis;
    const double slip_m = random.uniform(0.0, 0.15);
    for (double face_m = first_m; face_m <= last_m; face_m += 0.2) {
      const double offset_m = std::min(face_m + slip_m, last_m) + half_width_m + slack_m;
      const Footprint outline{
          side.at(spot.s_m, offset_m), axis, {0.5 * shape.length_m, half_width_m}};
      Footprint room = outline;
      room.half_extent_m.y() += slack_m;
      if (slack_m > 0.0) room.half_extent_m.x() += kHalfGap_m;
      if (site_.corridor.clearance_m(room) < plan_.lane_clearance_m) continue;
      room.half_extent_m.x() = outline.half_extent_m.x() + kHalfGap_m;
      if (site_.taken.is_free(room) && taken_.is_free(room)) return outline;
    }
    return std::nullopt;
  }

  void park(const CarShape& shape, const Footprint& outline) {
    const Pose pose = pose_on_ground(site_, outline);
    cars_.mesh.append(car_mesh(shape), pose);
    const Vector3d half = shape.half_extent_m();
    cars_.colliders.push_back(
        {pose * Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, half.z()}}, half});
    for (const SteelBody& body : car_steel(shape)) {
      cars_.steel.push_back({pose * body.position, body.mass_kg});
    }
  }

  void take(Footprint outline, double slack_m) {
    outline.half_extent_m += Vector2d(kHalfGap_m, slack_m);
    taken_.insert(outline);
  }

  [[nodiscard]] ParkedCars take_cars() { return std::move(cars_); }

 private:
  const TownSite& site_;
  const ParkingPlan& plan_;
  FootprintGrid taken_;
  ParkedCars cars_;
};

Footprint moved(const Footprint& usual, RandomSequence& random) {
  Footprint today = usual;
  const double along_m = random.uniform(-kDayAlong_m, kDayAlong_m);
  today.center = usual.at(along_m, random.uniform(-kDayAcross_m, kDayAcross_m));
  const Eigen::Rotation2Dd turn(random.uniform(-kDayTurn_rad, kDayTurn_rad));
  today.axis = turn * usual.axis;
  return today;
}

/// The same on every day, whatever the other streets hold.
std::vector<Spot> draw_spots(const TownSite& site, const std::vector<StreetSide>& sides,
                             const ParkingPlan& plan, std::uint64_t seed) {
  std::vector<Spot> spots;
  for (const StreetSide& side : sides) {
    const std::string name = "town/parking/" + std::to_string(side.index()) +
                             (side.side() == StreetSide::Side::left ? "/left" : "/right");
    RandomSequence random(seed, name);
    for (double s = 4.0; s < side.length_m() - 4.0; s += kSpot_m + random.uniform(0.0, 0.5)) {
      const bool is_residents = random.chance(plan.share * plan.resident_share);
      if (!is_junction(site, side, s)) spots.push_back({&side, name, s, is_residents});
    }
  }
  return spots;
}

}  // namespace

ParkedCars park_cars(const TownSite& site, const Layout& layout, const ParkingPlan& plan,
                     std::uint64_t seed, std::int64_t day) {
  if (plan.share <= 0.0) return {};
  std::vector<StreetSide> sides;
  for (std::size_t i = 0; i < layout.streets.size(); ++i) {
    for (const auto side : {StreetSide::Side::left, StreetSide::Side::right}) {
      sides.emplace_back(layout.streets[i], i, side);
    }
  }
  const std::vector<Spot> spots = draw_spots(site, sides, plan, seed);
  Parking parking(site, plan);
  const std::string today = "/day/" + std::to_string(day);
  // Residents first: where they usually stand must not depend on who comes that day.
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (!spots[i].is_residents) continue;
    const std::string name = spots[i].name + "/resident/" + std::to_string(i);
    RandomSequence random(seed, name);
    const CarShape shape = draw_car(random);
    const std::optional<Footprint> usual = parking.place(spots[i], shape, kSlack_m, random);
    if (!usual) continue;
    parking.take(*usual, kSlack_m);
    RandomSequence moves(seed, name + today);
    parking.park(shape, moved(*usual, moves));
  }
  // Of the other spots, so many that the share is that of the plan.
  const double residents = plan.share * plan.resident_share;
  const double visited = residents < 1.0 ? (plan.share - residents) / (1.0 - residents) : 0.0;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (spots[i].is_residents) continue;
    RandomSequence random(seed, spots[i].name + "/visitor/" + std::to_string(i) + today);
    if (!random.chance(visited)) continue;
    const CarShape shape = draw_car(random);
    const std::optional<Footprint> outline = parking.place(spots[i], shape, 0.0, random);
    if (!outline) continue;
    parking.take(*outline, 0.0);
    parking.park(shape, *outline);
  }
  return parking.take_cars();
}

}  // namespace locsim::sim
