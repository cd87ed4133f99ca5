#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <array>
#include <cstdio>
#include <string>
#include <variant>
#include <vector>

#include "benchmarks/drive_messages.h"
#include "benchmarks/stages.h"
#include "core/hash.h"
#include "localization/dynamic_icp/dynamic_icp_localizer.h"

/// What `dynamic_icp` costs on a drive, stage by stage, as a Markdown table.
namespace {

using namespace locsim;
using namespace locsim::benchmarks;
using localization::DynamicIcpLocalizer;
using localization::Estimate;

constexpr double kDrive_s = 60.0;
/// Of a localizer with a search of its own: that is counted apart. `rest`: whatever else.
constexpr std::array<const char*, 8> kStages{"imu",   "gnss", "pick",  "deskew",
                                             "align", "fuse", "judge", "rest"};

struct Replay {
  StageCosts costs;
  int tracking = 0;
  std::vector<double> errors_m;
  Hash hash;
};

void replay(const DriveMessages& drive, int threads, Replay& into) {
  localization::LocalizerInputs inputs = drive.inputs;
  inputs.threads = threads;
  DynamicIcpLocalizer localizer(inputs, {});
  StageCosts& costs = into.costs;
  localizer.on_stage([&](std::string_view stage) { costs.end(stage); });
  for (const Message& message : drive.messages) {
    costs.begin();
    std::visit([&](const auto& content) { localizer.add(content); }, message);
    costs.end("rest");
    if (!std::holds_alternative<LidarScan>(message)) continue;
    costs.next_scan();
    const std::optional<Estimate> estimate = localizer.estimate();
    if (!estimate || estimate->state != localization::State::tracking) continue;
    ++into.tracking;
    for (const double x : estimate->T_map_vehicle.translation) into.hash.add(x);
    if (const std::optional<Pose> truth = drive.truth_at(estimate->time)) {
      into.errors_m.push_back((estimate->T_map_vehicle.translation - truth->translation).norm());
    }
  }
}

void print_row(const std::string& start, StageCosts::Series series, std::size_t scans) {
  // A stage that a scan did not need cost it nothing.
  series.wall_ms.resize(scans, 0.0);
  series.worked_ms.resize(scans, 0.0);
  std::printf("%s | %.2f | %.2f | %.2f | %.2f |\n", start.c_str(), mean(series.worked_ms),
              quantile(series.worked_ms, 0.99), mean(series.wall_ms),
              quantile(series.wall_ms, 0.99));
}

void print(const std::string& lidar, int threads, const Replay& played) {
  const std::string start = "| " + lidar + " | " + std::to_string(threads) + " | ";
  const StageCosts::Costs& tracking = played.costs.tracking();
  const std::size_t scans = tracking.all.wall_ms.size();
  for (const char* stage : kStages) {
    const auto found = tracking.per_stage.find(stage);
    if (found != tracking.per_stage.end()) print_row(start + stage, found->second, scans);
  }
  print_row(start + "all", tracking.all, scans);
  const StageCosts::Series& searching = played.costs.searching().all;
  const std::size_t searches = searching.wall_ms.size();
  if (searches > 0) print_row(start + "a scan with a search", searching, searches);
  std::printf(
      "\n%s, %d threads: %zu scans, %zu with a search, %d tracking, error %.1f cm (mean), "
      "hash %016llx\n\n",
      lidar.c_str(), threads, scans + searches, searches, played.tracking,
      100.0 * mean(played.errors_m), static_cast<unsigned long long>(played.hash.value()));
  std::fflush(stdout);
}

}  // namespace

/// Arguments: presets of LIDARs; without any, two of them.
int main(int count, char** arguments) {
  std::vector<std::string> lidars(arguments + 1, arguments + count);
  if (lidars.empty()) lidars = {"hdl32e", "hdl64e"};
  std::puts(
      "| sensor | threads | stage | ms of work a scan, mean | p99 | ms on the clock, mean | p99 |\n"
      "|---|---|---|---|---|---|---|");
  for (const std::string& lidar : lidars) {
    const DriveMessages drive = record_town_drive(lidar, kDrive_s);
    for (const int threads : {1, 2}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(threads));
      tbb::task_arena arena(threads);
      Replay played;
      arena.execute([&] { replay(drive, threads, played); });
      print(lidar, threads, played);
    }
  }
}
