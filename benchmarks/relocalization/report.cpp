#include "benchmarks/relocalization/report.h"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <numbers>

namespace locsim::relocalization {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
  std::array<char, 512> buffer{};
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer.data(), buffer.size(), format, arguments);
  va_end(arguments);
  return buffer.data();
}

double percent(std::span<const Row* const> rows, const std::function<bool(const Row&)>& is_true) {
  double count = 0.0;
  for (const Row* row : rows) count += is_true(*row) ? 1.0 : 0.0;
  return rows.empty() ? 0.0 : 100.0 * count / static_cast<double>(rows.size());
}

std::size_t number(std::span<const Row* const> rows,
                   const std::function<bool(const Row&)>& is_true) {
  std::size_t count = 0;
  for (const Row* row : rows) count += is_true(*row) ? 1 : 0;
  return count;
}

std::vector<double> values(std::span<const Row* const> rows,
                           const std::function<double(const Row&)>& value) {
  std::vector<double> all;
  for (const Row* row : rows) all.push_back(value(*row));
  return all;
}

std::string method_cells(std::span<const Row* const> rows,
                         const std::function<const Try&(const Row&)>& of) {
  const auto is = [&](Outcome outcome) {
    return [&of, outcome](const Row& row) { return of(row).outcome == outcome; };
  };
  return text("%.1f | %zu", percent(rows, is(Outcome::fixed)),
              number(rows, is(Outcome::false_fix)));
}

}  // namespace

std::string start_table(std::span<const Row> rows, bool with_plain_icp) {
  std::string table =
      "| GNSS off by [m] | heading | starts | success [%] | false fixes | between | abstained "
      "| computing [s], 1 thread: median / p95 / worst | 2 threads: median | cutting the map first "
      "| seconds of the drive: median / p95 / worst | without a fix after 10 scans "
      "| false fixes while driving on |";
  if (with_plain_icp) {
    table +=
        " ICP grid, same seconds: success [%] | false | seconds | ICP once: success [%] | false "
        "| seconds |";
  }
  table += "\n|---|---|---|---|---|---|---|---|---|---|---|---|---|";
  if (with_plain_icp) table += "---|---|---|---|---|---|";
  table += "\n";
  for (const double error_m : errors_of(rows)) {
    for (const bool is_heading_known : {true, false}) {
      const std::vector<const Row*> cell = rows_of(rows, error_m, is_heading_known);
      const auto first_is = [](Outcome outcome) {
        return [outcome](const Row& row) { return row.dynamic.first.outcome == outcome; };
      };
      table +=
          text("| %.0f | %s | %zu | %.1f | %zu | %zu | %zu ", error_m,
               is_heading_known ? "±10°" : "unknown", cell.size(),
               percent(cell, first_is(Outcome::fixed)), number(cell, first_is(Outcome::false_fix)),
               number(cell, first_is(Outcome::loose)), number(cell, first_is(Outcome::abstained)));
      const std::vector<double> seconds =
          values(cell, [](const Row& row) { return row.dynamic.first.seconds; });
      std::vector<double> two =
          values(cell, [](const Row& row) { return row.seconds_of_two_threads; });
      std::erase(two, 0.0);
      table += text("| %.2f / %.2f / %.2f | %.2f ", quantile(seconds, 0.5), quantile(seconds, 0.95),
                    quantile(seconds, 1.0), quantile(two, 0.5));
      std::vector<double> cut = values(cell, [](const Row& row) { return row.cut_seconds; });
      std::erase(cut, 0.0);
      table += cut.empty() ? "| " : text("| %.2f ", quantile(cut, 0.5));
      std::vector<double> drive;
      for (const Row* row : cell) {
        if (row->dynamic.final == Outcome::fixed) drive.push_back(row->dynamic.drive_s());
      }
      table +=
          text("| %.1f / %.1f / %.1f | %zu | %zu |", quantile(drive, 0.5), quantile(drive, 0.95),
               quantile(drive, 1.0),
               number(cell, [](const Row& row) { return row.dynamic.final == Outcome::abstained; }),
               number(cell, [](const Row& row) {
                 return row.dynamic.scans > 1 && row.dynamic.final == Outcome::false_fix;
               }));
      if (with_plain_icp) {
        const auto grid = [](const Row& row) -> const Try& { return row.icp_grid; };
        const auto once = [](const Row& row) -> const Try& { return row.icp_once; };
        for (const auto& of : {std::function<const Try&(const Row&)>(grid),
                               std::function<const Try&(const Row&)>(once)}) {
          const std::vector<double> used =
              values(cell, [&](const Row& row) { return of(row).seconds; });
          table += text(" %s | %.2f |", method_cells(cell, of).c_str(), quantile(used, 0.5));
        }
      }
      table += "\n";
    }
  }
  return table;
}

std::string start_csv(std::span<const Row> rows) {
  std::string csv =
      "seed,place,points,gnss_error_m,heading_known,offset_east_m,offset_north_m,yaw_error_deg,"
      "outcome,error_m,error_deg,status,tries,candidates,iterations,overlap,error_mean_m,"
      "cost_ratio_of_rival,degenerate,inliers,seconds,seconds_two_threads,scans,final,"
      "icp_grid,icp_grid_error_m,icp_grid_seconds,icp_once,icp_once_error_m,icp_once_seconds\n";
  for (const Row& row : rows) {
    const Start& start = row.start;
    const DynamicTry& d = row.dynamic;
    constexpr std::array<const char*, 3> kStatus = {"converged", "ambiguous", "failed"};
    csv += text("%llu,%d,%zu,%.0f,%d,%.2f,%.2f,%.2f,", static_cast<unsigned long long>(row.seed),
                row.place, row.points, start.gnss_error_m, start.is_heading_known ? 1 : 0,
                start.offset_m.x(), start.offset_m.y(), start.yaw_error_rad / kDegree);
    csv += text(
        "%s,%.3f,%.3f,%s,%d,%d,%d,%.3f,%.4f,%.3f,%d,%d,%.3f,%.3f,%d,%s,", name_of(d.first.outcome),
        d.first.error.distance_m, d.first.error.angle_rad / kDegree,
        kStatus[static_cast<std::size_t>(d.result.status)], d.result.tries, d.result.candidates,
        d.result.iterations, d.result.alignment.overlap, d.result.alignment.error_m,
        d.result.rival_ratio, d.result.alignment.degenerate ? 1 : 0, d.result.alignment.inliers,
        d.first.seconds, row.seconds_of_two_threads, d.scans, name_of(d.final));
    csv += text("%s,%.3f,%.3f,%s,%.3f,%.3f\n", name_of(row.icp_grid.outcome),
                row.icp_grid.error.distance_m, row.icp_grid.seconds, name_of(row.icp_once.outcome),
                row.icp_once.error.distance_m, row.icp_once.seconds);
  }
  return csv;
}

}  // namespace locsim::relocalization
