#pragma once

#include <compare>
#include <memory>
#include <vector>

#include "core/satellite_id.h"

namespace locsim::sim {

/// The ranging signal of a system on L1: GPS C/A, Galileo E1 (as BOC(1,1)), GLONASS L1OF,
/// BeiDou B1I.
struct Modulation {
  double chip_rate_hz = 1.023e6;
  /// Of a square subcarrier at the chip rate.
  bool is_boc = false;

  [[nodiscard]] double chip_m() const;
  /// From the top of the correlation to its first zero, were the band unlimited: a chip, and a
  /// third of one for BOC(1,1), whose correlation falls three times as fast.
  [[nodiscard]] double peak_m() const;
  friend auto operator<=>(const Modulation&, const Modulation&) = default;
};
[[nodiscard]] Modulation modulation_of(GnssSystem system);

/// Autocorrelation of a ranging signal behind a front end of finite bandwidth, 1 at its peak:
/// the cosine transform of its power spectrum over the band (a brick wall of linear phase),
/// tabulated to two chips, beyond which what is left of it counts as 0. Sidelobes of the codes are
/// left out.
class Correlation {
 public:
  /// `bandwidth_hz` two-sided; infinite gives the sharp triangle (or that of BOC), exactly. Throws
  /// InputError where it is not positive.
  Correlation(const Modulation& modulation, double bandwidth_hz);
  /// At a delay, either sign [m]; 0 beyond what is tabulated.
  [[nodiscard]] double at(double delay_m) const;

 private:
  double steps_per_m_;
  /// At 0, 1, … steps; the last two are 0.
  std::vector<double> table_;
};

/// The same for all who ask for it again: a table takes milliseconds to make. Any thread may ask.
[[nodiscard]] std::shared_ptr<const Correlation> shared_correlation(const Modulation& modulation,
                                                                    double bandwidth_hz);

}  // namespace locsim::sim
