#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "render/chart.h"
#include "render/gl_context.h"

namespace locsim::render {

/// What the localizer said of itself.
enum class TrackState : std::uint8_t { initializing, tracking, degraded, lost };

struct EstimatePoint {
  /// Map frame [m].
  Vector3d position = Vector3d::Zero();
  /// Since the start of the run [s].
  double time_s = 0.0;
  /// Distance from truth; not a number where there is no truth [m].
  double error_m = std::numeric_limits<double>::quiet_NaN();
  /// One standard deviation of the position by the estimate's own covariance; not a number keeps
  /// the 3 σ band away [m].
  double sigma_m = std::numeric_limits<double>::quiet_NaN();
  TrackState state = TrackState::tracking;
};

/// All that the picture of a run shows. Anything may be empty.
struct TrajectoryPicture {
  std::string title;
  /// Under the title, one line each.
  std::vector<std::string> subtitle;
  std::vector<SceneMesh> meshes;
  /// Map frame, in order of time.
  std::vector<Vector3d> truth;
  std::vector<EstimatePoint> estimate;
  std::vector<Vector3d> gnss;
  /// Outages and the like, shaded in the chart.
  std::vector<ChartSpan> events;
  /// Length of the run; the chart goes at least this far [s].
  double duration_s = 0.0;
  int width_px = 1600;
  int height_px = 1200;
};

/// The town from above, shaded and muted; on it the estimate, wide and coloured by its error (rim
/// coloured where the state is not `tracking`), truth thin and dark over it, GNSS fixes, start and
/// end; below it the error over time. Says "no estimate" where there is none. GNSS fixes on the
/// track itself are thinned out so that its colours stay visible; those beside it are all drawn.
[[nodiscard]] Image draw_trajectory(const TrajectoryPicture& picture);

}  // namespace locsim::render
