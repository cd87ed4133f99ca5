#include "apps/pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.h"
#include "render/chart.h"
#include "render/scan_picture.h"
#include "render/trajectory_picture.h"
#include "scenarios/run_files.h"
#include "sim/lidar/lidar.h"
#include "sim/ray_scene.h"

namespace locsim::apps {

namespace {

using scenarios::RunFiles;
using scenarios::Scenario;
using scenarios::Stage;

constexpr double kDegree = std::numbers::pi / 180.0;

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string score_text(const RunFiles& run, std::string_view name, const char* pattern) {
  for (const scenarios::Score& score : run.scores) {
    if (score.name == name) return score.value ? format(pattern, *score.value) : "none";
  }
  return "none";
}

render::TrackState track_state(localization::State state) {
  switch (state) {
    case localization::State::initializing:
      return render::TrackState::initializing;
    case localization::State::tracking:
      return render::TrackState::tracking;
    case localization::State::degraded:
      return render::TrackState::degraded;
    case localization::State::lost:
      break;
  }
  return render::TrackState::lost;
}

std::vector<render::SceneMesh> scene_meshes(const Stage& stage) {
  std::vector<render::SceneMesh> meshes;
  for (const TriangleMesh* mesh :
       {&stage.world.ground, &stage.world.structures, &stage.world.parked_cars}) {
    meshes.push_back({.mesh = mesh, .materials = stage.world.materials});
  }
  return meshes;
}

/// Truth at 10 Hz as a curve again.
sim::Trajectory truth_curve(const RunFiles& run) {
  if (run.truth.size() < 4) throw InputError("truth.tum: fewer than 4 poses, nothing to draw");
  sim::Trajectory trajectory(run.truth.front().time, run.truth[1].time - run.truth[0].time);
  for (const RunFiles::TruthRow& row : run.truth) trajectory.push(row.T_map_vehicle);
  return trajectory;
}

render::TrajectoryPicture trajectory_picture(const RunFiles& run, const Scenario& scenario,
                                             const Stage& stage, int width_px) {
  render::TrajectoryPicture picture;
  picture.title = run.scenario + ": " + (run.passed ? "passed" : "failed");
  picture.subtitle = {run.localizer + ", seed " + std::to_string(run.seed) + "    ATE rms " +
                      score_text(run, "ate_rmse_m", "%.3f m") + ", max " +
                      score_text(run, "ate_max_m", "%.3f m") + "    yaw rms " +
                      score_text(run, "yaw_rmse_deg", "%.2f deg") + "    availability " +
                      score_text(run, "availability", "%.3f") + "    cross-track max " +
                      score_text(run, "cross_track_max_m", "%.2f m")};
  picture.meshes = scene_meshes(stage);
  picture.width_px = width_px;
  picture.height_px = width_px * 3 / 4;
  for (const RunFiles::TruthRow& row : run.truth) {
    picture.truth.push_back(row.T_map_vehicle.translation);
  }
  auto truth = run.truth.begin();
  for (const RunFiles::EstimateRow& row : run.estimates) {
    while (truth != run.truth.end() && truth->time < row.time) ++truth;
    render::EstimatePoint point{.position = row.T_map_vehicle.translation,
                                .time_s = to_seconds(row.time),
                                .sigma_m = row.sigma_position_m.norm(),
                                .state = track_state(row.state)};
    if (truth != run.truth.end() && truth->time == row.time) {
      point.error_m = (point.position - truth->T_map_vehicle.translation).norm();
    }
    picture.estimate.push_back(point);
  }
  for (const RunFiles::GnssRow& row : run.gnss) {
    if (row.valid) picture.gnss.push_back(row.position_m);
  }
  for (const sim::FaultSpec& fault : scenario.faults) {
    picture.events.push_back({.from_s = fault.at_s,
                              .to_s = fault.at_s + fault.for_s,
                              .label = std::string(fault.name())});
  }
  if (!run.truth.empty()) picture.duration_s = to_seconds(run.truth.back().time);
  return picture;
}

/// The end of the revolution nearest to `at_s`, or to the middle of the drive, within the curve.
Stamp scan_end(const sim::Trajectory& truth, Duration period, std::optional<double> at_s) {
  const double middle_s = 0.5 * (to_seconds(truth.start()) + to_seconds(truth.end()));
  const auto count = std::llround(at_s.value_or(middle_s) / to_seconds(period));
  const auto first = (truth.start().time_since_epoch() + period - Duration{1}) / period + 1;
  const auto last = truth.end().time_since_epoch() / period;
  return Stamp{std::clamp<std::int64_t>(count, first, last) * period};
}

render::Image scan_image(const RunFiles& run, const Scenario& scenario, const Stage& stage,
                         const PictureOptions& options) {
  const sim::Trajectory truth = truth_curve(run);
  const scenarios::LidarSetup& setup = scenario.sensors.lidar.front();
  const Pose T_vehicle_lidar = setup.mount.pose();
  sim::Lidar lidar(setup.spec, T_vehicle_lidar, 0, scenario.seed, sim::Weather(scenario.weather),
                   sim::Faults(scenario.faults));
  const Stamp end = scan_end(truth, setup.spec.period(), options.scan_at_s);

  const std::vector<sim::Actor> actors = stage.actors;
  const sim::RayScene scene(stage.world, actors);
  LidarScan scan = lidar.start_scan(end - setup.spec.period());
  lidar.cast(scene, truth, scan.start, scan.end, scan);

  TriangleMesh moving;
  for (const sim::Actor& actor : actors) {
    moving.append(stage.world.actor_shapes[actor.shape], actor.pose_at(end));
  }
  render::ScanPicture picture;
  picture.title =
      run.scenario + ": a scan of " + setup.spec.name + " at " + format("%.1f s", to_seconds(end));
  picture.subtitle = {std::to_string(scan.points.size()) + " returns of " +
                      std::to_string(lidar.rays_per_scan()) + " rays"};
  picture.meshes = scene_meshes(stage);
  picture.meshes.push_back({.mesh = &moving, .materials = stage.world.materials});
  if (!stage.world.actor_shapes.empty()) {
    picture.vehicle = {.mesh = &stage.world.actor_shapes.front(),
                       .materials = stage.world.materials};
  }
  picture.T_map_vehicle = truth.pose_at(end);
  picture.width_px = options.width_px;
  picture.height_px = options.width_px * 9 / 16;
  for (const LidarPoint& point : scan.points) {
    const Pose T_map_lidar = truth.pose_at(scan.start + Duration{point.time_ns}) * T_vehicle_lidar;
    picture.points.push_back(
        {.position = T_map_lidar * point.position(), .range_m = point.position().norm()});
  }
  return render::draw_scan(picture);
}

/// A value and its time for a chart.
struct Curve {
  std::vector<double> time_s;
  std::vector<double> value;
  void add(double t, double v) {
    time_s.push_back(t);
    value.push_back(v);
  }
  /// An angle in (−180, 180]: the line breaks where it goes round.
  void add_angle(double t, double v) {
    if (!value.empty() && std::abs(v - value.back()) > 180.0) {
      add(t, std::numeric_limits<double>::quiet_NaN());
    }
    add(t, v);
  }
};

render::ChartPanel panel(std::string title, std::string y_label, const Curve& logged,
                         const Curve& simulated) {
  return {.title = std::move(title),
          .y_label = std::move(y_label),
          .series = {{.name = "log",
                      .time_s = logged.time_s,
                      .values = logged.value,
                      .color = render::palette::orange,
                      .line_px = 4.0},
                     {.name = "simulated",
                      .time_s = simulated.time_s,
                      .values = simulated.value,
                      .color = render::palette::blue,
                      .line_px = 1.6}}};
}

/// Speed, course and height of the drive beside the log's. The log's clock starts when the
/// simulated driver sets off: with the first estimate.
render::Image recorded_image(const RunFiles& run, const sim::RecordedTrack& track,
                             const Scenario& scenario, int width_px) {
  constexpr double kCourseSpeed_m_s = 1.0;
  double set_off_s = 0.0;
  for (const RunFiles::EstimateRow& row : run.estimates) {
    if (row.state == localization::State::initializing) continue;
    if (scenario.vehicle.feedback == "estimate") {
      set_off_s = to_seconds(row.time) + scenario.latency_s;
    }
    break;
  }

  Curve log_speed, log_course, log_height, speed, course, height;
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  for (const sim::RecordedTrack::Sample& sample : track.samples) {
    log_speed.add(sample.time_s, sample.speed_m_s);
    log_course.add_angle(
        sample.time_s, sample.speed_m_s > kCourseSpeed_m_s ? sample.course_rad / kDegree : nothing);
    log_height.add(sample.time_s, sample.position.z() - scenario.route.recorded.antenna_height_m);
  }
  const sim::Trajectory truth = truth_curve(run);
  for (Stamp t = truth.start(); t <= truth.end(); t += truth.step()) {
    const sim::TruthState state = truth.at(t);
    const double time_s = to_seconds(t) - set_off_s;
    const double speed_m_s = state.velocity_m_s.norm();
    speed.add(time_s, speed_m_s);
    course.add_angle(time_s,
                     speed_m_s > kCourseSpeed_m_s
                         ? std::atan2(state.velocity_m_s.y(), state.velocity_m_s.x()) / kDegree
                         : nothing);
    height.add(time_s, state.T_map_vehicle.translation.z());
  }
  const std::vector<render::ChartPanel> panels = {
      panel("Speed", "speed [m/s]", log_speed, speed),
      panel("Course from East, counter-clockwise", "course [deg]", log_course, course),
      panel("Height above the map's origin", "height [m]", log_height, height)};
  return render::draw_chart_column(panels, run.scenario + ": simulated drive beside its log",
                                   width_px, width_px * 3 / 4);
}

}  // namespace

void draw_run(const std::filesystem::path& run_folder, const Scenario& scenario, const Stage& stage,
              const PictureOptions& options) {
  const RunFiles run = scenarios::load_run(run_folder);
  render::write_png(
      render::draw_trajectory(trajectory_picture(run, scenario, stage, options.width_px)),
      run_folder / "trajectory.png");
  render::write_png(scan_image(run, scenario, stage, options), run_folder / "scan.png");
  if (stage.track) {
    render::write_png(recorded_image(run, *stage.track, scenario, options.width_px),
                      run_folder / "recorded.png");
  }
}

}  // namespace locsim::apps
