#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/progress.h"
#include "render/sky_plot.h"
#include "scenarios/scenario.h"
#include "scenarios/sky_report.h"
#include "scenarios/stage.h"

namespace locsim::apps {

namespace {

using scenarios::SkyCells;
using scenarios::SkyCover;
using scenarios::SkyReport;
using scenarios::SkySatellite;
using scenarios::SkyStatus;

constexpr double kDegree = std::numbers::pi / 180.0;

struct SkyArguments {
  std::string scenario;
  double at_s = 0.0;
  std::string out;
  std::string seed;
  std::vector<std::string> settings;
  bool quiet = false;
};

std::string counts_text(const SkyReport& report) {
  std::string text = std::to_string(report.satellites.size()) + " satellites";
  const char* separator = ": ";
  for (const SkyStatus status : scenarios::kSkyStatuses) {
    if (report.count(status) == 0) continue;
    text += separator + std::to_string(report.count(status)) + " " + sky_status_text(status);
    separator = ", ";
  }
  return text;
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", seconds);
  return text;
}

render::SkyPlot sky_plot(const SkyReport& report, const std::string& name, double at_s) {
  render::SkyPlot plot;
  plot.title = name + ", " + seconds_text(at_s) + " s";
  char sky[96];
  std::snprintf(sky, sizeof sky, "    sky %.0f %% clear, %.0f %% behind leaves",
                100.0 * report.cells.share(SkyCover::clear),
                100.0 * report.cells.share(SkyCover::foliage));
  plot.subtitle = {scenarios::utc_text(report.place.gps_time) + sky, counts_text(report)};
  plot.covers = {{.name = "clear", .color = {232, 240, 248}},
                 {.name = "leaves", .color = {176, 208, 160}},
                 {.name = "blocked", .color = {88, 95, 106}}};
  for (const SkyCover cover : report.cells.cells()) {
    plot.cells.push_back(static_cast<std::uint8_t>(cover));
  }
  plot.cover_azimuths = SkyCells::kAzimuths;
  plot.styles.resize(scenarios::kSkyStatuses.size());
  const auto style = [&](SkyStatus status, render::Color color, bool hollow = false) {
    plot.styles[static_cast<std::size_t>(status)] = {
        .name = sky_status_text(status), .color = color, .hollow = hollow};
  };
  style(SkyStatus::direct, render::palette::blue);
  style(SkyStatus::foliage, {22, 120, 60});
  style(SkyStatus::diffracted, {236, 160, 0});
  style(SkyStatus::reflected, {206, 30, 50});
  style(SkyStatus::scattered, {140, 70, 160});
  style(SkyStatus::blocked, render::palette::ink_soft, true);
  for (const SkySatellite& satellite : report.satellites) {
    plot.marks.push_back({.azimuth_rad = satellite.azimuth_rad,
                          .elevation_rad = satellite.elevation_rad,
                          .style = static_cast<std::size_t>(satellite.status),
                          .label = satellite.id.name(),
                          .strength_db_hz = satellite.cn0_db_hz});
  }
  plot.heading_rad = report.heading_rad;
  return plot;
}

void print_satellites(const SkyReport& report) {
  std::printf("\n%-9s %8s %10s   %-14s %7s %11s %13s %13s %13s  %s\n", "satellite", "azimuth",
              "elevation", "signal", "C/N0", "reflections", "strongest's", "strongest's",
              "strongest's", "strongest's");
  std::printf("%-9s %8s %10s   %-14s %7s %11s %13s %13s %13s  %s\n", "", "[deg]", "[deg]", "",
              "[dB-Hz]", "", "excess [m]", "power [dB]", "grazing [deg]", "surface");
  for (const SkySatellite& satellite : report.satellites) {
    std::printf("%-9s %8.1f %10.1f   %-14s", satellite.id.name().c_str(),
                satellite.azimuth_rad / kDegree, satellite.elevation_rad / kDegree,
                sky_status_text(satellite.status).c_str());
    if (satellite.cn0_db_hz) {
      std::printf(" %7.1f", *satellite.cn0_db_hz);
    } else {
      std::printf(" %7s", "-");
    }
    std::printf(" %11d", satellite.reflections);
    if (satellite.strongest) {
      const SkySatellite::Reflection& strongest = *satellite.strongest;
      std::printf(" %13.2f %13.1f %13.1f  %s\n", strongest.excess_m, strongest.power_db,
                  strongest.grazing_rad / kDegree, strongest.material.c_str());
    } else {
      std::printf(" %13s %13s %13s  -\n", "-", "-", "-");
    }
  }
}

void print_sectors(const SkyReport& report) {
  constexpr std::size_t kSectors = 12;
  constexpr std::size_t kDegrees = 360 / kSectors;
  constexpr std::size_t kCells = SkyCells::kAzimuths / kSectors;
  const std::vector<double> mask_rad = report.cells.mask_rad();
  const auto print = [](const char* name, const auto& value_of) {
    std::printf("%-26s", name);
    for (std::size_t k = 0; k < kSectors; ++k) std::printf(" %7s", value_of(k).c_str());
    std::printf("\n");
  };
  const auto whole = [](double value) { return std::to_string(std::lround(value)); };
  std::printf("\n");
  print("azimuth [deg]", [&](std::size_t k) {
    return std::to_string(k * kDegrees) + "-" + std::to_string((k + 1) * kDegrees);
  });
  print("highest blocked [deg]", [&](std::size_t k) {
    const auto first = mask_rad.begin() + static_cast<std::ptrdiff_t>(k * kDegrees);
    return whole(*std::max_element(first, first + kDegrees) / kDegree);
  });
  print("clear [% of solid angle]", [&](std::size_t k) {
    return whole(100.0 * report.cells.share(SkyCover::clear, k * kCells, (k + 1) * kCells));
  });
  print("leaves [% of solid angle]", [&](std::size_t k) {
    return whole(100.0 * report.cells.share(SkyCover::foliage, k * kCells, (k + 1) * kCells));
  });
}

int sky(const SkyArguments& arguments) {
  std::vector<std::string> overrides = arguments.settings;
  if (!arguments.seed.empty()) overrides.push_back("seed=" + arguments.seed);
  const scenarios::Scenario scenario = scenarios::load_scenario(arguments.scenario, overrides);
  Progress progress(arguments.quiet);
  progress.begin("building the world");
  const scenarios::Stage stage = scenarios::build_stage(scenario);
  progress.begin("looking at the sky");
  const SkyReport report = scenarios::sky_report(scenario, stage, arguments.at_s);
  const std::filesystem::path out =
      arguments.out.empty() ? "sky_" + scenario.name + "_" + seconds_text(arguments.at_s) + "s.png"
                            : arguments.out;
  render::write_png(draw_sky(sky_plot(report, scenario.name, arguments.at_s)), out);
  progress.end();

  std::printf("%s at %s s, %s, heading %.0f deg\n", scenario.name.c_str(),
              seconds_text(arguments.at_s).c_str(),
              scenarios::utc_text(report.place.gps_time).c_str(), report.heading_rad / kDegree);
  std::printf("%s\n", counts_text(report).c_str());
  print_satellites(report);
  print_sectors(report);
  std::printf("\n%s\n", out.string().c_str());
  return kAllMet;
}

}  // namespace

void add_sky_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<SkyArguments>();
  CLI::App* command = app.add_subcommand(
      "sky", "Sky plot: what blocks the antenna's view, and how each satellite's signal arrives");
  command->add_option("scenario", arguments->scenario, "Scenario file (YAML)")->required();
  command
      ->add_option("--at", arguments->at_s,
                   "Time since the start of the drive, kept to its schedule [s]")
      ->capture_default_str();
  command->add_option("--out", arguments->out, "Picture [sky_<name>_<time>s.png]");
  command->add_option("--seed", arguments->seed, "Seed of the traffic, instead of the scenario's");
  command
      ->add_option("--set", arguments->settings,
                   "key.path=value, as if the scenario file said so; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &action] { action = [arguments] { return sky(*arguments); }; });
}

}  // namespace locsim::apps
