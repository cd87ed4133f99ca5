#include "benchmarks/fidelity/gnss_reference.h"

#include <algorithm>
#include <cmath>

namespace locsim::fidelity {

namespace {

constexpr double kNegligible_m = 1.0;
constexpr double kNegligibleShare = 0.01;
constexpr double kMedianTells_m = 2.0;

Cn0Class real_class(const std::array<double, 3>& quantiles_m, const std::array<double, 2>& beyond,
                    const std::array<double, 2>& rates_m_s) {
  Cn0Class figures;
  figures.median_m = quantiles_m[0];
  figures.p75_m = quantiles_m[1];
  figures.p95_m = quantiles_m[2];
  figures.beyond_15_m = beyond[0];
  figures.beyond_50_m = beyond[1];
  figures.rate_static_m_s = rates_m_s[0];
  figures.rate_moving_m_s = rates_m_s[1];
  return figures;
}

}  // namespace

const RealCanyon& urbannav_hk() {
  static const RealCanyon canyon{.classes = {real_class({31, 61, 96}, {0.79, 0.32}, {2.1, 7.9}),
                                             real_class({26, 62, 88}, {0.59, 0.31}, {2.1, 6.4}),
                                             real_class({6, 25, 64}, {0.35, 0.09}, {0.27, 6.5}),
                                             real_class({0.3, 6, 41}, {0.17, 0.03}, {0.23, 3.3}),
                                             real_class({0, 0.3, 30}, {0.10, 0.01}, {0.17, 0.70}),
                                             real_class({0, 0.5, 2.9}, {0.03, 0.01}, {0.11, 0.48})},
                                 .cn0_db_hz = {18, 27, 33, 38, 43},
                                 .satellites_tracked = 16.1,
                                 .gap_p50_s = 2,
                                 .gap_p90_s = 16,
                                 .gap_max_s = 103,
                                 .longest_without_fix_s = {63, 67},
                                 .overconfidence = {4.4, 7.8}};
  return canyon;
}

const std::array<RealSolution, 3>& urbannav_hk_solutions() {
  static const std::array<RealSolution, 3> solutions = {
      {{"single point", 0.29, {.mean = 5.2, .deviation = 6.3, .rms = 8.1, .max = 50}},
       {"with RAIM", 0.41, {.mean = 6.6, .deviation = 7.9, .rms = 10.3, .max = 51}},
       {"RAIM, C/N0 >= 30",
        0.78,
        {.mean = 9.9, .deviation = 18.8, .rms = 21.2, .p50 = 4.6, .p95 = 34, .max = 214}}}};
  return solutions;
}

const std::array<DataSheet, 2>& data_sheets() {
  static const std::array<DataSheet, 2> sheets = {{{"ublox_m8t", 2.5}, {"ublox_f9p", 1.5}}};
  return sheets;
}

double factor(double a, double b, double negligible) {
  if (std::isnan(a) || std::isnan(b)) return kNoFigure;
  const double more = std::max({a, b, negligible});
  const double less = std::max(std::min(a, b), negligible);
  return more / less;
}

std::array<ClassFactors, kCn0Classes> class_factors(const std::array<Cn0Class, kCn0Classes>& real,
                                                    const std::array<Cn0Class, kCn0Classes>& ours) {
  std::array<ClassFactors, kCn0Classes> factors;
  for (std::size_t i = 0; i < kCn0Classes; ++i) {
    const Cn0Class& r = real[i];
    const Cn0Class& o = ours[i];
    ClassFactors& f = factors[i];
    if (o.count == 0) {
      f.worst = f.typical = std::numeric_limits<double>::infinity();
      continue;
    }
    if (r.median_m > kMedianTells_m) f.median = factor(r.median_m, o.median_m, kNegligible_m);
    f.p75 = factor(r.p75_m, o.p75_m, kNegligible_m);
    f.p95 = factor(r.p95_m, o.p95_m, kNegligible_m);
    f.beyond_15_m = factor(r.beyond_15_m, o.beyond_15_m, kNegligibleShare);
    f.beyond_50_m = factor(r.beyond_50_m, o.beyond_50_m, kNegligibleShare);
    double sum = 0.0;
    int count = 0;
    f.worst = 1.0;
    for (const double each : {f.median, f.p75, f.p95, f.beyond_15_m, f.beyond_50_m}) {
      if (std::isnan(each)) continue;
      f.worst = std::max(f.worst, each);
      sum += std::log(each);
      ++count;
    }
    f.typical = std::exp(sum / count);
  }
  return factors;
}

Verdict verdict(const std::array<ClassFactors, kCn0Classes>& factors, double ClassFactors::*which) {
  Verdict verdict;
  for (const ClassFactors& f : factors) {
    if (f.*which <= 1.5) ++verdict.within_1_5;
    if (f.*which <= 2.0) ++verdict.within_2;
  }
  return verdict;
}

}  // namespace locsim::fidelity
