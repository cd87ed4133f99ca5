// starts SCENARIO.yaml [--poses N] [--seeds A,B,C] [--out FOLDER]: how well, how fast and how
// surely Algorithm 1 finds the car on the map from GNSS alone, beside plain ICP.
// Prints a table; writes starts.md, starts.csv and relocalization_basin.png where a folder is
// named.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/relocalization/basin.h"
#include "benchmarks/relocalization/report.h"
#include "benchmarks/relocalization/study.h"
#include "scenarios/text_io.h"

namespace {

namespace fs = std::filesystem;
using namespace locsim;

struct Request {
  fs::path scenario;
  fs::path out;
  std::vector<std::uint64_t> seeds = {7, 8, 9};
  int basins = 4;
  double basin_step_m = 8.0;
  bool without_icp = false;
  relocalization::StudyRequest study;
  localization::PointPickerConfig picker{.range_max_m = 75.0, .voxel_m = 0.8, .points_max = 2500};
};

void show(Request request) {
  request.study.with_plain_icp = !request.without_icp;
  std::vector<relocalization::Row> rows;
  std::vector<relocalization::Basin> basins;
  for (const std::uint64_t seed : request.seeds) {
    const relocalization::StartTown town(request.scenario, seed, request.picker);
    const std::vector<relocalization::Row> more =
        relocalization::study_town(town, seed, request.study);
    rows.insert(rows.end(), more.begin(), more.end());
    if (seed == request.seeds.front() && request.basins > 0 && !request.out.empty()) {
      basins = relocalization::find_basins(town, seed, request.basins, request.basin_step_m,
                                           request.study.config);
    }
  }
  const std::string table = relocalization::start_table(rows, request.study.with_plain_icp);
  std::fputs(table.c_str(), stdout);
  if (request.out.empty()) return;
  fs::create_directories(request.out);
  scenarios::write_text_file(request.out / "starts.md", table);
  scenarios::write_text_file(request.out / "starts.csv", relocalization::start_csv(rows));
  if (basins.empty()) return;
  render::write_png(relocalization::draw_basins(basins, rows),
                    request.out / "relocalization_basin.png");
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  CLI::App app("Starts of Algorithm 1 on a scenario's streets, beside plain ICP.");
  app.add_option("scenario", request.scenario)->required()->check(CLI::ExistingFile);
  app.add_option("--poses", request.study.poses, "places a town")->check(CLI::Range(1, 100000));
  app.add_option("--seeds", request.seeds, "of the towns")->delimiter(',');
  app.add_option("--out", request.out, "folder for table, CSV and picture");
  app.add_option("--errors", request.study.gnss_errors_m, "of GNSS [m]")
      ->delimiter(',')
      ->check(CLI::Range(0.1, 1000.0));
  app.add_option("--jobs", request.study.jobs, "places at a time; two threads are timed with 1")
      ->check(CLI::Range(1, 64));
  app.add_option("--basins", request.basins, "places in the picture; 0 draws none")
      ->check(CLI::Range(0, 6));
  app.add_option("--basin-step", request.basin_step_m, "from start to start in it [m]")
      ->check(CLI::Range(1.0, 50.0));
  app.add_option("--voxel", request.picker.voxel_m, "one point of the scan each [m]");
  app.add_option("--points", request.picker.points_max, "of a scan, at most");
  app.add_flag("--no-icp", request.without_icp, "leave plain ICP out");
  try {
    app.parse(argc, argv);
    show(std::move(request));
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "starts: %s\n", error.what());
    return 2;
  }
}
