#pragma once

#include <string>
#include <vector>

#include "sim/imu/imu_spec.h"

namespace locsim::scenarios {

struct NamedImu {
  /// Of the preset, or the file.
  std::string name;
  sim::ImuSpec spec;
};

/// A preset by its name, or a file of the same kind by its path. Throws InputError where there is
/// neither, naming what is near, or where the file is wrong.
[[nodiscard]] NamedImu load_imu(const std::string& name_or_file);

/// All presets that are built in.
[[nodiscard]] std::vector<NamedImu> builtin_imus();

}  // namespace locsim::scenarios
