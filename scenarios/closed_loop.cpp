#include "scenarios/closed_loop.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <variant>

#include "localization/registry.h"
#include "scenarios/driver_estimate.h"
#include "scenarios/gnss_delivery.h"
#include "scenarios/imu_delivery.h"
#include "sim/faults/faults.h"
#include "sim/faults/kidnapper.h"
#include "sim/gnss/gnss.h"
#include "sim/imu/imu.h"
#include "sim/lidar/lidar_rig.h"
#include "sim/magnetometer/earth_field.h"
#include "sim/magnetometer/magnetometer.h"
#include "sim/magnetometer/steel_field.h"
#include "sim/ray_scene.h"
#include "sim/vehicle/driver.h"
#include "sim/vehicle/vehicle.h"

namespace locsim::scenarios {

namespace {

using localization::Estimate;

/// Adds the wall-clock time of its scope to a sum.
class CostTimer {
 public:
  explicit CostTimer(double& sum_s) : sum_s_(sum_s), start_(std::chrono::steady_clock::now()) {}
  CostTimer(const CostTimer&) = delete;
  CostTimer& operator=(const CostTimer&) = delete;
  ~CostTimer() { sum_s_ += elapsed_s(); }
  [[nodiscard]] double elapsed_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  double& sum_s_;
  std::chrono::steady_clock::time_point start_;
};

/// What a sensor says, and when the localizer hears it.
struct Message {
  Stamp delivered;
  std::variant<ImuSample, GnssFix, GnssEpoch, MagneticHeading, std::shared_ptr<const LidarScan>>
      content;
};

/// What one tick hands to the localizer, and what it answers.
struct Batch {
  Stamp tick;
  std::vector<Message> messages;
  std::optional<Estimate> estimate;
  double cost_s = 0.0;

  [[nodiscard]] bool has_scan() const {
    return std::ranges::any_of(messages, [](const Message& message) {
      return std::holds_alternative<std::shared_ptr<const LidarScan>>(message.content);
    });
  }
};

void feed(localization::Localizer& localizer, Batch& batch) {
  CostTimer timer(batch.cost_s);
  for (const Message& message : batch.messages) {
    std::visit(
        [&](const auto& m) {
          if constexpr (requires { m->points; }) {
            localizer.add(*m);
          } else {
            localizer.add(m);
          }
        },
        message.content);
  }
  batch.estimate = localizer.estimate();
}

std::vector<sim::MountedLidar> mounted_lidars(const SensorSuite& sensors) {
  std::vector<sim::MountedLidar> lidars;
  for (const LidarSetup& setup : sensors.lidar) lidars.push_back({setup.spec, setup.mount.pose()});
  return lidars;
}

localization::Rig make_rig(const SensorSuite& sensors) {
  localization::Rig rig = inertial_rig(sensors.imu, sensors.gnss.mount);
  for (const LidarSetup& lidar : sensors.lidar) rig.T_vehicle_lidar.push_back(lidar.mount.pose());
  return rig;
}

sim::DriverView truth_view(const sim::TruthState& truth) {
  const Vector3d velocity_vehicle = truth.T_map_vehicle.rotation.conjugate() * truth.velocity_m_s;
  return {.T_map_vehicle = truth.T_map_vehicle,
          .speed_m_s = velocity_vehicle.x(),
          .yaw_rate_rad_s = truth.angular_rate_rad_s.z()};
}

class ClosedLoop {
 public:
  ClosedLoop(const Scenario& scenario, const Stage& stage,
             std::shared_ptr<const maps::PriorMap> map, const RunOptions& options);
  RunRecord run();

 private:
  void kidnap_if_due();
  void step_vehicle();
  void drive_one_period();
  void sample_light_sensors(Stamp from);
  void deliver_imu(std::span<const ImuSample> samples);
  void deliver_gnss(std::vector<sim::GnssOutput> outputs);
  void cast_lidars();
  void deliver_scan();
  void tick();
  void await_localizer();
  void deliver_due_estimates();

  const Scenario& scenario_;
  const RunOptions& options_;
  Duration tick_period_;
  Duration latency_;
  double expected_end_s_;
  double end_s_;

  LocalFrame frame_;
  std::vector<sim::Actor> actors_;
  std::vector<Pose> actor_poses_;
  sim::RayScene scene_;
  sim::Vehicle vehicle_;
  sim::Driver driver_;
  sim::Controls controls_;
  sim::Trajectory trajectory_;
  sim::Faults faults_;
  sim::Kidnapper kidnapper_;
  /// When the car was set down and where on the route, until the driver has been told.
  std::optional<std::pair<Stamp, double>> set_down_;
  sim::LidarRig lidars_;
  sim::Imu imu_;
  ImuDelivery imu_delivery_;
  sim::Gnss gnss_;
  GnssDelivery gnss_delivery_;
  Vector3d earth_field_map_T_;
  sim::SteelField steel_field_;
  sim::Magnetometer magnetometer_;

  localization::Rig rig_;
  std::unique_ptr<localization::Localizer> localizer_;
  DriverEstimate driver_estimate_;
  std::vector<Message> inbox_;
  std::deque<std::shared_ptr<Batch>> in_flight_;
  tbb::task_group localizer_task_;

  Stamp now_;
  RunRecord record_;
};

ClosedLoop::ClosedLoop(const Scenario& scenario, const Stage& stage,
                       std::shared_ptr<const maps::PriorMap> map, const RunOptions& options)
    : scenario_(scenario),
      options_(options),
      tick_period_(scenario.sensors.lidar.front().spec.period()),
      latency_(duration_from_seconds(scenario.latency_s)),
      expected_end_s_(scenario.duration_s > 0.0 ? scenario.duration_s : stage.route.duration_s()),
      end_s_(time_limit_s(scenario, stage)),
      frame_(stage.world.origin),
      actors_(stage.actors),
      actor_poses_(actors_.size()),
      scene_(stage.world, actors_),
      vehicle_(scenario.vehicle.spec, stage.world, stage.route.pose(0.0), actors_),
      driver_(scenario.vehicle.driver, scenario.vehicle.spec, stage.route),
      trajectory_(Stamp{}, scenario.vehicle.spec.step),
      faults_(scenario.faults),
      kidnapper_(faults_, stage.route),
      lidars_(mounted_lidars(scenario.sensors), scenario.seed, sim::Weather(scenario.weather),
              faults_, Stamp{}),
      imu_(scenario.sensors.imu.spec, scenario.sensors.imu.mount.pose(), scenario.seed, faults_),
      imu_delivery_(faults_),
      gnss_(scenario.sensors.gnss.spec, scenario.sensors.gnss.mount.pose().translation, stage.world,
            scene_, frame_, scenario.gps_start(), scenario.seed, faults_),
      earth_field_map_T_(
          sim::earth_field_enu_T(stage.world.origin, scenario.gps_start().decimal_year())),
      steel_field_(stage.world, actors_, earth_field_map_T_, scenario.world.seed),
      magnetometer_(scenario.sensors.magnetometer.spec, scenario.sensors.magnetometer.mount.pose(),
                    earth_field_map_T_, &steel_field_, scenario.seed),
      rig_(make_rig(scenario.sensors)),
      localizer_(scenario.localizer.settings->make({.rig = rig_,
                                                    .map = std::move(map),
                                                    .origin = stage.world.origin,
                                                    .threads = options.threads})),
      driver_estimate_(rig_) {
  // One physics step ahead of the clock: the trajectory's last tangent needs the pose after it.
  trajectory_.push(vehicle_.T_map_vehicle());
  step_vehicle();
}

void ClosedLoop::kidnap_if_due() {
  const Stamp at = trajectory_.end() + trajectory_.step();
  while (const auto move =
             kidnapper_.take_due(at, vehicle_.T_map_vehicle(), vehicle_.speed_m_s())) {
    trajectory_.jump(vehicle_.set_down(move->T_map_map));
    set_down_ = {at, move->s_m};
  }
}

void ClosedLoop::step_vehicle() {
  if (kidnapper_.has_more()) kidnap_if_due();
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    actor_poses_[i] = actors_[i].pose_at(trajectory_.end());
  }
  vehicle_.set_actor_poses(actor_poses_);
  vehicle_.step(controls_);
  trajectory_.push(vehicle_.T_map_vehicle());
}

void ClosedLoop::drive_one_period() {
  CostTimer timer(record_.cost.vehicle_s);
  const bool by_truth = scenario_.vehicle.feedback == "truth";
  // Who drives by an estimate finds out by it.
  if (set_down_ && set_down_->first <= now_) {
    if (by_truth) driver_.set_down(set_down_->second);
    set_down_.reset();
  }
  const std::optional<sim::DriverView> view =
      by_truth ? truth_view(trajectory_.at(now_)) : driver_estimate_.view();
  controls_ = driver_.control(now_, view);
  now_ += kControlPeriod;
  kidnapper_.follow(vehicle_.T_map_vehicle().translation);
  while (trajectory_.end() < now_) step_vehicle();
}

void ClosedLoop::sample_light_sensors(Stamp from) {
  CostTimer timer(record_.cost.other_sensors_s);
  std::vector<ImuSample> imu;
  imu_.sample(trajectory_, from, now_, imu);
  std::vector<MagneticHeading> headings;
  magnetometer_.sample(trajectory_, from, now_, headings);
  std::vector<sim::GnssOutput> gnss;
  gnss_.sample(trajectory_, from, now_, gnss);

  deliver_imu(imu);
  for (const MagneticHeading& heading : headings) inbox_.push_back({heading.time, heading});
  deliver_gnss(std::move(gnss));
}

void ClosedLoop::deliver_gnss(std::vector<sim::GnssOutput> outputs) {
  for (const sim::GnssOutput& output : outputs) {
    record_.fixes.push_back(output.fix);
    record_.epochs.push_back(output.raw);
  }
  for (sim::GnssOutput& arrived : gnss_delivery_.deliver(std::move(outputs), now_)) {
    inbox_.push_back({arrived.delivered, std::move(arrived.fix)});
    inbox_.push_back({arrived.delivered, std::move(arrived.raw)});
  }
}

void ClosedLoop::deliver_imu(std::span<const ImuSample> samples) {
  record_.imu.insert(record_.imu.end(), samples.begin(), samples.end());
  for (const DeliveredImu& arrived : imu_delivery_.deliver(samples, now_)) {
    driver_estimate_.add(arrived.sample);
    inbox_.push_back({arrived.at, arrived.sample});
  }
}

void ClosedLoop::cast_lidars() {
  CostTimer timer(record_.cost.lidar_s);
  // Isolated, or this thread might take up the localizer's task while it waits for its rays.
  tbb::this_task_arena::isolate([&] { lidars_.cast(scene_, trajectory_, now_); });
}

void ClosedLoop::deliver_scan() {
  auto scan = std::make_shared<const LidarScan>(lidars_.finish());
  if (scan->points.empty()) return;
  record_.scan_times.push_back(now_);
  inbox_.push_back({now_, std::move(scan)});
}

void ClosedLoop::tick() {
  record_.truth.push_back(trajectory_.at(now_));
  auto batch = std::make_shared<Batch>();
  batch->tick = now_;
  batch->messages = std::exchange(inbox_, {});
  std::ranges::stable_sort(batch->messages, {}, &Message::delivered);
  in_flight_.push_back(batch);
  localizer_task_.run([this, batch] { feed(*localizer_, *batch); });
}

void ClosedLoop::await_localizer() {
  CostTimer timer(record_.cost.waiting_s);
  localizer_task_.wait();
}

void ClosedLoop::deliver_due_estimates() {
  while (!in_flight_.empty() && now_ >= in_flight_.front()->tick + latency_) {
    const std::shared_ptr<Batch> batch = in_flight_.front();
    in_flight_.pop_front();
    driver_estimate_.deliver(batch->estimate);
    if (batch->estimate) record_.estimates.push_back(*batch->estimate);
    record_.cost.localizer_s += batch->cost_s;
    if (batch->has_scan()) record_.cost.scan_ms.push_back(1e3 * batch->cost_s);
  }
}

RunRecord ClosedLoop::run() {
  {
    CostTimer timer(record_.cost.total_s);
    Stamp next_tick = Stamp{} + tick_period_;
    const Stamp last = stamp_from_seconds(end_s_);
    while (now_ < last && !driver_.finished()) {
      const Stamp from = now_;
      drive_one_period();
      sample_light_sensors(from);

      const bool is_tick = now_ >= next_tick;
      const bool is_due = !in_flight_.empty() && now_ >= in_flight_.front()->tick + latency_;
      if (is_tick || is_due) cast_lidars();
      if (is_due) {
        await_localizer();
        deliver_due_estimates();
      }
      if (is_tick) {
        deliver_scan();
        // The localizer takes one batch at a time.
        await_localizer();
        tick();
        next_tick += tick_period_;
        if (options_.progress) options_.progress(to_seconds(now_), expected_end_s_);
      }
    }
    await_localizer();
    now_ += latency_;
    deliver_due_estimates();
    now_ -= latency_;
  }
  record_.route_finished = driver_.finished();
  record_.simulated_s = to_seconds(now_);
  record_.collisions = vehicle_.collisions();
  record_.satellites = broadcast_of(gnss_.receiver(), record_.epochs, scenario_.gps_start());
  return std::move(record_);
}

}  // namespace

RunRecord run_closed_loop(const Scenario& scenario, const Stage& stage,
                          std::shared_ptr<const maps::PriorMap> map, const RunOptions& options) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(options.threads));
  RunRecord record;
  tbb::task_arena arena(options.threads);
  arena.execute([&] { record = ClosedLoop(scenario, stage, std::move(map), options).run(); });
  return record;
}

}  // namespace locsim::scenarios
