#include "localization/localizer.h"

#include <cassert>

namespace locsim::localization {

std::string_view to_string(State state) {
  switch (state) {
    case State::initializing:
      return "initializing";
    case State::tracking:
      return "tracking";
    case State::degraded:
      return "degraded";
    case State::lost:
      return "lost";
  }
  assert(false);
  return "lost";
}

}  // namespace locsim::localization
