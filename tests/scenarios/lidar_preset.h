#pragma once

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <string_view>

#include "scenarios/presets.h"
#include "scenarios/yaml_parameters.h"
#include "sim/lidar/lidar_spec.h"

namespace locsim::scenarios {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// As built in; the test fails where there is none.
inline sim::LidarSpec lidar_preset(std::string_view name) {
  const auto text = embedded_preset("lidar", name);
  sim::LidarSpec spec;
  if (!text) {
    ADD_FAILURE() << "there is no preset " << name;
    return spec;
  }
  YamlReader reader(std::string(*text), std::string(name) + ".yaml");
  reader.read(spec);
  return spec;
}

inline double elevation_deg(const sim::LidarBeam& beam) {
  return beam.elevation_rad / kDegree;
}

}  // namespace locsim::scenarios
