#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace locsim::scenarios {

/// A sensor preset as YAML text, built into the library from `sim/<sensor>/presets/<name>.yaml`.
struct EmbeddedPreset {
  std::string_view sensor;
  std::string_view name;
  std::string_view text;
};

[[nodiscard]] std::span<const EmbeddedPreset> embedded_presets();

/// The text of the preset `name` of a sensor ("lidar", "imu", "gnss", "magnetometer"), nothing
/// where there is none.
[[nodiscard]] std::optional<std::string_view> embedded_preset(std::string_view sensor,
                                                              std::string_view name);
/// Names of a sensor's presets.
[[nodiscard]] std::vector<std::string> preset_names(std::string_view sensor);

}  // namespace locsim::scenarios
