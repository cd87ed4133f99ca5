#include "benchmarks/fidelity/gnss_tables.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "benchmarks/fidelity/gnss_reference.h"
#include "benchmarks/fidelity/plots.h"

namespace locsim::fidelity {

namespace {

constexpr std::array<const char*, kCn0Classes> kClassNames = {"<20",   "20–25", "25–30",
                                                              "30–35", "35–40", "≥40"};

template <typename... Values>
std::string line(const char* format, Values... values) {
  std::array<char, 320> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return std::string(text.data()) + "\n";
}

/// A dash where nothing is known.
std::string text_of(double value, const char* format = "%.1f", double scale = 1.0) {
  if (std::isnan(value)) return "–";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, scale * value);
  return text.data();
}

std::string both(double ours, double real, const char* format = "%.1f", double scale = 1.0) {
  return text_of(ours, format, scale) + " / " + text_of(real, format, scale);
}

std::string row(std::initializer_list<std::string> cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

std::string head(std::initializer_list<std::string> cells) {
  std::string text = row(cells) + "|";
  for (std::size_t i = 0; i < cells.size(); ++i) text += "---|";
  return text + "\n";
}

std::string class_table(const GnssFigures& ours) {
  const RealCanyon& real = urbannav_hk();
  std::string text =
      "Pseudorange error by C/N0, ours / real (UrbanNav-HK, measured)\n\n" +
      head({"C/N0 [dB-Hz]", "observations", "direct", "median [m]", "p75 [m]", "p95 [m]",
            "> 15 m [%]", "> 50 m [%]", "range rate p95, at rest [m/s]", "moving [m/s]"});
  for (std::size_t i = 0; i < kCn0Classes; ++i) {
    const Cn0Class& o = ours.classes[i];
    const Cn0Class& r = real.classes[i];
    text += row({kClassNames[i],
                 std::to_string(o.count) + " (" + text_of(o.share, "%.0f %%", 100) + ")",
                 text_of(o.direct_share, "%.0f %%", 100), both(o.median_m, r.median_m),
                 both(o.p75_m, r.p75_m), both(o.p95_m, r.p95_m),
                 both(o.beyond_15_m, r.beyond_15_m, "%.0f", 100),
                 both(o.beyond_50_m, r.beyond_50_m, "%.0f", 100),
                 both(o.rate_static_m_s, r.rate_static_m_s, "%.2f"),
                 both(o.rate_moving_m_s, r.rate_moving_m_s, "%.2f")});
  }
  return text;
}

std::string verdict_line(const char* name, const Verdict& verdict) {
  return line("%s: within 1.5 in %d of 6 classes, within 2 in %d of 6; asked for 4 and 6: %s", name,
              verdict.within_1_5, verdict.within_2, verdict.is_met() ? "met" : "not met");
}

std::string factor_table(const GnssFigures& ours) {
  const auto factors = class_factors(urbannav_hk().classes, ours.classes);
  std::string text =
      "\nFactor between ours and the real figure (metres below 1 m and shares below "
      "1 % count as these; medians where the real one is above 2 m)\n\n" +
      head({"C/N0 [dB-Hz]", "median", "p75", "p95", "> 15 m", "> 50 m", "greatest",
            "geometric mean"});
  for (std::size_t i = 0; i < kCn0Classes; ++i) {
    const ClassFactors& f = factors[i];
    text +=
        row({kClassNames[i], text_of(f.median, "%.2f"), text_of(f.p75, "%.2f"),
             text_of(f.p95, "%.2f"), text_of(f.beyond_15_m, "%.2f"), text_of(f.beyond_50_m, "%.2f"),
             text_of(f.worst, "%.2f"), text_of(f.typical, "%.2f")});
  }
  return text + "\n" +
         verdict_line("Greatest factor of each class", verdict(factors, &ClassFactors::worst)) +
         "\n" +
         verdict_line("Geometric mean of each class", verdict(factors, &ClassFactors::typical));
}

std::string tracking_table(const GnssFigures& ours) {
  const RealCanyon& real = urbannav_hk();
  std::string text = "\n" + head({"", "ours", "real"});
  for (std::size_t i = 0; i < kCn0Levels.size(); ++i) {
    text += row({"C/N0, " + text_of(kCn0Levels[i], "%.0f", 100) + " % [dB-Hz]",
                 text_of(ours.cn0_db_hz[i]), text_of(real.cn0_db_hz[i], "%.0f")});
  }
  const auto range = [](const std::array<double, 2>& r, const char* format) {
    return text_of(r[0], format) + "–" + text_of(r[1], format);
  };
  text += row({"satellites tracked an epoch", text_of(ours.satellites_tracked),
               text_of(real.satellites_tracked)});
  text += row({"satellites above the horizon", text_of(ours.satellites_above_horizon), "–"});
  text += row({"gaps of one satellite, p50 [s]", text_of(ours.gap_p50_s), text_of(real.gap_p50_s)});
  text += row({"p90 [s]", text_of(ours.gap_p90_s), text_of(real.gap_p90_s)});
  text += row({"greatest [s]", text_of(ours.gap_max_s), text_of(real.gap_max_s)});
  text += row({"longest without a fix [s]", text_of(ours.longest_without_fix_s),
               range(real.longest_without_fix_s, "%.0f")});
  return text + row({"mean e²/σ² in 2D", text_of(ours.overconfidence),
                     range(real.overconfidence, "%.1f")});
}

std::string solution_row(const std::string& name, double availability, const ErrorFigures& e) {
  return row({name, text_of(availability, "%.0f", 100), text_of(e.mean), text_of(e.deviation),
              text_of(e.rms), text_of(e.p50), text_of(e.p95), text_of(e.max)});
}

std::string solution_table(const GnssFigures& ours) {
  std::string text = "\n" + head({"2D position", "available [%]", "mean [m]", "std [m]", "RMS [m]",
                                  "p50 [m]", "p95 [m]", "max [m]"});
  text += solution_row("ours, the receiver's fix", ours.availability, ours.horizontal_m);
  for (const RealSolution& real : urbannav_hk_solutions()) {
    text += solution_row("real, " + std::string(real.name), real.availability, real.horizontal_m);
  }
  return text;
}

/// Over the classes' middles, 17.5, 22.5 … 42.5 dB-Hz.
Plot class_plot(const GnssFigures& ours, const char* title, const char* y_label,
                const render::Scale& y, double Cn0Class::*value, double scale) {
  Plot plot{.panel = {.title = title, .y_label = y_label, .y = y},
            .x_label = "C/N0 [dB-Hz]",
            .x = {15.0, 45.0, false}};
  const auto add = [&](const char* name, const auto& classes, render::Color color) {
    render::ChartSeries series{.name = name, .color = color};
    for (std::size_t i = 0; i < kCn0Classes; ++i) {
      series.time_s.push_back(17.5 + 5.0 * static_cast<double>(i));
      series.values.push_back(scale * classes[i].*value);
    }
    plot.panel.series.push_back(std::move(series));
  };
  add("real", urbannav_hk().classes, kRealColor);
  add("simulated", ours.classes, kSimulatedColor);
  return plot;
}

}  // namespace

std::string canyon_tables(const GnssFigures& ours) {
  return class_table(ours) + factor_table(ours) + tracking_table(ours) + solution_table(ours);
}

std::string open_sky_table(const GnssFigures& ours, const std::string& preset) {
  DataSheet sheet{.velocity_m_s = kNoFigure};
  for (const DataSheet& known : data_sheets()) {
    if (known.preset == preset) sheet = known;
  }
  const ErrorFigures& e = ours.horizontal_m;
  return head({"open sky, " + preset, "ours", "data sheet"}) +
         row({"horizontal error, 50 % (CEP) [m]", text_of(e.p50, "%.2f"), text_of(sheet.cep_m)}) +
         row({"95 % [m]", text_of(e.p95, "%.2f"), "–"}) +
         row({"vertical error, 50 % [m]", text_of(ours.vertical_m.p50, "%.2f"), "–"}) +
         row({"horizontal velocity error, 50 % [m/s]",
              text_of(ours.horizontal_velocity_m_s.p50, "%.3f"),
              text_of(sheet.velocity_m_s, "%.2f")}) +
         row({"available [%]", text_of(ours.availability, "%.1f", 100), "–"}) +
         row({"satellites tracked", text_of(ours.satellites_tracked), "–"}) +
         row({"C/N0, 50 % [dB-Hz]", text_of(ours.cn0_db_hz[2]), "–"}) +
         row({"mean e²/σ² in 2D", text_of(ours.overconfidence, "%.2f"), "–"});
}

std::string tunnel_table(std::span<const TunnelFigures> tunnels) {
  std::string text = head({"tunnel, drive", "epochs inside", "fixes inside",
                           "from the exit to a fix [s]", "its 2D error [m]"});
  for (std::size_t i = 0; i < tunnels.size(); ++i) {
    const TunnelFigures& t = tunnels[i];
    text += row({std::to_string(i + 1), std::to_string(t.epochs_inside),
                 std::to_string(t.fixes_inside), text_of(t.until_fix_s), text_of(t.first_error_m)});
  }
  return text;
}

std::string observations_csv(std::span<const GnssDrive> drives) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  std::string text =
      "drive,t_s,s_m,speed_m_s,satellite,elevation_deg,direct,paths,turns,excess_m,power_db,cn0_db_"
      "hz,code_error_m,"
      "range_rate_error_m_s\n";
  for (std::size_t i = 0; i < drives.size(); ++i) {
    for (const EpochRecord& e : drives[i].epochs) {
      for (const SatelliteRecord& s : e.satellites) {
        if (!s.is_tracked) continue;
        text += line("%zu,%.3f,%.1f,%.2f,%s,%.1f,%d,%zu,%d,%.1f,%.1f,%.2f,%.3f,%.4f", i,
                     to_seconds(e.time), e.s_m, e.speed_m_s, s.id.name().c_str(),
                     s.elevation_rad / kDegree, s.is_direct ? 1 : 0, s.paths, s.turns, s.excess_m,
                     s.power_db, s.cn0_db_hz, s.code_error_m, s.range_rate_error_m_s);
      }
    }
  }
  return text;
}

std::string fixes_csv(std::span<const GnssDrive> drives) {
  std::string text =
      "drive,t_s,s_m,speed_m_s,fix,east_error_m,north_error_m,up_error_m,sigma_2d_m,"
      "velocity_error_m_s\n";
  for (std::size_t i = 0; i < drives.size(); ++i) {
    for (const EpochRecord& e : drives[i].epochs) {
      const FixRecord fix = e.fix.value_or(FixRecord{});
      text += line("%zu,%.3f,%.1f,%.2f,%d,%.3f,%.3f,%.3f,%.3f,%.4f", i, to_seconds(e.time), e.s_m,
                   e.speed_m_s, e.fix ? 1 : 0, fix.error_m.x(), fix.error_m.y(), fix.error_m.z(),
                   std::sqrt(fix.covariance_m2.topLeftCorner<2, 2>().trace()),
                   fix.velocity_error_m_s.head<2>().norm());
    }
  }
  return text;
}

render::Image draw_canyon(const GnssFigures& ours) {
  const std::array<Plot, 6> plots = {
      class_plot(ours, "pseudorange error, median", "error [m]", {-5.0, 60.0, false},
                 &Cn0Class::median_m, 1.0),
      class_plot(ours, "pseudorange error, 75 %", "error [m]", {-5.0, 100.0, false},
                 &Cn0Class::p75_m, 1.0),
      class_plot(ours, "pseudorange error, 95 %", "error [m]", {0.0, 150.0, false},
                 &Cn0Class::p95_m, 1.0),
      class_plot(ours, "errors beyond 15 m", "% of observations", {0.0, 100.0, false},
                 &Cn0Class::beyond_15_m, 100.0),
      class_plot(ours, "errors beyond 50 m", "% of observations", {0.0, 60.0, false},
                 &Cn0Class::beyond_50_m, 100.0),
      class_plot(ours, "range rate error under way, 95 %", "error [m/s]", {0.0, 16.0, false},
                 &Cn0Class::rate_moving_m_s, 1.0)};
  return draw_plots(plots, 2, "GNSS in a street canyon: UrbanNav-HK and simulated", 1350);
}

}  // namespace locsim::fidelity
