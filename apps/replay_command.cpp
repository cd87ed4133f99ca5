#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/progress.h"
#include "apps/replay_pictures.h"
#include "core/error.h"
#include "scenarios/replay.h"
#include "scenarios/replay_clock.h"
#include "scenarios/replay_files.h"
#include "scenarios/replay_rig.h"
#include "scenarios/text_io.h"

namespace locsim::apps {

namespace fs = std::filesystem;

namespace {

using scenarios::ErrorSummary;
using scenarios::ReplayReport;
using scenarios::WindowSetScore;

constexpr const char* kAuto = "auto";
constexpr const char* kMeasured = "measured";
constexpr const char* kPreset = "preset";

struct ReplayArguments {
  std::string log;
  std::string rig;
  std::string localizer;
  std::vector<std::string> settings;
  std::string gnss_offset = kAuto;
  std::string velocity_delay = kAuto;
  std::string imu_noise = kMeasured;
  std::vector<double> withhold_s = {10.0, 30.0, 60.0};
  std::size_t windows = 12;
  std::string out;
  bool quiet = false;
};

void print_cell(std::optional<double> value, const char* pattern) {
  char text[32] = "-";
  if (value) std::snprintf(text, sizeof text, pattern, *value);
  std::printf(" %9s", text);
}

void print_summary(const char* name, const ErrorSummary& summary, const char* pattern) {
  std::printf("  %-34s", name);
  for (const auto& value : {summary.rms, summary.median, summary.p95, summary.worst}) {
    print_cell(value, pattern);
  }
  print_cell(summary.mean, pattern);
  std::printf(" %7zu", summary.count);
  if (summary.missing > 0) std::printf("  %zu without an estimate", summary.missing);
  std::printf("\n");
}

void print_header(const std::string& what) {
  std::printf("\n%-36s %9s %9s %9s %9s %9s %7s\n", what.c_str(), "rms", "median", "p95", "worst",
              "mean", "count");
}

void print_set(const WindowSetScore& set) {
  char title[96];
  std::snprintf(title, sizeof title, "%zu windows of %g s, %zu %s", set.windows.size(),
                set.length_s, set.passes, set.passes == 1 ? "pass" : "passes");
  print_header(title);
  if (set.lost > 0) {
    std::printf("  called itself lost at the end of %zu of them; scored all the same\n", set.lost);
  }
  print_summary("drift at the end [m]", set.drift_m, "%.2f");
  print_summary("largest drift [m]", set.drift_max_m, "%.2f");
  print_summary("drift at the end [% of distance]", set.drift_percent, "%.2f");
  print_summary("error / claimed sigma at the end", set.error_over_sigma, "%.2f");
  print_summary("heading to course, inside [deg]", set.heading_inside_deg, "%.2f");
  print_summary("heading to course, outside [deg]", set.heading_outside_deg, "%.2f");
}

void print_report(const ReplayReport& report) {
  const scenarios::ReplayResult& result = report.result;
  std::printf("%s: %.1f s, %.0f m, %zu fixes, %zu of them to score against; localizer %s\n",
              report.log.c_str(), report.duration_s, result.distance_m, result.fixes,
              result.references, report.rig.localizer.kind.c_str());
  std::printf("GNSS stamps %+.4f s", to_seconds(report.gnss_offset));
  if (const auto& found = report.estimated_offset) {
    std::printf(
        ", where the course turns as gyro z does: correlation %.4f, slope %.4f, %zu intervals",
        found->correlation, found->slope, found->intervals);
  }
  std::printf("\nvelocities are true %.4f s before their stamps",
              to_seconds(report.velocity_delay));
  if (const auto& found = report.estimated_delay) {
    std::printf(": they leave %.1f mm of a position's moves unexplained, unshifted %.1f mm",
                1e3 * found->rms_m, 1e3 * found->rms_without_m);
  }
  if (report.rig.measured_noise.accel_m_s2_sqrthz > 0.0) {
    std::printf("\nIMU noise as its samples scatter: %.5f rad/s and %.4f m/s2 per sqrt(Hz)",
                report.rig.measured_noise.gyro_rad_s_sqrthz,
                report.rig.measured_noise.accel_m_s2_sqrthz);
  }
  const scenarios::HeldOutScore& held = result.held_out;
  if (held.first_claim_s) {
    std::printf("\nfirst estimate after %.1f s\n", *held.first_claim_s);
  } else {
    std::printf("\nno estimate at all\n");
  }
  print_header("every second fix held out");
  print_summary("horizontal error [m]", held.horizontal_m, "%.3f");
  print_summary("vertical error [m]", held.vertical_m, "%.3f");
  print_summary("horizontal error / claimed sigma", held.error_over_sigma, "%.2f");
  print_summary("heading to course [deg]", held.heading_deg, "%.2f");
  for (const WindowSetScore& set : result.sets) print_set(set);
  if (!result.all_scored()) {
    std::printf("\nFAILED: there was not an estimate everywhere that one was to be scored\n");
  }
}

// For options that are seconds or kAuto.
Duration seconds_of(const std::string& text, const char* option, const char* what) {
  const auto value = scenarios::parse_seconds(text);
  if (!value) {
    throw InputError(std::string(option) + ": '" + text + "' needs to be seconds " + what +
                     ", or auto");
  }
  return value->time_since_epoch();
}

Duration find_delay(const ReplayArguments& arguments, const scenarios::GnssLog& log,
                    ReplayReport& report) {
  if (arguments.velocity_delay == kAuto) {
    report.estimated_delay = scenarios::estimate_velocity_delay(log);
    return report.estimated_delay->delay;
  }
  const Duration delay = seconds_of(arguments.velocity_delay, "--velocity-delay",
                                    "from a velocity's time to its stamp");
  if (delay < Duration{0} || delay > std::chrono::seconds(1)) {
    throw InputError("--velocity-delay: " + arguments.velocity_delay +
                     " s needs to lie in 0...1 s");
  }
  return delay;
}

Duration find_offset(const ReplayArguments& arguments, const scenarios::DriveLog& log,
                     ReplayReport& report) {
  if (arguments.gnss_offset == kAuto) {
    report.estimated_offset = scenarios::estimate_clock_offset(log, report.rig.imu.mount.pose());
    return report.estimated_offset->offset;
  }
  return seconds_of(arguments.gnss_offset, "--gnss-offset", "to add to the GNSS stamps");
}

void check_out(const ReplayArguments& arguments) {
  if (arguments.out.empty()) return;
  scenarios::make_replay_folder(arguments.out);
  if (fs::equivalent(arguments.out, arguments.log)) {
    throw InputError(arguments.out + ": is the log's own folder; name another with --out");
  }
}

int replay(const ReplayArguments& arguments) {
  ReplayReport report{.log = arguments.log,
                      .rig = scenarios::load_replay_rig(arguments.rig, arguments.log,
                                                        arguments.localizer, arguments.settings)};
  scenarios::DriveLog log = scenarios::read_drive_log(arguments.log);
  log.gnss.velocity_delay = report.velocity_delay = find_delay(arguments, log.gnss, report);
  report.rig.tell_velocity_delay(report.velocity_delay);
  if (arguments.imu_noise == kMeasured) {
    report.rig.tell_imu_noise(scenarios::measure_imu_noise(log.imu.samples));
  }
  report.gnss_offset = find_offset(arguments, log, report);
  log.shift_gnss(report.gnss_offset);
  report.duration_s = log.imu.duration_s();
  const localization::LocalizerInputs inputs{.rig = report.rig.rig(log.imu.rate_hz),
                                             .origin = scenarios::replay_origin(log.gnss)};
  const auto make_localizer = [&] { return report.rig.localizer.settings->make(inputs); };
  // Says what is wrong with its settings, or that it needs a map, before any file is made.
  static_cast<void>(make_localizer());
  check_out(arguments);

  Progress progress(arguments.quiet);
  progress.begin("replaying");
  const scenarios::ReplayOptions options{
      .withhold_s = arguments.withhold_s,
      .windows = arguments.windows,
      .gnss_latency = duration_from_seconds(report.rig.gnss_latency_s),
      .antenna_in_vehicle_m = report.rig.gnss_mount.position_m,
      .progress = [&](std::size_t pass, std::size_t passes) {
        progress.update(static_cast<double>(pass), static_cast<double>(passes),
                        "pass " + std::to_string(pass + 1) + " of " + std::to_string(passes));
      }};
  report.result = scenarios::run_replay(log, options, make_localizer);
  progress.end();

  print_report(report);
  if (!arguments.out.empty()) {
    const fs::path out = arguments.out;
    scenarios::write_replay(report, out);
    if (!report.result.sets.empty()) {
      render::write_png(draw_replay(log, report), out / "trajectory.png");
      render::write_png(draw_drift(report), out / "drift.png");
    }
    std::printf("\n%s\n", arguments.out.c_str());
  }
  return report.result.all_scored() ? kAllMet : kCriterionFailed;
}

}  // namespace

void add_replay_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app.add_subcommand(
      "replay", "Replays a recorded drive's IMU and GNSS, scored where GNSS is withheld");
  command
      ->add_option("log", arguments->log,
                   "Folder with imu.csv and gnss.csv: a recorded drive's, or a run's")
      ->required();
  command->add_option("--rig", arguments->rig,
                      "Where the sensors sit and which IMU it is (YAML: imu, gnss, localizer)");
  command->add_option("--localizer", arguments->localizer,
                      "Localizer that needs no LIDAR, by name [gnss_ins]");
  command
      ->add_option("--set", arguments->settings,
                   "key.path=value, as if the rig file said so; may be repeated")
      ->allow_extra_args(false);
  command
      ->add_option("--gnss-offset", arguments->gnss_offset,
                   "What to add to the GNSS stamps [s]; auto: from the turns of course and gyro")
      ->capture_default_str();
  command
      ->add_option("--velocity-delay", arguments->velocity_delay,
                   "From a GNSS velocity's own time to its stamp [s]; auto: by how positions move")
      ->capture_default_str();
  command
      ->add_option("--imu-noise", arguments->imu_noise,
                   "What the localizer is told of the IMU's white noise: as the samples scatter "
                   "(measured), vibration included, or the preset's")
      ->check(CLI::IsMember({kMeasured, kPreset}))
      ->capture_default_str();
  command
      ->add_option("--withhold", arguments->withhold_s,
                   "Lengths of the windows without GNSS, between commas [s]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  command->add_option("--windows", arguments->windows, "Windows of each length")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000}))
      ->capture_default_str();
  command->add_option("--out", arguments->out,
                      "Folder for replay.json, windows.csv, estimate.csv and pictures");
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &action] { action = [arguments] { return replay(*arguments); }; });
}

}  // namespace locsim::apps
