#include "benchmarks/fidelity/figures_text.h"

#include <array>
#include <cstdio>
#include <numbers>
#include <string_view>

namespace locsim::fidelity {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

template <typename... Values>
std::string line(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return std::string(text.data()) + "\n";
}

std::string summary(const StreetFigures& real, const StreetFigures& simulated) {
  std::string text = line("%-44s %10s %10s", "", "real", "simulated");
  const auto row = [&](const char* name, auto value) {
    text += line("%-44s %10.4f %10.4f", name, value(real), value(simulated));
  };
  row("returns per scan", [](const StreetFigures& f) { return f.statistics.points_per_scan; });
  row("firings per laser and turn",
      [](const StreetFigures& f) { return f.statistics.fired_per_turn; });
  row("share of rays that return",
      [](const StreetFigures& f) { return f.statistics.overall_share(); });
  row("range, median [m]",
      [](const StreetFigures& f) { return f.statistics.range_m.quantile(0.5); });
  row("range, 95 % [m]",
      [](const StreetFigures& f) { return f.statistics.range_m.quantile(0.95); });
  row("intensity, median",
      [](const StreetFigures& f) { return f.statistics.intensity.quantile(0.5); });
  constexpr std::array<double, 6> kHeights_m = {0.2, 0.5, 1.0, 2.0, 4.0, 15.0};
  double from_m = -1.0;
  for (const double to_m : kHeights_m) {
    const std::string name = from_m < 0.0
                                 ? "share lower than 0.2 m above ground"
                                 : line("share from %.1f to %.1f m above ground", from_m, to_m);
    row(name.substr(0, name.find('\n')).c_str(), [&](const StreetFigures& f) {
      return f.statistics.height_m.below(to_m) - f.statistics.height_m.below(from_m);
    });
    from_m = to_m;
  }
  row("noise about planes, robust [m]",
      [](const StreetFigures& f) { return f.plane_noise.robust_m; });
  row("noise about the own laser's returns [m]",
      [](const StreetFigures& f) { return f.laser_noise.robust_m; });
  row("bias of lasers, standard deviation [m]",
      [](const StreetFigures& f) { return f.beam_bias_m(); });
  text += line("%-44s %10.4f", "distance of the range histograms (0 alike, 1)",
               distance(real.statistics.range_m, simulated.statistics.range_m));
  text += line("%-44s %10.4f", "distance of the intensity histograms",
               distance(real.statistics.intensity, simulated.statistics.intensity));
  return text;
}

std::string by_laser(const StreetFigures& real, const StreetFigures& simulated) {
  std::string text = line(
      "\nlaser  elevation[deg]    share         plane noise[m]  own noise[m]"
      "    bias[m]           ground seen to[m]");
  for (std::size_t k = kLasers; k-- > 0;) {
    const auto noise = [&](const StreetFigures& f) { return f.plane_noise_by_laser[k].robust_m; };
    const auto own = [&](const StreetFigures& f) { return f.laser_noise_by_laser[k].robust_m; };
    text +=
        line("%3zu  %8.3f %8.3f  %.3f %.3f  %.4f %.4f  %.4f %.4f  %+.4f %+.4f  %5.1f %5.1f", k,
             real.statistics.beams[k].elevation_rad / kDegree,
             simulated.statistics.beams[k].elevation_rad / kDegree, real.statistics.return_share[k],
             simulated.statistics.return_share[k], noise(real), noise(simulated), own(real),
             own(simulated), real.bias_by_laser[k].median_m, simulated.bias_by_laser[k].median_m,
             real.ground_end_m[k], simulated.ground_end_m[k]);
  }
  return text;
}

std::string noise_classes(const char* title, const std::vector<NoiseClass>& classes) {
  std::string text = line("\n%s", title);
  for (const NoiseClass& c : classes) {
    text += line("%6.2f to %6.2f  planes %.4f (%zu)  own laser %.4f (%zu)", c.from, c.to,
                 c.planes.robust_m, c.planes.count, c.laser.robust_m, c.laser.count);
  }
  return text;
}

std::string reflections(const char* title, const std::vector<Reflection>& classes) {
  std::string text = line("\n%s", title);
  for (const Reflection& r : classes) {
    text +=
        line("%6.2f to %6.2f  rays %7zu  seen %.3f  cosine %.3f  intensity %.3f  zero %.3f", r.from,
             r.to, r.rays, r.seen_share, r.median_cosine, r.median_intensity, r.zero_share);
  }
  return text;
}

}  // namespace

std::string figures_text(const StreetFigures& real, const StreetFigures& simulated) {
  std::string text = summary(real, simulated) + by_laser(real, simulated);
  text += noise_classes("noise by range [m], real", real.noise_by_range);
  text += noise_classes("noise by range [m], simulated", simulated.noise_by_range);
  text += noise_classes("noise by cosine of incidence, real", real.noise_by_cosine);
  text += noise_classes("noise by cosine of incidence, simulated", simulated.noise_by_cosine);
  text += reflections("ground by range [m], real", real.ground_by_range);
  text += reflections("ground by range [m], simulated", simulated.ground_by_range);
  text += reflections("facades 20 to 25 m away by cosine, real", real.facade_by_cosine);
  text += reflections("facades 20 to 25 m away by cosine, simulated", simulated.facade_by_cosine);
  text += reflections("facades by range [m], real", real.facade_by_range);
  text += reflections("facades by range [m], simulated", simulated.facade_by_range);
  return text;
}

}  // namespace locsim::fidelity
