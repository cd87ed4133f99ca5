#pragma once

#include <span>
#include <string_view>

namespace locsim::scenarios {

/// A sensor preset as YAML text, built into the library from `sim/<sensor>/presets/<name>.yaml`.
struct EmbeddedPreset {
  std::string_view sensor;
  std::string_view name;
  std::string_view text;
};

[[nodiscard]] std::span<const EmbeddedPreset> embedded_presets();

}  // namespace locsim::scenarios
