#pragma once

#include <vector>

#include "benchmarks/relocalization/start_case.h"

namespace locsim::relocalization {

struct StudyRequest {
  int poses = 300;
  std::vector<double> gnss_errors_m = {5.0, 15.0, 30.0, 50.0};
  localization::DynamicIcpConfig config;
  /// Without, Algorithm 1 alone.
  bool with_plain_icp = true;
  /// Places at a time; those of two threads are timed with 1 only.
  int jobs = 1;
};

/// Every method from one start.
struct Row {
  std::uint64_t seed = 0;
  int place = 0;
  /// What the scan has after thinning.
  std::size_t points = 0;
  Start start;
  DynamicTry dynamic;
  /// Of the first call again, with two threads; 0 where that was not timed.
  double seconds_of_two_threads = 0.0;
  /// Of cutting the map about the place with nothing of it at hand, one thread; 0 where a wider
  /// search was there before.
  double cut_seconds = 0.0;
  Try icp_once;
  Try icp_grid;
};

/// All starts from one scan at each of the places of a town, with progress on stderr. The grid of
/// plain ICP has the seconds that Algorithm 1 took in the median with this error of GNSS and
/// knowledge of the heading, one thread each.
[[nodiscard]] std::vector<Row> study_town(const StartTown& town, std::uint64_t seed,
                                          const StudyRequest& request);

/// Errors of GNSS that the rows have, ascending [m].
[[nodiscard]] std::vector<double> errors_of(std::span<const Row> rows);
/// Rows of one error of GNSS and knowledge of the heading.
[[nodiscard]] std::vector<const Row*> rows_of(std::span<const Row> rows, double gnss_error_m,
                                              bool is_heading_known);

/// Quantile of any values by the nearest rank; 0 of none.
[[nodiscard]] double quantile(std::vector<double> values, double share);

}  // namespace locsim::relocalization
