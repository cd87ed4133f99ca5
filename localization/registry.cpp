#include "localization/registry.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/error.h"
#include "localization/dynamic_icp/dynamic_icp_localizer.h"
#include "localization/gnss_ins/gnss_ins_localizer.h"
#include "localization/icp/icp_localizer.h"

namespace locsim::localization {

namespace {

constexpr std::array kKinds = {
    LocalizerKind{"dynamic_icp",
                  "the paper's framework: Algorithm 1 to the prior map, IMU preintegration, GNSS",
                  make_dynamic_icp_settings},
    LocalizerKind{"icp", "PCL's point-to-point ICP to the prior map, joined with the IMU",
                  make_icp_settings},
    LocalizerKind{"gnss_ins",
                  "the paper's GNSS-based odometry alone: IMU, GNSS and compass, no map",
                  make_gnss_ins_settings},
};

}  // namespace

std::span<const LocalizerKind> localizer_kinds() {
  return kKinds;
}

std::unique_ptr<LocalizerSettings> make_localizer_settings(std::string_view name) {
  const auto kind = std::ranges::find(kKinds, name, &LocalizerKind::name);
  if (kind != kKinds.end()) return kind->make_settings();
  std::string message = "localizer '" + std::string(name) + "' is not known; there is";
  for (const LocalizerKind& known : kKinds) {
    message += (&known == kKinds.data() ? " " : ", ") + std::string(known.name);
  }
  throw InputError(message);
}

}  // namespace locsim::localization
