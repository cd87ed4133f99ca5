#include "sim/traffic/vehicle_draw.h"
#include "sim/traffic/vehicles.h"

namespace locsim::sim {

namespace {

// Free road between two that halt.
constexpr double kHaltGap_m = 4.35;
// Room enough to the next of the lane, whatever the schedule.
constexpr double kRoomAlong_m = 1.0;
constexpr double kRoomBeside_m = 0.15;

// A car `time_s` ahead of schedule and `offset_m` ahead on the road, both negative behind.
Candidate on_schedule(const VehicleScene& scene, std::uint32_t shape, double time_s,
                      double offset_m) {
  Candidate car{.shape = shape,
                .first = 0,
                .poses = {},
                .room_along_m = kRoomAlong_m,
                .room_beside_m = kRoomBeside_m};
  const Lane lane(scene.route, scene.ground, 0.0);
  const double half_base_m = half_wheel_base_m(2.0 * scene.occupancy.half_extent_m(shape).x());
  const double end_m = scene.route.points().back().s_m;
  for (std::size_t i = 0; i < scene.steps; ++i) {
    const double now_s = kTrafficStep_s * static_cast<double>(i);
    const double s_m = scene.route.s_at_time(now_s + time_s) + offset_m;
    if (s_m >= end_m) break;
    car.poses.push_back(lane.pose(s_m, half_base_m, false));
  }
  return car;
}

// One after another away from the car, `direction` 1 ahead and −1 behind.
void add_file(const VehicleScene& scene, int count, double gap_s, double direction) {
  RandomSequence random(scene.seed, direction > 0.0 ? "traffic/leading" : "traffic/following");
  const Occupancy& occupancy = scene.occupancy;
  double offset_m = 0.0;
  double last_half_m = occupancy.half_extent_m(shapes_of(ActorKind::car).front()).x();
  for (int place = 1; place <= count; ++place) {
    const std::uint32_t drawn =
        draw_vehicle(random, scene.config.lorry_share, scene.config.bus_share);
    const auto offset_of = [&](std::uint32_t shape) {
      return offset_m + last_half_m + kHaltGap_m + occupancy.half_extent_m(shape).x();
    };
    const auto car = make_fitting(occupancy, drawn, [&](std::uint32_t shape) {
      return on_schedule(scene, shape, direction * gap_s * place, direction * offset_of(shape));
    });
    if (!car) return;
    offset_m = offset_of(car->shape);
    last_half_m = occupancy.half_extent_m(car->shape).x();
    if (!scene.occupancy.accept(*car)) return;
  }
}

}  // namespace

void add_own_lane(const VehicleScene& scene) {
  add_file(scene, scene.config.leading, scene.config.leading_gap_s, 1.0);
  add_file(scene, scene.config.following, scene.config.following_gap_s, -1.0);
}

}  // namespace locsim::sim
