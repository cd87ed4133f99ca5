#pragma once

#include <array>
#include <string_view>

#include "benchmarks/fidelity/gnss_figures.h"

namespace locsim::fidelity {

/// What is known of a real receiver; NaN where nothing is.
struct RealCanyon {
  std::array<Cn0Class, kCn0Classes> classes;
  std::array<double, 5> cn0_db_hz{};
  double satellites_tracked = kNoFigure;
  double gap_p50_s = kNoFigure;
  double gap_p90_s = kNoFigure;
  double gap_max_s = kNoFigure;
  /// Least and greatest, by sequence and solution.
  std::array<double, 2> longest_without_fix_s{};
  std::array<double, 2> overconfidence{};
};
/// A u-blox M8T on GPS L1 and BeiDou B1 in Tsim Sha Tsui, measured on UrbanNav-HK (Hsu et al.) from
/// its RINEX and its truth. How the receiver's clock was taken off is not recorded; medians of 0
/// with upper quartiles of 0.3 m tell that errors have their sign.
[[nodiscard]] const RealCanyon& urbannav_hk();

/// Single-point solutions of 485 s of its canyon, in 2D.
struct RealSolution {
  std::string_view name;
  double availability = kNoFigure;
  ErrorFigures horizontal_m;
};
[[nodiscard]] const std::array<RealSolution, 3>& urbannav_hk_solutions();

/// What a data sheet promises under an open sky, as remembered.
struct DataSheet {
  std::string_view preset;
  double cep_m = kNoFigure;
  double velocity_m_s = 0.05;
};
[[nodiscard]] const std::array<DataSheet, 2>& data_sheets();

/// How far one figure is from another, ≥ 1: the greater over the lesser, both at least
/// `negligible`. NaN where either is.
[[nodiscard]] double factor(double a, double b, double negligible);

/// Factors of one class of C/N0, ours against the real ones.
struct ClassFactors {
  /// NaN where the real median lies below 2 m: its amount is no error, but the zero of the clock.
  double median = kNoFigure;
  double p75 = kNoFigure;
  double p95 = kNoFigure;
  double beyond_15_m = kNoFigure;
  double beyond_50_m = kNoFigure;
  /// Of these: the greatest, and the geometric mean.
  double worst = kNoFigure;
  double typical = kNoFigure;
};
/// Metres below 1 and shares below 1 % count as these. A class that ours has nothing in has
/// infinite ones.
[[nodiscard]] std::array<ClassFactors, kCn0Classes> class_factors(
    const std::array<Cn0Class, kCn0Classes>& real, const std::array<Cn0Class, kCn0Classes>& ours);

/// Classes whose factor is 1.5 at most, and 2 at most.
struct Verdict {
  int within_1_5 = 0;
  int within_2 = 0;
  /// Four of six within 1.5, all within 2.
  [[nodiscard]] bool is_met() const {
    return within_1_5 >= 4 && within_2 == static_cast<int>(kCn0Classes);
  }
};
[[nodiscard]] Verdict verdict(const std::array<ClassFactors, kCn0Classes>& factors,
                              double ClassFactors::*which);

}  // namespace locsim::fidelity
