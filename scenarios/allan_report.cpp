#include "scenarios/allan_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "sim/imu/imu_at_rest.h"

namespace locsim::scenarios {

namespace {

std::string format(const char* pattern, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), pattern, value);
  return text.data();
}

// "one stretch", "3 stretches".
std::string count_of(std::size_t count, const std::string& what, const std::string& plural) {
  return count == 1 ? "one " + what : std::to_string(count) + " " + plural;
}

void describe_intervals(const ImuLog& log, AllanReport& report) {
  std::string note = std::to_string(log.samples.size()) + " samples in " +
                     format("%.2f s", log.duration_s()) + ", " +
                     format("%.2f Hz, intervals of ", log.rate_hz) +
                     format("%.4g", 1e3 * log.shortest_interval_s) + " to " +
                     format("%.4g ms", 1e3 * log.longest_interval_s);
  if (log.gaps.empty()) {
    note += ", no gaps.";
  } else {
    double longest_s = 0.0;
    for (const ImuLog::Gap& gap : log.gaps) longest_s = std::max(longest_s, gap.length_s);
    note += "; " + count_of(log.gaps.size(), "gap", "gaps") + ", the longest of " +
            format("%.3g s", longest_s) + ", which no average spans.";
  }
  report.notes.push_back(note);
}

std::vector<sim::Stretch> rest_of(const ImuLog& log, RestChoice choice, AllanReport& report) {
  const std::vector<sim::Stretch> parts = log.without_gaps();
  if (choice == RestChoice::none) {
    report.notes.push_back("All of the log was taken as rest (--rest none).");
    return parts;
  }
  const sim::Rest rest = sim::find_rest(log.samples, parts, log.rate_hz);
  const std::string limits = format("%.3g rad/s and ", rest.gyro_limit_rad_s) +
                             format("%.3g m/s2", rest.accelerometer_limit_m_s2);
  if (rest.stretches.empty()) {
    throw InputError(log.source +
                     ": no two seconds at rest (standard deviation in a second, all "
                     "axes together, within " +
                     limits +
                     "); an Allan analysis needs a unit at rest, or --rest none for a unit that "
                     "is known to be");
  }
  const sim::Stretch longest = rest.stretches[rest.longest()];
  const auto seconds = [&](const sim::Stretch& stretch) {
    return static_cast<double>(stretch.size()) / log.rate_hz;
  };
  std::string note =
      "At rest for " + format("%.1f s in ", static_cast<double>(rest.samples()) / log.rate_hz) +
      count_of(rest.stretches.size(), "stretch", "stretches") + ", the longest " +
      format("%.1f s", seconds(longest)) + " from " +
      format("%.1f s", to_seconds(log.samples[longest.begin].time - log.samples.front().time)) +
      " on; rest: standard deviation in a second, all axes together, within " + limits + ".";
  report.notes.push_back(note);
  if (choice == RestChoice::longest) return {longest};
  return rest.stretches;
}

void describe_reach(AllanReport& report) {
  const double reach_s = report.curves.gyro[0].back().tau_s;
  report.notes.push_back("Averaging times reach " + format("%.3g s", reach_s) +
                         ", a third of the longest stretch.");
  double astray = 0.0;
  bool of_family = true;
  std::string unseen;
  const auto collect = [&](const sim::AllanTriadFit& triad, const AllanUnits& units,
                           const std::string& sensor) {
    for (const sim::AllanFit& axis : triad.axes) {
      astray = std::max(astray, axis.model_error);
      of_family = of_family && axis.is_of_family();
    }
    for (std::size_t term = 0; term < sim::kAllanTerms; ++term) {
      const auto seen = std::ranges::count_if(
          triad.axes, [&](const sim::AllanFit& axis) { return axis.coefficients[term].seen; });
      if (seen == 3) continue;
      unseen += (unseen.empty() ? "" : ", ") + sensor + " " + std::string(units[term].symbol);
    }
  };
  collect(report.fit.gyro, gyro_allan_units(), "gyro");
  collect(report.fit.accelerometer, accelerometer_allan_units(), "accelerometer");
  if (!of_family) {
    report.notes.push_back(
        format("Curves stray from those of sensor noise by up to %.0f %%: ", 100.0 * astray) +
        "the unit was shaken (an idling engine will do), and shaking only adds; "
        "what is measured there bounds the sensor's own.");
  }
  if (!unseen.empty()) {
    report.notes.push_back("Not seen on every axis, given as bounds of 95 %: " + unseen + ".");
  }
}

void rank_presets(AllanReport& report) {
  for (const NamedImu& imu : builtin_imus()) {
    report.nearest.push_back(
        {.preset = imu.name, .distance = distance(report.fit, sim::specified_allan(imu.spec))});
  }
  std::ranges::stable_sort(report.nearest, {}, [](const AllanReport::Ranked& ranked) {
    return ranked.distance.mean_log10_ratio;
  });
}

}  // namespace

AllanReport analyse_log(const ImuLog& log, RestChoice rest) {
  AllanReport report;
  report.source = log.source;
  report.rate_hz = log.rate_hz;
  describe_intervals(log, report);
  const std::vector<sim::Stretch> stretches = rest_of(log, rest, report);
  for (const sim::Stretch& stretch : stretches) {
    const double length_s = static_cast<double>(stretch.size()) / log.rate_hz;
    report.used_s += length_s;
    report.longest_s = std::max(report.longest_s, length_s);
  }
  report.curves = sim::measure_allan(log.samples, stretches, log.rate_hz);
  try {
    report.fit = sim::fit_imu_allan(report.curves);
  } catch (const InputError& error) {
    throw InputError(log.source + ": " + error.what());
  }
  describe_reach(report);
  rank_presets(report);
  return report;
}

AllanReport analyse_imu(const NamedImu& imu, double hours, std::uint64_t seed, int seeds) {
  if (!(hours > 0.0) || seeds < 1) {
    throw InputError("Allan analysis of " + imu.name + ": needs some time and at least one seed");
  }
  AllanReport report;
  report.source = imu.name;
  report.rate_hz = imu.spec.rate_hz;
  std::vector<sim::ImuAllanCurves> recordings;
  for (int i = 0; i < seeds; ++i) {
    const std::vector<ImuSample> samples =
        sim::simulate_at_rest(imu.spec, seed + static_cast<std::uint64_t>(i), 3600.0 * hours);
    const sim::Stretch all{.begin = 0, .end = samples.size()};
    report.longest_s = static_cast<double>(samples.size()) / imu.spec.rate_hz;
    report.used_s += report.longest_s;
    recordings.push_back(sim::measure_allan(samples, {&all, 1}, imu.spec.rate_hz));
  }
  report.curves = sim::pool_recordings(recordings);
  report.specified_name = imu.name;
  report.specified = sim::specified_allan(imu.spec);
  try {
    report.fit = sim::fit_imu_allan(report.curves, *report.specified);
  } catch (const InputError& error) {
    throw InputError("Allan analysis of " + imu.name + ": " + error.what());
  }
  report.notes.push_back(
      format("Simulated at rest, %g h", hours) + format(" at %g Hz, ", imu.spec.rate_hz) +
      count_of(static_cast<std::size_t>(seeds), "seed from ", "seeds from ") +
      std::to_string(seed) + " on; fitted with the terms that the specification has.");
  return report;
}

const AllanUnits& gyro_allan_units() {
  using namespace sim::imu_unit;
  constexpr double kArcsecond = kDeg_s / 3600.0;
  static const AllanUnits units = {
      {{"Q", "quantisation", "rad", "arcsec", kArcsecond},
       {"N", "angle random walk", "rad/s/sqrt(Hz)", "deg/sqrt(h)", kDeg_sqrth},
       {"B", "bias instability", "rad/s", "deg/h", kDeg_h},
       {"K", "rate random walk", "rad/s/sqrt(s)", "deg/h/sqrt(h)", kDeg_h_sqrth}}};
  return units;
}

const AllanUnits& accelerometer_allan_units() {
  using namespace sim::imu_unit;
  static const AllanUnits units = {
      {{"Q", "quantisation", "m/s", "mm/s", 1e-3},
       {"N", "velocity random walk", "m/s2/sqrt(Hz)", "m/s/sqrt(h)", kM_s_sqrth},
       {"B", "bias instability", "m/s2", "ug", kMicro_g},
       {"K", "acceleration random walk", "m/s2/sqrt(s)", "m/s2/sqrt(h)", kM_s2_sqrth}}};
  return units;
}

std::string coefficient_text(const sim::AllanCoefficient& coefficient, double unit) {
  const auto text = [](double value, const char* pattern) {
    return format(std::abs(value) >= 1000.0 && std::abs(value) < 1e7 ? "%.0f" : pattern, value);
  };
  const double sigma = coefficient.sigma / unit;
  if (coefficient.seen) {
    return text(coefficient.value / unit, "%.4g") + " ± " +
           text(sigma, sigma < 10.0 ? "%.1g" : "%.3g");
  }
  if (std::isfinite(coefficient.upper_bound)) {
    return "< " + text(coefficient.upper_bound / unit, "%.3g");
  }
  return "-";
}

}  // namespace locsim::scenarios
