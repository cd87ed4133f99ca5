# locsim_embed_presets(TARGET): every sim/<sensor>/presets/<name>.yaml as text in the target,
# found at run time by locsim::scenarios::embedded_preset("<sensor>", "<name>").
function(locsim_embed_presets target)
  file(GLOB presets CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/sim/*/presets/*.yaml")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${presets})
  set(entries "")
  foreach(preset IN LISTS presets)
    file(READ "${preset}" text)
    cmake_path(GET preset STEM name)
    cmake_path(GET preset PARENT_PATH folder)
    cmake_path(GET folder PARENT_PATH folder)
    cmake_path(GET folder FILENAME sensor)
    string(APPEND entries "    {\"${sensor}\", \"${name}\", R\"preset(${text})preset\"},\n")
  endforeach()
  set(output "${CMAKE_CURRENT_BINARY_DIR}/embedded_presets.cpp")
  file(CONFIGURE OUTPUT "${output}.new" CONTENT [[
#include "scenarios/presets.h"

namespace locsim::scenarios {

std::span<const EmbeddedPreset> embedded_presets() {
  static constexpr EmbeddedPreset presets[] = {
@entries@  };
  return presets;
}

}  // namespace locsim::scenarios
]] @ONLY)
  file(COPY_FILE "${output}.new" "${output}" ONLY_IF_DIFFERENT)
  target_sources(${target} PRIVATE "${output}")
endfunction()
