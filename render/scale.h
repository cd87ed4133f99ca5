#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/color.h"

namespace locsim::render {

/// The smallest of 1, 2, 5 times a power of ten that is not below `value` > 0.
[[nodiscard]] double round_up_125(double value);
/// The greatest of 1, 2, 5 times a power of ten that is not above `value` > 0.
[[nodiscard]] double round_down_125(double value);

/// A range of values on an axis or a colour bar, even or by decades.
struct Scale {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;

  /// 0 at `low`, 1 at `high`; beyond them where the value is. Values of a logarithmic scale that
  /// are not positive count as far below `low`.
  [[nodiscard]] double fraction(double value) const;
  /// Round values from low to high: about `count` of them, or every decade.
  [[nodiscard]] std::vector<double> ticks(int count) const;
  /// A tick's value with as many digits as tell it from its neighbours; a true minus sign.
  [[nodiscard]] std::string label(double tick, int count) const;
};

/// Covers all finite `values` with round ends, from zero if `zero_based`. [0, 1] for none.
[[nodiscard]] Scale scale_for(std::span<const double> values, int ticks, bool zero_based);

/// For errors: from zero to a round value, or by decades (at most four) where the greatest lies far
/// above the median. `share` 0…1 of the values are covered; what is beyond is off the scale.
[[nodiscard]] Scale error_scale(std::span<const double> errors, double share);

}  // namespace locsim::render
