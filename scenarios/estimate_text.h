#pragma once

#include <initializer_list>
#include <span>
#include <string>

#include "localization/localizer.h"

namespace locsim::scenarios {

/// Appends each value, to the bit, behind a separator.
void append_values(std::string& row, char separator, std::initializer_list<double> values);

/// A line of a TUM file, `t x y z qx qy qz qw`: the time exactly, values to the bit.
[[nodiscard]] std::string tum_line(Stamp time, const Pose& pose);
/// A TUM file of samples that have a `time` and a `T_map_vehicle`.
template <typename Samples>
[[nodiscard]] std::string tum_text(const Samples& samples) {
  std::string text = "# t_s x_m y_m z_m qx qy qz qw\n";
  for (const auto& sample : samples) text += tum_line(sample.time, sample.T_map_vehicle);
  return text;
}

/// As estimate.csv of a run, first line kEstimateHeader.
[[nodiscard]] std::string estimate_csv(std::span<const localization::Estimate> estimates);

}  // namespace locsim::scenarios
