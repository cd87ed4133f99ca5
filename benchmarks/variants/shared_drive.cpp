#include "benchmarks/variants/shared_drive.h"

#include <cassert>
#include <string>
#include <utility>

#include "localization/registry.h"

namespace locsim::variants {

namespace {

using localization::Estimate;
using localization::Localizer;
using scenarios::Scenario;

/// For each listener, what it answered whenever it was asked.
using Answers = std::vector<std::vector<Estimate>>;

/// Hands every message to all listeners.
class Audience final : public Localizer {
 public:
  Audience(std::vector<std::unique_ptr<Localizer>> listeners, std::shared_ptr<Answers> answers)
      : listeners_(std::move(listeners)), answers_(std::move(answers)) {}

  void add(const ImuSample& sample) override { add_to_all(sample); }
  void add(const GnssFix& fix) override { add_to_all(fix); }
  void add(const GnssEpoch& epoch) override { add_to_all(epoch); }
  void add(const MagneticHeading& heading) override { add_to_all(heading); }
  void add(const LidarScan& scan) override { add_to_all(scan); }

  /// The first listener's.
  [[nodiscard]] std::optional<Estimate> estimate() const override {
    std::optional<Estimate> first;
    for (std::size_t i = 0; i < listeners_.size(); ++i) {
      const std::optional<Estimate> answer = listeners_[i]->estimate();
      if (answer) (*answers_)[i].push_back(*answer);
      if (i == 0) first = answer;
    }
    return first;
  }

 private:
  template <typename Message>
  void add_to_all(const Message& message) {
    for (const std::unique_ptr<Localizer>& listener : listeners_) listener->add(message);
  }

  std::vector<std::unique_ptr<Localizer>> listeners_;
  std::shared_ptr<Answers> answers_;
};

class AudienceSettings final : public localization::LocalizerSettings {
 public:
  AudienceSettings(std::span<const Scenario> runs, std::shared_ptr<Answers> answers)
      : runs_(runs), answers_(std::move(answers)) {}

  void describe(Parameters&) override {}
  [[nodiscard]] std::unique_ptr<Localizer> make(
      const localization::LocalizerInputs& inputs) const override {
    std::vector<std::unique_ptr<Localizer>> listeners;
    for (const Scenario& run : runs_) listeners.push_back(run.localizer.settings->make(inputs));
    return std::make_unique<Audience>(std::move(listeners), answers_);
  }

 private:
  std::span<const Scenario> runs_;
  std::shared_ptr<Answers> answers_;
};

std::string drive_text(Scenario scenario) {
  scenario.localizer = {};
  scenario.expect.clear();
  return scenarios::to_yaml(scenario);
}

}  // namespace

bool have_one_drive(const Scenario& a, const Scenario& b) {
  return a.vehicle.feedback == "truth" && drive_text(a) == drive_text(b);
}

bool have_one_stage(const Scenario& a, const Scenario& b) {
  Scenario moved = a;
  moved.seed = b.seed;
  moved.duration_s = b.duration_s;
  moved.world = b.world;
  moved.route = b.route;
  moved.traffic = b.traffic;
  moved.map = b.map;
  return scenarios::to_yaml(moved) == scenarios::to_yaml(a);
}

std::vector<scenarios::RunResult> drive_together(std::span<const Scenario> runs,
                                                 const scenarios::Stage& stage,
                                                 std::shared_ptr<const maps::PriorMap> map,
                                                 const scenarios::RunOptions& options) {
  const auto answers = std::make_shared<Answers>(runs.size());
  Scenario together = runs.front();
  together.localizer.settings = std::make_shared<AudienceSettings>(runs, answers);
  const scenarios::RunRecord drive =
      scenarios::run_closed_loop(together, stage, std::move(map), options);
  assert(drive.estimates.size() == answers->front().size());

  std::vector<scenarios::RunResult> results;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    scenarios::RunRecord own = drive;
    own.estimates = std::move((*answers)[i]);
    results.push_back(scenarios::score_record(runs[i], stage, std::move(own)));
  }
  return results;
}

}  // namespace locsim::variants
