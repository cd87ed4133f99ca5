#include "render/track_style.h"

namespace locsim::render {

const char* state_name(TrackState state) {
  switch (state) {
    case TrackState::initializing:
      return "initializing";
    case TrackState::tracking:
      return "tracking";
    case TrackState::degraded:
      return "degraded";
    case TrackState::lost:
      return "lost";
  }
  return "unknown";
}

Color state_color(TrackState state) {
  switch (state) {
    case TrackState::initializing:
      return palette::slate;
    case TrackState::tracking:
      return palette::green;
    case TrackState::degraded:
      return palette::pink;
    case TrackState::lost:
      return palette::ink;
  }
  return palette::slate;
}

TrackLine track_line(const std::vector<EstimatePoint>& estimate, const MapView& view,
                     const Scale& error) {
  constexpr double longest_gap_s = 2.0;
  constexpr double fastest_m_s = 150.0;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TrackLine line;
  const auto add = [&](const Vector2d& point, Color color, Color rim) {
    line.points.push_back(point);
    line.colors.push_back(color);
    line.rims.push_back(rim);
  };
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const EstimatePoint& e = estimate[i];
    if (i > 0) {
      const double gap_s = e.time_s - estimate[i - 1].time_s;
      const double leap_m = (e.position - estimate[i - 1].position).head<2>().norm();
      if (gap_s > longest_gap_s || leap_m > fastest_m_s * gap_s) {
        add({nan, nan}, palette::paper, palette::paper);
      }
    }
    add(view.pixel(e.position), turbo(error.fraction(e.error_m)),
        e.state == TrackState::tracking ? palette::paper : state_color(e.state));
  }
  return line;
}

}  // namespace locsim::render
