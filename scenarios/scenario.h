#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/geodesy.h"
#include "core/pose.h"
#include "localization/registry.h"
#include "maps/build/survey.h"
#include "scenarios/scoring/criteria.h"
#include "sim/faults/faults.h"
#include "sim/gnss/gnss_spec.h"
#include "sim/gnss/satellites.h"
#include "sim/imu/imu_spec.h"
#include "sim/lidar/lidar_spec.h"
#include "sim/magnetometer/magnetometer_spec.h"
#include "sim/traffic/traffic_config.h"
#include "sim/vehicle/driver.h"
#include "sim/vehicle/vehicle_spec.h"
#include "sim/weather/weather.h"
#include "sim/world/mesh_world.h"
#include "sim/world/recorded_layout.h"
#include "sim/world/town.h"
#include "sim/world/town_layout.h"

namespace locsim::scenarios {

/// Period of the driver, and in which all sensors but the LIDARs are sampled.
inline constexpr Duration kControlPeriod{10'000'000};

/// What stands around the road.
struct WorldSetup {
  /// "town" or "mesh".
  std::string kind = "town";
  std::uint64_t seed = 1;
  /// Of the drive: decides which cars stand at a town's kerbs.
  std::int64_t day = 1;
  /// Of the map frame. A recorded route in geodetic coordinates brings its own.
  GeodeticPoint origin;
  sim::TownConfig town;
  sim::MeshWorldConfig mesh;
};

/// What the car is to drive.
struct RouteSetup {
  /// "town" or "recorded".
  std::string kind = "town";
  /// Of a recorded route.
  std::filesystem::path file;
  sim::TownLayoutConfig town;
  sim::RecordedLayoutConfig recorded;
};

struct VehicleSetup {
  /// "sedan".
  std::string kind = "sedan";
  /// What the driver steers by: "estimate" or "truth".
  std::string feedback = "estimate";
  sim::VehicleSpec spec;
  sim::DriverConfig driver;
};

/// Where a sensor sits: T_vehicle_sensor, from the ground under the middle of the rear axle.
struct Mount {
  Vector3d position_m = Vector3d::Zero();
  Vector3d roll_pitch_yaw_rad = Vector3d::Zero();

  [[nodiscard]] Pose pose() const;
  /// Keys of an antenna's mount, which has no direction, and of a sensor's that has one.
  void describe_position(Parameters& p);
  void describe_pose(Parameters& p);
};

template <typename Spec>
struct SensorSetup {
  /// Of those built in, or "none": where a user's own file was named, `spec` holds its values.
  std::string preset = {};
  Mount mount = {};
  Spec spec = {};
};
using LidarSetup = SensorSetup<sim::LidarSpec>;
using ImuSetup = SensorSetup<sim::ImuSpec>;
using GnssSetup = SensorSetup<sim::GnssSpec>;
using MagnetometerSetup = SensorSetup<sim::MagnetometerSpec>;

struct SensorSuite {
  std::vector<LidarSetup> lidar;
  ImuSetup imu;
  /// The mount is the antenna's; it has no direction.
  GnssSetup gnss;
  MagnetometerSetup magnetometer;

  /// An HDL-32E on the roof, an MTi-10 and a ublox F9P.
  SensorSuite();
};

/// The prior map that the localizer gets.
struct MapSetup {
  /// "survey" or "file".
  std::string source = "survey";
  /// Folder of a map, for "file".
  std::filesystem::path file;
  maps::build::SurveyConfig survey;
  /// Of the survey, and whether it has the cars that stood at a town's kerbs on that day.
  std::int64_t day = 0;
  bool parked_cars = true;
  /// Share of the map that the world has changed under since, `maps::age`.
  double stale = 0.0;
};

struct LocalizerSetup {
  std::string kind;
  /// Shared by copies of a scenario; nobody changes it after loading.
  std::shared_ptr<localization::LocalizerSettings> settings;

  /// The first kind of the registry, with its defaults.
  LocalizerSetup();
  /// `kind` and the keys of that kind; another kind starts from its defaults.
  void describe(Parameters& p);
};

/// IMU and antenna as their calibration sheets tell a localizer; without LIDARs.
[[nodiscard]] localization::Rig inertial_rig(const ImuSetup& imu, const Mount& antenna);

/// Everything that a run is made from. Paths are absolute. Made by load_scenario(), which fills in
/// the sensors' presets.
struct Scenario {
  std::string name;
  std::string about;
  std::uint64_t seed = 1;
  /// When the drive starts, UTC: places the satellites, and the earth's magnetic field.
  std::string date = "2026-06-01T04:00:00Z";
  /// 0: until the route's end.
  double duration_s = 0.0;
  /// From the end of a scan to its estimate at the driver.
  double latency_s = 0.05;
  WorldSetup world;
  RouteSetup route;
  VehicleSetup vehicle;
  sim::TrafficConfig traffic;
  SensorSuite sensors;
  std::vector<sim::FaultSpec> faults;
  /// At rising times; none is clear.
  std::vector<sim::WeatherSpec> weather;
  MapSetup map;
  LocalizerSetup localizer;
  std::vector<Criterion> expect;

  /// GPS time at Stamp{}.
  [[nodiscard]] sim::GpsTime gps_start() const { return sim::GpsTime::from_utc(date); }
};

/// Reads a scenario file. `overrides` are "key.path=value". Files that it names are relative to
/// its folder; those named by an override, to the current folder. Throws InputError naming file,
/// line (or override) and key: unknown keys, wrong values, files that are missing.
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& path,
                                     std::span<const std::string> overrides = {});

/// The same from text; `display_name` stands for the file in messages.
[[nodiscard]] Scenario parse_scenario(const std::string& yaml, const std::string& display_name,
                                      const std::filesystem::path& folder = ".",
                                      std::span<const std::string> overrides = {});

/// What a scenario file says under `about`. Throws InputError where it is no scenario file.
[[nodiscard]] std::string scenario_about(const std::filesystem::path& path);

/// The scenario with every default filled in: it reads back as the same scenario, without the
/// files of a user's presets.
[[nodiscard]] std::string to_yaml(const Scenario& scenario);

}  // namespace locsim::scenarios
