#include "apps/replay_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/chart.h"
#include "render/trajectory_picture.h"

namespace locsim::apps {

namespace {

using localization::Estimate;
using localization::State;
using scenarios::GnssLog;
using scenarios::WindowScore;
using scenarios::WindowSetScore;

render::TrackState track_state(State state) {
  switch (state) {
    case State::initializing:
      return render::TrackState::initializing;
    case State::tracking:
      return render::TrackState::tracking;
    case State::degraded:
      return render::TrackState::degraded;
    case State::lost:
      break;
  }
  return render::TrackState::lost;
}

std::string number(const char* pattern, std::optional<double> value) {
  if (!value) return "-";
  char text[32];
  std::snprintf(text, sizeof text, pattern, *value);
  return text;
}

std::string seconds(double value) {
  return number("%g s", value);
}

std::string drift_text(const WindowSetScore& set) {
  return seconds(set.length_s) + ": median " + number("%.2f m", set.drift_m.median) + " (" +
         number("%.2f %%", set.drift_percent.median) + "), worst " +
         number("%.1f m", set.drift_m.worst) + " (" + number("%.1f %%", set.drift_percent.worst) +
         ")";
}

bool withheld(const WindowSetScore& set, Stamp time) {
  return std::ranges::any_of(set.windows, [&](const WindowScore& score) {
    return score.window.pass == 0 && time > score.window.from && time <= score.window.until;
  });
}

/// Distance of the estimate's antenna from the line between the fixes about it.
double error_m(const Estimate& estimate, const Vector3d& antenna_in_vehicle_m,
               const std::vector<std::pair<Stamp, Vector3d>>& truth) {
  const auto next =
      std::ranges::lower_bound(truth, estimate.time, {}, &std::pair<Stamp, Vector3d>::first);
  if (next == truth.begin() || next == truth.end()) return std::nan("");
  const auto& [t0, p0] = *(next - 1);
  const auto& [t1, p1] = *next;
  const double share = to_seconds(estimate.time - t0) / to_seconds(t1 - t0);
  const Vector3d error = estimate.T_map_vehicle * antenna_in_vehicle_m - p0 - share * (p1 - p0);
  return error.head<2>().norm();
}

}  // namespace

render::Image draw_replay(const scenarios::DriveLog& log, const scenarios::ReplayReport& report) {
  const LocalFrame frame(scenarios::replay_origin(log.gnss));
  const Stamp start = log.imu.samples.front().time;
  const WindowSetScore& set = report.result.sets.back();
  const Vector3d antenna = report.rig.gnss_mount.position_m;
  std::vector<std::pair<Stamp, Vector3d>> truth;
  render::TrajectoryPicture picture;
  picture.title = report.log + ": " + report.rig.localizer.kind + " without GNSS for " +
                  seconds(set.length_s) + " at a time";
  picture.subtitle = {"drift " + drift_text(set) + "    dots: fixes given to the localizer"};
  for (const GnssLog::Entry& entry : log.gnss.entries) {
    if (!entry.fix.valid) continue;
    const Vector3d position = frame.to_map(entry.fix.position);
    if (!withheld(set, entry.fix.time)) picture.gnss.push_back(position);
    if (!entry.reference) continue;
    truth.emplace_back(entry.fix.time, position);
    picture.truth.push_back(position);
  }
  for (const Estimate& estimate : report.result.window_estimates) {
    const Matrix3d R = estimate.T_map_vehicle.rotation.toRotationMatrix();
    const Matrix3d covariance = R * estimate.covariance.topLeftCorner<3, 3>() * R.transpose();
    picture.estimate.push_back({.position = estimate.T_map_vehicle * antenna,
                                .time_s = to_seconds(estimate.time - start),
                                .error_m = error_m(estimate, antenna, truth),
                                .sigma_m = std::sqrt(covariance(0, 0) + covariance(1, 1)),
                                .state = track_state(estimate.state)});
  }
  for (const WindowScore& score : set.windows) {
    if (score.window.pass != 0) continue;
    picture.events.push_back({.from_s = to_seconds(score.window.from - start),
                              .to_s = to_seconds(score.window.until - start),
                              .label = "no GNSS"});
  }
  picture.duration_s = report.duration_s;
  return render::draw_trajectory(picture);
}

render::Image draw_drift(const scenarios::ReplayReport& report) {
  std::vector<render::ChartPanel> panels;
  for (const WindowSetScore& set : report.result.sets) {
    render::ChartPanel panel{.title = "Drift without GNSS for " + drift_text(set),
                             .y_label = "drift [m]",
                             .zero_based = true,
                             .empty_note = "no estimate"};
    for (const WindowScore& score : set.windows) {
      render::ChartSeries series{.line_px = 1.5};
      for (const WindowScore::Point& point : score.course_of_drift) {
        series.time_s.push_back(point.after_s);
        series.values.push_back(point.drift_m);
      }
      panel.series.push_back(std::move(series));
    }
    panels.push_back(std::move(panel));
  }
  const auto height_px = static_cast<int>(150 + 350 * panels.size());
  return render::draw_chart_column(panels, report.log + ": " + report.rig.localizer.kind, 1600,
                                   height_px);
}

}  // namespace locsim::apps
