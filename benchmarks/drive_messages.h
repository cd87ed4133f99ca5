#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/messages.h"
#include "localization/registry.h"
#include "scenarios/closed_loop.h"
#include "scenarios/scenario.h"
#include "scenarios/stage.h"

namespace locsim::benchmarks {

using Message = std::variant<ImuSample, GnssFix, GnssEpoch, MagneticHeading, LidarScan>;

/// What the sensors of a drive said, in the order that a localizer would have heard it, and what
/// was true.
struct DriveMessages {
  /// Rig, prior map and origin, as a localizer gets them.
  localization::LocalizerInputs inputs;
  std::vector<Message> messages;
  /// At each scan's end.
  std::vector<sim::TruthState> truth;

  /// Between two scans' ends by cubic arcs (of the rotation, too), beyond them nothing.
  [[nodiscard]] std::optional<Pose> truth_at(Stamp time) const {
    const auto after = std::ranges::lower_bound(truth, time, {}, &sim::TruthState::time);
    if (after == truth.end()) return {};
    if (after->time == time) return after->T_map_vehicle;
    if (after == truth.begin()) return {};
    const sim::TruthState& b = *after;
    const sim::TruthState& a = *std::prev(after);
    const double dt = to_seconds(b.time - a.time);
    const double s = to_seconds(time - a.time) / dt;
    const double to_b = s * s * (3.0 - 2.0 * s);
    const double by_a = dt * s * (1.0 - s) * (1.0 - s);
    const double by_b = dt * s * s * (s - 1.0);
    Pose pose;
    pose.translation = (1.0 - to_b) * a.T_map_vehicle.translation +
                       to_b * b.T_map_vehicle.translation + by_a * a.velocity_m_s +
                       by_b * b.velocity_m_s;
    // Turns between scans are small enough for their logarithms to be vectors.
    const Vector3d turn = so3::log(a.T_map_vehicle.rotation.conjugate() * b.T_map_vehicle.rotation);
    pose.rotation = a.T_map_vehicle.rotation * so3::exp(to_b * turn + by_a * a.angular_rate_rad_s +
                                                        by_b * b.angular_rate_rad_s);
    return pose;
  }
};

/// Keeps what it is told.
class Listener final : public localization::Localizer {
 public:
  explicit Listener(std::vector<Message>& messages) : messages_(messages) {}
  void add(const ImuSample& sample) override { messages_.emplace_back(sample); }
  void add(const GnssFix& fix) override { messages_.emplace_back(fix); }
  void add(const GnssEpoch& epoch) override { messages_.emplace_back(epoch); }
  void add(const MagneticHeading& heading) override { messages_.emplace_back(heading); }
  void add(const LidarScan& scan) override { messages_.emplace_back(scan); }
  [[nodiscard]] std::optional<localization::Estimate> estimate() const override { return {}; }

 private:
  std::vector<Message>& messages_;
};

class ListenerSettings final : public localization::LocalizerSettings {
 public:
  explicit ListenerSettings(DriveMessages& drive) : drive_(drive) {}
  void describe(Parameters&) override {}
  [[nodiscard]] std::unique_ptr<localization::Localizer> make(
      const localization::LocalizerInputs& inputs) const override {
    drive_.inputs = inputs;
    return std::make_unique<Listener>(drive_.messages);
  }

 private:
  DriveMessages& drive_;
};

/// A minute through the town of the first drive at up to 50 km/h, with bends and turns but no
/// stops, other traffic, and cars at the kerbs that are not those of the map.
/// `lidar`: name of a preset.
inline DriveMessages record_town_drive(const std::string& lidar, double duration_s) {
  const std::string yaml =
      "name: benchmark_drive\n"
      "about: recorded for benchmarks\n"
      "seed: 1\n"
      "world: {kind: town, seed: 7}\n"
      "route: {kind: town, length_m: 1300, stop_share: 0}\n"
      "vehicle: {kind: sedan, feedback: truth}\n"
      "sensors:\n"
      "  lidar: [{preset: " +
      lidar +
      ", mount: roof}]\n"
      "  imu: {preset: mti10}\n"
      "  gnss: {preset: ublox_f9p}\n"
      "  magnetometer: {preset: mti10}\n"
      "map: {source: survey, resolution_m: 0.2}\n"
      "localizer: {kind: icp}\n"
      "expect: {}\n"
      "duration_s: " +
      std::to_string(duration_s) + "\n";
  scenarios::Scenario scenario = scenarios::parse_scenario(yaml, "benchmark drive");
  DriveMessages drive;
  scenario.localizer.settings = std::make_shared<ListenerSettings>(drive);
  const scenarios::Stage stage = scenarios::build_stage(scenario);
  scenarios::RunRecord record = scenarios::run_closed_loop(
      scenario, stage, scenarios::build_map(scenario, stage), {.threads = 2, .progress = {}});
  drive.truth = std::move(record.truth);
  return drive;
}

}  // namespace locsim::benchmarks
