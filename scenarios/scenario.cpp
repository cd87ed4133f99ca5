#include "scenarios/scenario.h"

#include "scenarios/scenario_description.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

Pose Mount::pose() const {
  const Vector3d& rpy = roll_pitch_yaw_rad;
  return {.rotation = rotation_from_rpy(rpy.x(), rpy.y(), rpy.z()), .translation = position_m};
}

void Mount::describe_position(Parameters& p) {
  constexpr Bounds kOnVehicle{.min = -20.0, .max = 20.0};
  p.number("x_m", position_m.x(), kOnVehicle);
  p.number("y_m", position_m.y(), kOnVehicle);
  p.number("z_m", position_m.z(), kOnVehicle);
}

void Mount::describe_pose(Parameters& p) {
  constexpr Bounds kAnyTurn{.min = -360.0, .max = 360.0};
  describe_position(p);
  p.degrees("roll_deg", roll_pitch_yaw_rad.x(), kAnyTurn);
  p.degrees("pitch_deg", roll_pitch_yaw_rad.y(), kAnyTurn);
  p.degrees("yaw_deg", roll_pitch_yaw_rad.z(), kAnyTurn);
}

LocalizerSetup::LocalizerSetup()
    : kind(localization::localizer_kinds().front().name),
      settings(localization::make_localizer_settings(kind)) {}

void LocalizerSetup::describe(Parameters& p) {
  std::vector<std::string_view> kinds;
  for (const localization::LocalizerKind& known : localization::localizer_kinds()) {
    kinds.push_back(known.name);
  }
  const std::string before = kind;
  p.choice("kind", kind, kinds);
  if (kind != before) settings = localization::make_localizer_settings(kind);
  settings->describe(p);
}

localization::Rig inertial_rig(const ImuSetup& imu, const Mount& antenna) {
  localization::Rig rig;
  rig.T_vehicle_imu = imu.mount.pose();
  rig.antenna_in_vehicle_m = antenna.position_m;
  rig.imu_rate_hz = imu.spec.rate_hz;
  rig.gyro_noise_rad_s_sqrthz = imu.spec.gyro_noise_rad_s_sqrthz();
  rig.accel_noise_m_s2_sqrthz = imu.spec.accelerometer_noise_m_s2_sqrthz();
  rig.gyro_bias_walk_rad_s2_sqrthz = imu.spec.gyro_bias_walk_rad_s_sqrts();
  rig.accel_bias_walk_m_s3_sqrthz = imu.spec.accelerometer_bias_walk_m_s2_sqrts();
  return rig;
}

Scenario load_scenario(const std::filesystem::path& path, std::span<const std::string> overrides) {
  return parse_scenario(read_text_file(path), path.string(), path.parent_path(), overrides);
}

Scenario parse_scenario(const std::string& yaml, const std::string& display_name,
                        const std::filesystem::path& folder,
                        std::span<const std::string> overrides) {
  YamlReader reader(yaml, display_name, overrides);
  Scenario scenario;
  scenario.name = std::filesystem::path(display_name).stem().string();
  ScenarioDescription(reader, &reader, folder).describe(scenario);
  reader.finish();
  return scenario;
}

std::string scenario_about(const std::filesystem::path& path) {
  YamlReader reader = YamlReader::from_file(path);
  std::string about;
  reader.text("about", about);
  return about;
}

std::string to_yaml(const Scenario& scenario) {
  Scenario copy = scenario;
  YamlWriter writer;
  ScenarioDescription(writer, nullptr, {}).describe(copy);
  return writer.str();
}

}  // namespace locsim::scenarios
