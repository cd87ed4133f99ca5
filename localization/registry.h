#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "core/geodesy.h"
#include "core/parameters.h"
#include "localization/localizer.h"
#include "maps/prior_map.h"

namespace locsim::localization {

/// What every localizer is built from.
struct LocalizerInputs {
  Rig rig;
  /// May be null: for localizers that need none.
  std::shared_ptr<const maps::PriorMap> map;
  /// Of the map frame.
  GeodeticPoint origin;
  /// Threads it may use; the result must not depend on it.
  int threads = 1;
};

/// The settings of one kind of localizer, described once for reading, writing and checking.
class LocalizerSettings {
 public:
  virtual ~LocalizerSettings() = default;
  virtual void describe(Parameters& p) = 0;
  [[nodiscard]] virtual std::unique_ptr<Localizer> make(const LocalizerInputs& inputs) const = 0;
};

struct LocalizerKind {
  std::string_view name;
  std::string_view about;
  std::unique_ptr<LocalizerSettings> (*make_settings)();
};

/// All kinds, in the order of the registry. A new localizer is one folder and one line there.
[[nodiscard]] std::span<const LocalizerKind> localizer_kinds();
/// Throws InputError naming the kinds there are.
[[nodiscard]] std::unique_ptr<LocalizerSettings> make_localizer_settings(std::string_view name);

}  // namespace locsim::localization
