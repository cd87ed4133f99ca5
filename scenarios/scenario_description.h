#pragma once

#include <filesystem>

#include "core/parameters.h"
#include "scenarios/scenario.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

/// Names every key of a scenario file once, for reading and for writing.
class ScenarioDescription {
 public:
  /// `reader` is `p` where a file is being read, otherwise null. Files named in it are relative
  /// to `folder`.
  ScenarioDescription(Parameters& p, YamlReader* reader, std::filesystem::path folder)
      : p_(p), reader_(reader), folder_(std::move(folder)) {}

  void describe(Scenario& scenario);

 private:
  void describe(WorldSetup& world);
  void describe(RouteSetup& route);
  void describe(VehicleSetup& vehicle);
  void describe(SensorSuite& sensors);
  void describe(MapSetup& map);
  void describe_expectations(std::vector<Criterion>& expect);

  enum class MountKeys { position, pose };
  template <typename Spec>
  void describe_sensor(std::string_view sensor, SensorSetup<Spec>& setup, MountKeys mount_keys);
  void describe_preset(std::string_view sensor, std::string& preset);
  void describe_mount(Mount& mount, MountKeys keys);
  void check_date(const std::string& date);
  void check_imu_rate(const Scenario& scenario);
  void check_fault_sensors(const Scenario& scenario);
  void check_weather_times(const Scenario& scenario);
  void check_lidar_rates(const Scenario& scenario);

  void unsigned_integer(std::string_view key, std::uint64_t& value);
  enum class PathKind { file, folder };
  void path(std::string_view key, std::filesystem::path& path, PathKind kind);
  /// `text`, as it stands at `key`, made absolute; when reading, it has to exist.
  [[nodiscard]] std::filesystem::path existing(std::string_view key, const std::string& text,
                                               PathKind kind);
  [[nodiscard]] std::filesystem::path resolved(std::string_view key, const std::string& text) const;

  Parameters& p_;
  YamlReader* reader_;
  std::filesystem::path folder_;
};

}  // namespace locsim::scenarios
