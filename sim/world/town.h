#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/geodesy.h"
#include "core/parameters.h"
#include "sim/world/layout.h"
#include "sim/world/parking.h"
#include "sim/world/tunnel.h"
#include "sim/world/world.h"

namespace locsim::sim {

/// How a town looks.
struct TownConfig {
  /// Least and greatest height of buildings, floor to ridge [m].
  std::vector<double> building_height_m = {9.0, 30.0};
  /// Share of the streets' frontage without buildings; 1 leaves none.
  double building_gap_share = 0.15;
  /// Share of buildings that are between `low_building_height_m` high instead.
  double low_building_share = 0.0;
  std::vector<double> low_building_height_m = {12.0, 25.0};
  /// How densely the town is built everywhere at least: 0 leaves villas behind gardens, from 0.45
  /// on the houses stand at the pavement.
  double building_density_min = 0.0;
  /// Share of buildings with curtain walls: storeys of glass over bands of metal or concrete.
  double curtain_wall_share = 0.0;
  double tree_spacing_m = 14.0;
  double lamp_spacing_m = 28.0;
  double sign_spacing_m = 35.0;
  /// Of bins, bollards, boxes and benches together [m].
  double furniture_spacing_m = 12.0;
  double bus_stop_spacing_m = 350.0;
  /// Share of the kerbs' length taken by parked cars, where there is room.
  double parked_share = 0.3;
  /// Share of these that stand there every day.
  double parked_resident_share = 0.4;
  /// From the border of the route's lane to a parked car, at least [m].
  double parked_clearance_m = 1.1;
  /// Where bridges cross the route, as arc lengths along it [m].
  std::vector<double> overpasses_m;
  TunnelSpan tunnel;

  void describe(Parameters& p);
};

/// Days of which a town's parked cars are to be had.
struct TownDays {
  std::int64_t drive = 1;
  /// Of the map's survey; none where its cars are not asked for.
  std::optional<std::int64_t> survey;
};

struct Town {
  /// With the cars of the day of the drive.
  World world;
  /// Those of the day of the survey; they stand in no world.
  ParkedCars survey_cars;
};

/// Builds a town along all streets of `layout`: ground, tunnel and overpasses, rows of buildings,
/// trees, street furniture and parked cars, of `town_materials()`. The same arguments give the same
/// bytes; days differ in nothing but the parked cars. Nothing stands within 0.4 m of the route's
/// lane below 3.5 m, nor on a carriageway; buildings keep off the pavements and each other. Where
/// there is no room, as where a recorded route comes back on itself, less is built. Throws
/// InputError where `config` is out of its limits, and where a tunnel or an overpass cannot stand
/// where it is asked for.
[[nodiscard]] Town build_town(const TownConfig& config, const Layout& layout, std::uint64_t seed,
                              const GeodeticPoint& origin, const TownDays& days);
/// On day 1, without a survey.
[[nodiscard]] World build_town(const TownConfig& config, const Layout& layout, std::uint64_t seed,
                               const GeodeticPoint& origin);

}  // namespace locsim::sim
