#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/allan_pictures.h"
#include "apps/commands.h"
#include "apps/progress.h"
#include "core/error.h"
#include "scenarios/allan_files.h"
#include "scenarios/allan_report.h"
#include "scenarios/text_io.h"

namespace locsim::apps {

namespace fs = std::filesystem;

namespace {

using scenarios::AllanReport;
using scenarios::AllanUnits;
using scenarios::RestChoice;

/// Stands for every preset there is.
constexpr const char* kAll = "all";

struct AllanArguments {
  std::string log;
  std::string preset;
  std::string compare;
  std::string rest = "auto";
  std::string out;
  double hours = 1.0;
  std::uint64_t seed = 1;
  int seeds = 1;
  bool quiet = false;
};

/// printf's widths count bytes; "±" has two.
void print_cell(const std::string& text) {
  const bool wider = text.find("±") != std::string::npos;
  std::printf(" %*s", wider ? 21 : 20, text.c_str());
}

void print_row(const sim::AllanTriadFit& fit, std::size_t term, double unit, std::string_view name,
               std::string_view unit_name, const sim::AllanModel* specified) {
  std::printf("%-28.*s", static_cast<int>(name.size()), name.data());
  for (const sim::AllanFit& axis : fit.axes) {
    print_cell(scenarios::coefficient_text(axis.coefficients[term], unit));
  }
  print_cell(scenarios::coefficient_text(fit.together.coefficients[term], unit));
  if (specified != nullptr) {
    std::printf(" %12.4g", specified->coefficient(static_cast<sim::AllanTerm>(term)) / unit);
  }
  std::printf("  %.*s\n", static_cast<int>(unit_name.size()), unit_name.data());
}

void print_triad(const char* sensor, const sim::AllanTriadFit& fit, const AllanUnits& units,
                 const sim::AllanModel* specified) {
  std::printf("\n%-28s %20s %20s %20s %20s", sensor, "x", "y", "z", "together");
  std::printf(specified != nullptr ? " %12s\n" : "%s\n", specified != nullptr ? "specified" : "");
  for (std::size_t term = 0; term < sim::kAllanTerms; ++term) {
    const scenarios::AllanUnit& unit = units[term];
    print_row(fit, term, unit.factor, std::string(unit.symbol) + "  " + std::string(unit.name),
              unit.data_sheet, specified);
    print_row(fit, term, 1.0, "", unit.si, specified);
  }
  const double unit = units[static_cast<std::size_t>(sim::AllanTerm::flicker)].factor;
  std::printf("%-28s", "lowest point / 0.664");
  const auto lowest = [&](const sim::AllanFit& axis) {
    char text[48];
    std::snprintf(text, sizeof text, "%.4g at %.3g s", axis.minimum_bias_instability() / unit,
                  axis.minimum_tau_s);
    print_cell(text);
  };
  for (const sim::AllanFit& axis : fit.axes) lowest(axis);
  lowest(fit.together);
  if (specified != nullptr) std::printf(" %12s", "");
  std::printf("  %s\n", units[static_cast<std::size_t>(sim::AllanTerm::flicker)].data_sheet.data());
}

std::string distance_text(const sim::ImuDistance& distance) {
  if (!std::isfinite(distance.mean_log10_ratio)) return "nothing to compare";
  char text[96];
  std::snprintf(text, sizeof text, "a factor of %.2f over %d coefficients seen and %d bounds",
                std::pow(10.0, distance.mean_log10_ratio), distance.seen, distance.by_bound);
  return text;
}

void print_ranking(const AllanReport& report) {
  std::printf("\nnearest presets (mean |log10 ratio| over N, B, K of gyros and accelerometers)\n");
  for (const AllanReport::Ranked& ranked : report.nearest) {
    std::printf("  %-14s %6.3f   %s\n", ranked.preset.c_str(), ranked.distance.mean_log10_ratio,
                distance_text(ranked.distance).c_str());
  }
}

void print_report(const AllanReport& report) {
  std::printf("%s\n", report.source.c_str());
  for (const std::string& note : report.notes) std::printf("  %s\n", note.c_str());
  const sim::ImuAllanModel* specified = report.specified ? &*report.specified : nullptr;
  print_triad("gyro", report.fit.gyro, scenarios::gyro_allan_units(),
              specified != nullptr ? &specified->gyro : nullptr);
  print_triad("accelerometer", report.fit.accelerometer, scenarios::accelerometer_allan_units(),
              specified != nullptr ? &specified->accelerometer : nullptr);
  if (report.specified && report.specified_name != report.source) {
    std::printf("\nbeside %s: %s\n", report.specified_name.c_str(),
                distance_text(sim::distance(report.fit, *report.specified)).c_str());
  }
  if (!report.nearest.empty()) print_ranking(report);
}

/// Made before anything is computed, so that hours of noise are not thrown away.
void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw InputError(folder.string() + ": cannot be made; name another folder with --out");
  }
}

void write_report(const AllanReport& report, const fs::path& folder) {
  make_folder(folder);
  scenarios::write_text_file(folder / "allan.json", scenarios::allan_json(report));
  scenarios::write_text_file(folder / "allan.csv", scenarios::allan_csv(report));
  render::write_png(draw_allan_report(report), folder / "allan.png");
  std::printf("\n%s\n", (folder / "allan.png").string().c_str());
}

AllanReport simulate(const AllanArguments& arguments, const scenarios::NamedImu& imu,
                     Progress& progress) {
  progress.begin("simulating " + imu.name);
  AllanReport report =
      scenarios::analyse_imu(imu, arguments.hours, arguments.seed, arguments.seeds);
  progress.end();
  return report;
}

int simulate_all(const AllanArguments& arguments, Progress& progress) {
  std::vector<AllanReport> reports;
  for (const scenarios::NamedImu& imu : scenarios::builtin_imus()) {
    reports.push_back(simulate(arguments, imu, progress));
    print_report(reports.back());
    std::printf("\n");
    if (!arguments.out.empty()) write_report(reports.back(), fs::path(arguments.out) / imu.name);
  }
  if (!arguments.out.empty()) {
    const fs::path sheet = fs::path(arguments.out) / "allan.png";
    render::write_png(draw_allan_sheet(reports), sheet);
    std::printf("%s\n", sheet.string().c_str());
  }
  return kAllMet;
}

RestChoice rest_choice(const std::string& name) {
  if (name == "none") return RestChoice::none;
  return name == "longest" ? RestChoice::longest : RestChoice::pooled;
}

int allan(const AllanArguments& arguments) {
  if (arguments.log.empty() == arguments.preset.empty()) {
    throw InputError("locsim allan needs either a log or --preset, one of the two");
  }
  if (!arguments.preset.empty() && !arguments.compare.empty()) {
    throw InputError("--compare goes with a log; a preset is compared with itself");
  }
  constexpr double kMostHours = 2000.0;
  if (arguments.hours * arguments.seeds > kMostHours) {
    throw InputError("--hours times --seeds is more than 2000 h of samples; ask for less");
  }
  Progress progress(arguments.quiet);
  if (arguments.preset == kAll) {
    if (!arguments.out.empty()) make_folder(arguments.out);
    return simulate_all(arguments, progress);
  }
  AllanReport report;
  if (arguments.preset.empty()) {
    const scenarios::ImuLog log = scenarios::read_imu_log(arguments.log);
    std::optional<scenarios::NamedImu> other;
    if (!arguments.compare.empty()) other = scenarios::load_imu(arguments.compare);
    report = scenarios::analyse_log(log, rest_choice(arguments.rest));
    if (other) {
      report.specified_name = other->name;
      report.specified = sim::specified_allan(other->spec);
    }
  } else {
    const scenarios::NamedImu imu = scenarios::load_imu(arguments.preset);
    if (!arguments.out.empty()) make_folder(arguments.out);
    report = simulate(arguments, imu, progress);
  }
  print_report(report);
  if (!arguments.out.empty()) write_report(report, arguments.out);
  return kAllMet;
}

}  // namespace

void add_allan_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<AllanArguments>();
  CLI::App* command = app.add_subcommand(
      "allan", "Allan deviation of an IMU's log, or of a simulated IMU, with fitted coefficients");
  command->add_option("log", arguments->log,
                      "IMU log (CSV: t_gps_s or t_s, accel_x_m_s2 …, gyro_x_rad_s …)");
  command->add_option("--preset", arguments->preset,
                      "Simulate this IMU at rest instead: a preset, a file, or all");
  command->add_option("--compare", arguments->compare,
                      "IMU (preset or file) to lay the log's curves over");
  command
      ->add_option("--rest", arguments->rest,
                   "auto: the stretches at rest, pooled; longest: the longest of them; none: all "
                   "of the log is at rest")
      ->check(CLI::IsMember({"auto", "longest", "none"}))
      ->capture_default_str();
  command->add_option("--hours", arguments->hours, "Length of a simulated recording [h]")
      ->check(CLI::Range(1e-3, 1000.0))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Seed of the first simulated recording")
      ->capture_default_str();
  command->add_option("--seeds", arguments->seeds, "Simulated recordings, pooled")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--out", arguments->out, "Folder for allan.json, allan.csv and allan.png");
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &action] { action = [arguments] { return allan(*arguments); }; });
}

}  // namespace locsim::apps
