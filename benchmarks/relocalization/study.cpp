#include "benchmarks/relocalization/study.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <functional>
#include <set>

#include "benchmarks/relocalization/plain_icp.h"
#include "benchmarks/relocalization/stopwatch.h"

namespace locsim::relocalization {

namespace {

/// Places where two threads are timed as well: one in so many.
constexpr std::size_t kTimedEvery = 5;

void fill_plain(const StartTown& town, std::span<const Berth> berths,
                std::span<const std::vector<Vector3f>> scans, double gnss_error_m,
                std::vector<Row>& rows) {
  PlainIcp icp(town.map(), gnss_error_m);
  for (const bool is_heading_known : {true, false}) {
    std::vector<double> seconds;
    for (const Row* row : rows_of(rows, gnss_error_m, is_heading_known)) {
      seconds.push_back(row->dynamic.first.seconds);
    }
    const double budget = quantile(seconds, 0.5);
    for (Row& row : rows) {
      if (row.start.gnss_error_m != gnss_error_m) continue;
      if (row.start.is_heading_known != is_heading_known) continue;
      const auto place = static_cast<std::size_t>(row.place);
      const Pose truth = town.pose(berths[place]);
      row.icp_once = icp.once(truth, scans[place], row.start);
      row.icp_grid = icp.grid(truth, scans[place], row.start, budget);
    }
  }
}

double seconds_to_cut(const StartTown& town, const Berth& berth, const Start& start,
                      const StudyRequest& request) {
  localization::LocalMap map(town.map(), request.config.local_map);
  const double radius_m = request.config.scan_range_m + request.config.sigmas * start.sigma_m;
  return tbb::task_arena(1).execute([&] {
    const Stopwatch watch;
    (void)map.cut(start.guess(town.pose(berth)).T_map_vehicle.translation, radius_m);
    return watch.thread_seconds();
  });
}

}  // namespace

std::vector<double> errors_of(std::span<const Row> rows) {
  std::set<double> errors;
  for (const Row& row : rows) errors.insert(row.start.gnss_error_m);
  return {errors.begin(), errors.end()};
}

std::vector<const Row*> rows_of(std::span<const Row> rows, double gnss_error_m,
                                bool is_heading_known) {
  std::vector<const Row*> found;
  for (const Row& row : rows) {
    if (row.start.gnss_error_m == gnss_error_m && row.start.is_heading_known == is_heading_known) {
      found.push_back(&row);
    }
  }
  return found;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const auto rank =
      static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(rank - 1, 0, std::ssize(values) - 1))];
}

std::vector<Row> study_town(const StartTown& town, std::uint64_t seed,
                            const StudyRequest& request) {
  const std::vector<Berth> berths = town.draw_berths(request.poses);
  std::vector<std::vector<Vector3f>> scans;
  for (const Berth& berth : berths) scans.push_back(town.scan(berth));

  // The widest first: what follows finds the map cut.
  std::vector<double> errors_m = request.gnss_errors_m;
  std::ranges::sort(errors_m, std::ranges::greater{});
  const std::size_t starts = 2 * errors_m.size();
  std::vector<Row> rows(berths.size() * starts);
  std::atomic<std::size_t> done{0};
  tbb::task_arena(request.jobs).execute([&] {
    tbb::parallel_for(std::size_t{0}, berths.size(), [&](std::size_t place) {
      localization::DynamicIcp icp(town.map(), request.config);
      for (std::size_t i = 0; i < starts; ++i) {
        Row& row = rows[place * starts + i];
        row = {.seed = seed, .place = static_cast<int>(place), .points = scans[place].size()};
        row.start = draw_start(seed, place, errors_m[i / 2], i % 2 == 0);
        if (i == 0) row.cut_seconds = seconds_to_cut(town, berths[place], row.start, request);
        // Has the map cut for what follows.
        (void)icp.track(scans[place], row.start.guess(town.pose(berths[place])).T_map_vehicle,
                        row.start.sigma_m);
        row.dynamic = try_dynamic(icp, town, berths[place], scans[place], row.start, 1, kScansMax);
        if (request.jobs == 1 && place % kTimedEvery == 0) {
          row.seconds_of_two_threads =
              try_dynamic(icp, town, berths[place], scans[place], row.start, 2, 1).first.seconds;
        }
      }
      std::fprintf(stderr, "seed %llu: %zu of %zu places\n", static_cast<unsigned long long>(seed),
                   ++done, berths.size());
    });
  });
  if (!request.with_plain_icp) return rows;
  for (const double error_m : errors_m) {
    std::fprintf(stderr, "seed %llu: plain ICP, GNSS off by %.0f m\n",
                 static_cast<unsigned long long>(seed), error_m);
    fill_plain(town, berths, scans, error_m, rows);
  }
  return rows;
}

}  // namespace locsim::relocalization
