#include "scenarios/scenario.h"

#include "scenarios/scenario_description.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

Pose Mount::pose() const {
  const Vector3d& rpy = roll_pitch_yaw_rad;
  return {.rotation = rotation_from_rpy(rpy.x(), rpy.y(), rpy.z()), .translation = position_m};
}

LocalizerSetup::LocalizerSetup()
    : kind(localization::localizer_kinds().front().name),
      settings(localization::make_localizer_settings(kind)) {}

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
