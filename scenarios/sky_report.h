#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/scenario.h"
#include "scenarios/stage.h"
#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/satellites.h"
#include "sim/ray_scene.h"

namespace locsim::scenarios {

enum class SkyCover : std::uint8_t { clear, foliage, blocked };

/// What a straight ray out of the antenna meets, in cells of half a degree above the horizon.
class SkyCells {
 public:
  static constexpr std::size_t kAzimuths = 720;
  static constexpr std::size_t kElevations = 180;

  /// Cell of azimuth [i, i+1)/2 degrees from north over east and elevation [j, j+1)/2 degrees.
  [[nodiscard]] SkyCover at(std::size_t i, std::size_t j) const {
    return cells_[j * kAzimuths + i];
  }
  void set(std::size_t i, std::size_t j, SkyCover cover) { cells_[j * kAzimuths + i] = cover; }
  /// Row by row from the horizon up, each from north over east.
  [[nodiscard]] std::span<const SkyCover> cells() const { return cells_; }

  /// For each whole degree of azimuth the highest elevation at which something other than leaves
  /// blocks [rad]; 0 where nothing does. The sky may be open below: under a bridge it is.
  [[nodiscard]] std::vector<double> mask_rad() const;
  /// Share 0…1 of the solid angle from azimuth `from` up to `to` (cells) that has this cover.
  [[nodiscard]] double share(SkyCover cover, std::size_t from = 0,
                             std::size_t to = kAzimuths) const;

 private:
  std::vector<SkyCover> cells_ = std::vector<SkyCover>(kAzimuths * kElevations);
};

/// How a satellite's strongest claim on the antenna comes: straight, straight through leaves, bent
/// over an edge, by reflections alone, or not at all.
enum class SkyStatus : std::uint8_t { direct, foliage, diffracted, reflected, scattered, blocked };
inline constexpr std::array kSkyStatuses = {SkyStatus::direct,     SkyStatus::foliage,
                                            SkyStatus::diffracted, SkyStatus::reflected,
                                            SkyStatus::scattered,  SkyStatus::blocked};
[[nodiscard]] std::string sky_status_text(SkyStatus status);

struct SkySatellite {
  SatelliteId id;
  /// From north over east.
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
  SkyStatus status = SkyStatus::blocked;
  /// Of all paths' powers together, as the antenna receives them: what remains once the fading
  /// between them is averaged out. Nothing where blocked.
  std::optional<double> cn0_db_hz;
  int reflections = 0;
  struct Reflection {
    double excess_m = 0.0;
    /// Received, over the same satellite's straight signal if nothing stood in its way.
    double power_db = 0.0;
    /// The surface next to the antenna: its material by name, and the angle at which it is met.
    std::string material;
    double grazing_rad = 0.0;
  };
  /// The strongest one.
  std::optional<Reflection> strongest;
};

/// An antenna in a scene at an instant.
struct SkyPlace {
  Vector3d antenna_map = Vector3d::Zero();
  Stamp time;
  sim::GpsTime gps_time;
};

struct SkyReport {
  SkyPlace place;
  /// Of the car, from north over east.
  double heading_rad = 0.0;
  SkyCells cells;
  /// Above the horizon, in the order of their names.
  std::vector<SkySatellite> satellites;

  [[nodiscard]] int count(SkyStatus status) const;
};

/// The sky as the antenna sees it: buildings, ground and actors as they are at that instant, the
/// nominal satellites, and their signals' paths. Without receiver, faults and errors.
[[nodiscard]] SkyReport look_at_sky(const sim::World& world, const sim::RayScene& scene,
                                    const SkyPlace& place, std::vector<GnssSystem> systems,
                                    const sim::AntennaSpec& antenna);

/// From where a car on the route's schedule is `at_s` after its start, with the scenario's antenna.
/// A run's car lags behind that: it waits for its localizer, and drives as its driver does. Throws
/// InputError where the schedule has ended by then, or has not begun.
[[nodiscard]] SkyReport sky_report(const Scenario& scenario, const Stage& stage, double at_s);

/// "2026-06-01 04:00:30 UTC", to the second below; leap seconds as in GpsTime::from_utc().
[[nodiscard]] std::string utc_text(sim::GpsTime time);

}  // namespace locsim::scenarios
