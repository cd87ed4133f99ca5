#include "sim/world/recorded_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"
#include "sim/world/height_blend.h"
#include "sim/world/smoothing_spline.h"

namespace locsim::sim {

namespace {

constexpr double kSpacingM = 0.5;
constexpr double kKnotM = 1.0;
constexpr double kHeightKnotM = 2.0;
constexpr int kHeightPasses = 2;
// A change of course by more than this between two samples under way is a change of gear [rad].
constexpr double kReverseRad = 2.1;
constexpr double kUnderWayMS = 0.3;

/// Times, speeds and the way that they integrate to. Linear in speed between epochs.
struct Schedule {
  std::vector<double> time_s;
  std::vector<double> speed_m_s;
  std::vector<double> way_m;
  struct Rest {
    std::size_t first, last;
  };
  std::vector<Rest> rests;

  /// When `way_m` is reached first, and how fast the car is then.
  struct Moment {
    double time_s, speed_m_s;
  };
  [[nodiscard]] Moment reach(double way) const {
    const auto after = std::lower_bound(way_m.begin(), way_m.end(), way);
    if (after == way_m.begin()) return {time_s.front(), speed_m_s.front()};
    if (after == way_m.end()) return {time_s.back(), speed_m_s.back()};
    const auto i = static_cast<std::size_t>(after - way_m.begin()) - 1;
    const double dt = time_s[i + 1] - time_s[i];
    const double acceleration = (speed_m_s[i + 1] - speed_m_s[i]) / dt;
    const double gone = way - way_m[i];
    const double v0 = speed_m_s[i];
    const double v = std::sqrt(std::max(0.0, v0 * v0 + 2.0 * acceleration * gone));
    return {time_s[i] + (v0 + v > 0.0 ? std::min(dt, 2.0 * gone / (v0 + v)) : 0.0), v};
  }
};

void check_forward(const RecordedTrack& track) {
  const RecordedTrack::Sample* last = nullptr;
  for (const auto& sample : track.samples) {
    if (sample.speed_m_s < kUnderWayMS) continue;
    if (last != nullptr &&
        std::abs(wrap_angle(sample.course_rad - last->course_rad)) > kReverseRad) {
      throw InputError(track.source + ": the course turns about between " +
                       std::to_string(last->time_s) + " s and " + std::to_string(sample.time_s) +
                       " s: the car reverses. Only forward drives can be run; cut the track there");
    }
    last = &sample;
  }
}

Schedule make_schedule(const RecordedTrack& track, const RecordedLayoutConfig& config) {
  const auto& samples = track.samples;
  const std::size_t count = samples.size();
  Schedule schedule;
  for (const auto& sample : samples) {
    schedule.time_s.push_back(sample.time_s);
    schedule.speed_m_s.push_back(sample.speed_m_s);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (samples[i].speed_m_s >= config.rest_speed_m_s) continue;
    std::size_t last = i;
    while (last + 1 < count && samples[last + 1].speed_m_s < config.rest_speed_m_s) ++last;
    if (samples[last].time_s - samples[i].time_s >= config.rest_time_s) {
      schedule.rests.push_back({i, last});
      std::fill(schedule.speed_m_s.begin() + static_cast<std::ptrdiff_t>(i),
                schedule.speed_m_s.begin() + static_cast<std::ptrdiff_t>(last) + 1, 0.0);
    }
    i = last;
  }
  // Two binomial passes against the noise of Doppler speeds; rests stay at rest.
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<double> raw = schedule.speed_m_s;
    for (std::size_t i = 1; i + 1 < count; ++i) {
      schedule.speed_m_s[i] = 0.25 * raw[i - 1] + 0.5 * raw[i] + 0.25 * raw[i + 1];
    }
    for (const auto& rest : schedule.rests) {
      std::fill(schedule.speed_m_s.begin() + static_cast<std::ptrdiff_t>(rest.first),
                schedule.speed_m_s.begin() + static_cast<std::ptrdiff_t>(rest.last) + 1, 0.0);
    }
  }
  schedule.way_m.assign(count, 0.0);
  for (std::size_t i = 1; i < count; ++i) {
    schedule.way_m[i] =
        schedule.way_m[i - 1] + 0.5 * (schedule.speed_m_s[i] + schedule.speed_m_s[i - 1]) *
                                    (schedule.time_s[i] - schedule.time_s[i - 1]);
  }
  return schedule;
}

/// The path over the way driven; a rest counts as one sample.
struct Path {
  SmoothingSpline x, y, z;
};

Path fit_path(const RecordedTrack& track, const Schedule& schedule,
              const RecordedLayoutConfig& config) {
  std::vector<double> way, x, y, z, sigma;
  auto rest = schedule.rests.begin();
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    std::size_t last = i;
    if (rest != schedule.rests.end() && rest->first == i) last = (rest++)->last;
    Vector3d sum = Vector3d::Zero();
    for (std::size_t k = i; k <= last; ++k) sum += track.samples[k].position;
    const Vector3d mean = sum / static_cast<double>(last - i + 1);
    way.push_back(schedule.way_m[i]);
    x.push_back(mean.x());
    y.push_back(mean.y());
    z.push_back(mean.z());
    sigma.push_back(track.samples[i].sigma_m);
    i = last;
  }
  return {SmoothingSpline(way, x, sigma, kKnotM, config.path_cutoff_m),
          SmoothingSpline(way, y, sigma, kKnotM, config.path_cutoff_m),
          SmoothingSpline(way, z, sigma, kHeightKnotM, config.height_cutoff_m)};
}

/// Way driven against length of the smoothed path, tabulated finely.
struct LengthTable {
  std::vector<double> way, length;

  [[nodiscard]] static double interpolate(const std::vector<double>& from,
                                          const std::vector<double>& to, double value) {
    const auto after = std::upper_bound(from.begin() + 1, from.end() - 1, value);
    const auto i = static_cast<std::size_t>(after - from.begin()) - 1;
    return to[i] + (value - from[i]) / (from[i + 1] - from[i]) * (to[i + 1] - to[i]);
  }
};

LengthTable measure(const Path& path, double way_m) {
  const int steps = std::max(2, static_cast<int>(std::ceil(way_m / 0.05)));
  const double h = way_m / steps;
  const auto rate = [&](double u) { return std::hypot(path.x.at(u).first, path.y.at(u).first); };
  LengthTable table{{0.0}, {0.0}};
  for (int i = 1; i <= steps; ++i) {
    const double u = h * i;
    table.length.push_back(table.length.back() +
                           h / 6.0 * (rate(u - h) + 4.0 * rate(u - 0.5 * h) + rate(u)));
    table.way.push_back(u);
  }
  return table;
}

/// Even samples about half a metre apart, such that each rest falls on one.
std::vector<double> sample_lengths(const LengthTable& table, const std::vector<RouteStop>& stops) {
  std::vector<double> marks = {0.0};
  for (const RouteStop& stop : stops) {
    if (stop.s_m > marks.back() + kSpacingM) marks.push_back(stop.s_m);
  }
  if (table.length.back() < marks.back() + kSpacingM && marks.size() > 1) marks.pop_back();
  marks.push_back(table.length.back());
  std::vector<double> lengths = {0.0};
  for (std::size_t i = 1; i < marks.size(); ++i) {
    const double span = marks[i] - marks[i - 1];
    const int pieces = std::max(1, static_cast<int>(std::lround(span / kSpacingM)));
    for (int k = 1; k <= pieces; ++k) lengths.push_back(marks[i - 1] + span * k / pieces);
  }
  return lengths;
}

std::vector<RoutePoint> sample_route(const Path& path, const Schedule& schedule,
                                     const LengthTable& table, const std::vector<double>& lengths,
                                     const RecordedLayoutConfig& config) {
  std::vector<RoutePoint> points;
  double yaw = 0.0;
  for (const double s : lengths) {
    const double u = LengthTable::interpolate(table.length, table.way, s);
    const auto x = path.x.at(u);
    const auto y = path.y.at(u);
    const double rate = std::hypot(x.first, y.first);
    const double course = std::atan2(y.first, x.first);
    yaw = points.empty() ? course : yaw + wrap_angle(course - yaw);
    const auto moment = schedule.reach(u);
    points.push_back(
        {.s_m = s,
         .position = {x.value, y.value, path.z.at(u).value - config.antenna_height_m},
         .yaw_rad = yaw,
         .curvature_1_m = (x.first * y.second - y.first * x.second) / (rate * rate * rate),
         .speed_m_s = moment.speed_m_s * rate,
         .half_width_m = 0.5 * config.lane_width_m,
         .time_s = moment.time_s});
  }
  return points;
}

/// The points at rest get their arrival exactly, whatever rounding did.
void pin_rests(const Schedule& schedule, const std::vector<RouteStop>& stops,
               std::vector<RoutePoint>& points) {
  for (std::size_t k = 0; k < stops.size(); ++k) {
    const auto nearest = std::ranges::min_element(
        points, {}, [&](const RoutePoint& p) { return std::abs(p.s_m - stops[k].s_m); });
    nearest->speed_m_s = 0.0;
    nearest->time_s = schedule.time_s[schedule.rests[k].first];
  }
}

void check_turns(const std::vector<RoutePoint>& points, const RecordedTrack& track,
                 const RecordedLayoutConfig& config) {
  const auto tightest = std::ranges::max_element(
      points, {}, [](const RoutePoint& p) { return std::abs(p.curvature_1_m); });
  const double radius = 1.0 / std::abs(tightest->curvature_1_m);
  if (radius < config.turning_radius_m) {
    throw InputError(
        track.source + ": at " + std::to_string(tightest->time_s) +
        " s the smoothed track turns with a radius of " + std::to_string(radius) +
        " m, tighter than turning_radius_m = " + std::to_string(config.turning_radius_m) +
        "; raise path_cutoff_m, or cut the track there");
  }
}

/// Half a lane to the left of the lane's middle; every second point is a vertex.
Street make_street(const std::vector<RoutePoint>& points, const RecordedLayoutConfig& config) {
  Street street{.centreline = {},
                .half_width_m = config.lane_width_m,
                .pavement_width_m = config.pavement_width_m,
                .carries_route = true};
  for (std::size_t i = 0; i < points.size(); i += 2) {
    const double yaw = points[i].yaw_rad;
    street.centreline.push_back(points[i].position +
                                0.5 * config.lane_width_m *
                                    Vector3d(-std::sin(yaw), std::cos(yaw), 0.0));
  }
  return street;
}

/// Fits the street's heights so that the ground under the lane is the log's.
void fit_heights(const std::vector<RoutePoint>& points, Layout& layout) {
  auto& line = layout.streets.front().centreline;
  for (int pass = 0; pass < kHeightPasses; ++pass) {
    const GroundSurface surface(layout, 2.0 * layout.streets.front().half_width_m);
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Vector3d& wanted = points[2 * i].position;
      line[i].z() += wanted.z() - surface.at(wanted.x(), wanted.y()).height_m;
    }
  }
}

/// Straight on at both ends, on the ground that is there already.
void extend(Street& street, const std::vector<RoutePoint>& points, double length_m) {
  const HeightBlend blend({&street, 1});
  const auto continuation = [&](const Vector3d& end, double course) {
    std::vector<Vector3d> more;
    for (double d = 1.0; d <= length_m; d += 1.0) {
      Vector3d p = end + d * Vector3d(std::cos(course), std::sin(course), 0.0);
      p.z() = blend.at(p.x(), p.y());
      more.push_back(p);
    }
    return more;
  };
  auto& line = street.centreline;
  const auto after = continuation(line.back(), points.back().yaw_rad);
  auto before = continuation(line.front(), points.front().yaw_rad + std::numbers::pi);
  std::ranges::reverse(before);
  line.insert(line.end(), after.begin(), after.end());
  line.insert(line.begin(), before.begin(), before.end());
}

}  // namespace

void RecordedLayoutConfig::describe(Parameters& p) {
  p.number("lane_width_m", lane_width_m, {.min = 2.0, .max = 6.0});
  p.number("pavement_width_m", pavement_width_m, {.min = 0.0, .max = 10.0});
  p.number("antenna_height_m", antenna_height_m, {.min = 0.0, .max = 10.0});
  p.number("path_cutoff_m", path_cutoff_m, {.min = 1.0, .max = 100.0});
  p.number("height_cutoff_m", height_cutoff_m, {.min = 1.0, .max = 500.0});
  p.number("rest_speed_m_s", rest_speed_m_s, {.min = 0.01, .max = 1.0});
  p.number("rest_time_s", rest_time_s, {.min = 0.1, .max = 60.0});
  p.number("turning_radius_m", turning_radius_m, {.min = 2.0, .max = 20.0});
  p.number("extension_m", extension_m, {.min = 0.0, .max = 200.0});
}

Layout make_recorded_layout(const RecordedTrack& track, const RecordedLayoutConfig& config) {
  check_parameters(config, "route");
  check_forward(track);
  const Schedule schedule = make_schedule(track, config);
  const Path path = fit_path(track, schedule, config);
  const LengthTable table = measure(path, schedule.way_m.back());

  std::vector<RouteStop> stops;
  for (const auto& rest : schedule.rests) {
    stops.push_back(
        {.s_m = LengthTable::interpolate(table.way, table.length, schedule.way_m[rest.first]),
         .dwell_s = schedule.time_s[rest.last] - schedule.time_s[rest.first]});
  }
  std::vector<RoutePoint> points =
      sample_route(path, schedule, table, sample_lengths(table, stops), config);
  pin_rests(schedule, stops, points);
  check_turns(points, track, config);

  Layout layout;
  layout.streets.push_back(make_street(points, config));
  fit_heights(points, layout);
  extend(layout.streets.front(), points, config.extension_m);
  const GroundSurface surface(layout, 2.0 * config.lane_width_m);
  for (RoutePoint& point : points) {
    point.position.z() = surface.at(point.position.x(), point.position.y()).height_m;
  }
  layout.route = Route(std::move(points), std::move(stops));
  return layout;
}

}  // namespace locsim::sim
