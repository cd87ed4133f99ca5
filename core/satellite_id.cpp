#include "core/satellite_id.h"

namespace locsim {

std::string SatelliteId::name() const {
  constexpr std::string_view kLetters = "GREC";
  return kLetters[static_cast<std::size_t>(system)] + std::string(number < 10 ? "0" : "") +
         std::to_string(number);
}

}  // namespace locsim
