#include "scenarios/imu_presets.h"

#include <filesystem>

#include "core/error.h"
#include "scenarios/presets.h"
#include "scenarios/text_distance.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace {

constexpr const char* kSensor = "imu";

NamedImu read(YamlReader reader, const std::string& name) {
  NamedImu imu{.name = name, .spec = {}};
  reader.read(imu.spec);
  return imu;
}

NamedImu read_builtin(const std::string& name, std::string_view text) {
  return read(YamlReader(std::string(text), "sim/imu/presets/" + name + ".yaml"), name);
}

}  // namespace

NamedImu load_imu(const std::string& name_or_file) {
  if (const auto text = embedded_preset(kSensor, name_or_file)) {
    return read_builtin(name_or_file, *text);
  }
  if (!std::filesystem::exists(name_or_file)) {
    throw InputError("IMU '" + name_or_file + "': no preset and no file of that name" +
                     suggestion(name_or_file, preset_names(kSensor)));
  }
  return read(YamlReader::from_file(name_or_file), name_or_file);
}

std::vector<NamedImu> builtin_imus() {
  std::vector<NamedImu> imus;
  for (const EmbeddedPreset& preset : embedded_presets()) {
    if (preset.sensor == kSensor) {
      imus.push_back(read_builtin(std::string(preset.name), preset.text));
    }
  }
  return imus;
}

}  // namespace locsim::scenarios
