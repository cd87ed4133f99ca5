#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/pose.h"
#include "core/random.h"
#include "localization/preprocess/point_picker.h"
#include "maps/prior_map.h"
#include "scenarios/scenario.h"
#include "scenarios/stage.h"
#include "sim/ray_scene.h"
#include "sim/world/layout.h"

namespace locsim::relocalization {

/// Where a car stands: on which street, how far along it and which way it faces.
struct Berth {
  std::size_t street = 0;
  double station_m = 0.0;
  /// 1 with the street's vertices, −1 against them; it keeps to its right-hand lane.
  double direction = 1.0;
  /// From the middle of its lane, positive to its left, and from the street's course.
  double lateral_m = 0.0;
  double turn_rad = 0.0;
  Stamp time;
};

/// A scenario's town with another seed: its traffic, its surveyed map, and its first LIDAR that may
/// be set anywhere on its streets.
class StartTown {
 public:
  /// Throws InputError as load_scenario does.
  StartTown(const std::filesystem::path& scenario, std::uint64_t seed,
            const localization::PointPickerConfig& picker);
  ~StartTown();

  [[nodiscard]] const maps::PriorMap& map() const { return *map_; }
  /// Free berths, even over the length of all streets, both ways: within 0.6 m of the lane's
  /// middle, 5° of its course, at any time of the drive.
  [[nodiscard]] std::vector<Berth> draw_berths(int count) const;
  /// The same car so much later. It waits where the way is blocked or the street ends.
  [[nodiscard]] Berth driven_on(const Berth& from, double distance_m, double time_s) const;
  /// On the road's surface, with its slope and camber.
  [[nodiscard]] Pose pose(const Berth& berth) const;
  /// A scan while standing there, thinned as a localizer does, vehicle frame.
  [[nodiscard]] std::vector<Vector3f> scan(const Berth& berth) const;

 private:
  [[nodiscard]] bool is_free(const Berth& berth) const;

  scenarios::Scenario scenario_;
  scenarios::Stage stage_;
  std::shared_ptr<const maps::PriorMap> map_;
  std::unique_ptr<sim::GroundSurface> ground_;
  std::unique_ptr<sim::RayScene> scene_;
  localization::PointPickerConfig picker_;
};

}  // namespace locsim::relocalization
