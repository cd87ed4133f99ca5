#include "scenarios/presets.h"

namespace locsim::scenarios {

std::optional<std::string_view> embedded_preset(std::string_view sensor, std::string_view name) {
  for (const EmbeddedPreset& preset : embedded_presets()) {
    if (preset.sensor == sensor && preset.name == name) return preset.text;
  }
  return std::nullopt;
}

std::vector<std::string> preset_names(std::string_view sensor) {
  std::vector<std::string> names;
  for (const EmbeddedPreset& preset : embedded_presets()) {
    if (preset.sensor == sensor) names.emplace_back(preset.name);
  }
  return names;
}

}  // namespace locsim::scenarios
