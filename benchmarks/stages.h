#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/figures.h"

namespace locsim::benchmarks {

/// What each stage of the work on each scan costs. A scan's share is everything since the scan
/// before it, so that the IMU's samples count with the scan that they lead to.
class StageCosts {
 public:
  /// Of some scans [ms].
  struct Series {
    std::vector<double> wall_ms;
    std::vector<double> worked_ms;
  };
  struct Costs {
    std::map<std::string, Series> per_stage;
    Series all;
  };

  /// Something is about to be done.
  void begin() { (void)stopwatch_.lap(); }
  /// A stage has ended.
  void end(std::string_view stage) {
    const Stopwatch::Lap lap = stopwatch_.lap();
    for (Stopwatch::Lap* sum : {&current_[std::string(stage)], &current_all_}) {
      sum->wall_ms += lap.wall_ms;
      sum->worked_ms += lap.worked_ms;
    }
  }
  /// A scan has been dealt with.
  void next_scan() {
    Costs& costs = current_.contains("search") ? searching_ : tracking_;
    for (const auto& [stage, lap] : current_) push(lap, costs.per_stage[stage]);
    push(current_all_, costs.all);
    current_.clear();
    current_all_ = {};
  }

  /// Scans that a search was made for, and all others.
  [[nodiscard]] const Costs& searching() const { return searching_; }
  [[nodiscard]] const Costs& tracking() const { return tracking_; }

 private:
  static void push(const Stopwatch::Lap& lap, Series& series) {
    series.wall_ms.push_back(lap.wall_ms);
    series.worked_ms.push_back(lap.worked_ms);
  }

  Stopwatch stopwatch_;
  std::map<std::string, Stopwatch::Lap> current_;
  Stopwatch::Lap current_all_;
  Costs searching_;
  Costs tracking_;
};

}  // namespace locsim::benchmarks
