#include "sim/world/recorded_track.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace locsim::sim {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kShortest_m = 50.0;
// Below this speed the direction of motion is noise [m/s].
constexpr double kCourseSpeed_m_s = 0.3;
// Positions are differenced over so long before and after [s].
constexpr double kDifference_s = 0.25;
// What a position without a fixed ambiguity counts with, against its own sigma.
constexpr double kFloatFactor = 10.0;

/// A line of a file, for reading fields and for messages about them.
struct Line {
  std::string file;
  std::size_t number = 0;
  std::vector<std::string_view> fields;

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(file + ":" + std::to_string(number) + ": " + problem);
  }
  [[nodiscard]] double value(std::size_t column, std::string_view name) const {
    std::string_view field = fields[column];
    double value = 0.0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(value)) {
      fail(std::string(name) + ": \"" + std::string(field) + "\" is not a number");
    }
    return value;
  }
  [[nodiscard]] double value(std::size_t column, std::string_view name, double limit) const {
    const double v = value(column, name);
    if (std::abs(v) > limit) {
      fail(std::string(name) + ": " + std::string(fields[column]) + " lies beyond ±" +
           std::to_string(static_cast<int>(limit)));
    }
    return v;
  }
};

std::vector<std::string_view> split(std::string_view text, std::string_view separators,
                                    bool keep_empty) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    if (keep_empty || end > 0) fields.push_back(text.substr(0, end));
    if (end == text.size()) return fields;
    text.remove_prefix(end + 1);
  }
}

std::string_view strip(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

struct GeodeticSample {
  GeodeticPoint point;
  RecordedTrack::Sample sample;
};

/// Columns of a CSV by their names.
class Columns {
 public:
  explicit Columns(const Line& header) : count_(header.fields.size()) {
    for (std::size_t i = 0; i < count_; ++i) index_[std::string(strip(header.fields[i]))] = i;
    for (const char* name : {"t_gps_s", "latitude_deg", "longitude_deg", "height_m",
                             "velocity_north_m_s", "velocity_east_m_s"}) {
      if (!has(name)) {
        header.fail(std::string("no column \"") + name +
                    "\"; the header must name t_gps_s, latitude_deg, longitude_deg, height_m, "
                    "velocity_north_m_s and velocity_east_m_s");
      }
    }
  }
  [[nodiscard]] bool has(const std::string& name) const { return index_.contains(name); }
  [[nodiscard]] std::size_t operator[](const std::string& name) const { return index_.at(name); }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::map<std::string, std::size_t> index_;
  std::size_t count_;
};

GeodeticSample read_csv_sample(const Line& line, const Columns& columns) {
  if (line.fields.size() != columns.count()) {
    line.fail(std::to_string(line.fields.size()) + " fields where the header has " +
              std::to_string(columns.count()) + "; the line may be cut short");
  }
  const auto value = [&](const char* name) { return line.value(columns[name], name); };
  const double north = value("velocity_north_m_s");
  const double east = value("velocity_east_m_s");
  GeodeticSample result;
  result.point = {
      .latitude_rad = kDegree * line.value(columns["latitude_deg"], "latitude_deg", 90.0),
      .longitude_rad = kDegree * line.value(columns["longitude_deg"], "longitude_deg", 360.0),
      .height_m = value("height_m")};
  result.sample.time_s = value("t_gps_s");
  result.sample.speed_m_s = std::hypot(north, east);
  result.sample.course_rad = std::atan2(north, east);
  if (columns.has("sigma_north_m") && columns.has("sigma_east_m")) {
    const double sigma = std::hypot(value("sigma_north_m"), value("sigma_east_m"));
    result.sample.sigma_m = std::max(result.sample.sigma_m, sigma / std::numbers::sqrt2);
  }
  if (columns.has("quality") && value("quality") != 1.0) result.sample.sigma_m *= kFloatFactor;
  return result;
}

/// Middle of the horizontal extent, lowest height.
Vector3d anchor(const std::vector<RecordedTrack::Sample>& samples) {
  Vector3d low = samples.front().position;
  Vector3d high = low;
  for (const auto& sample : samples) {
    low = low.cwiseMin(sample.position);
    high = high.cwiseMax(sample.position);
  }
  const Vector3d middle = 0.5 * (low + high);
  return {middle.x(), middle.y(), low.z()};
}

void place_on_map(const std::vector<GeodeticSample>& read, RecordedTrack& track) {
  track.origin = read.front().point;
  // Heights above the tangent plane depend on where it touches: the second pass is exact.
  for (int pass = 0; pass < 2; ++pass) {
    const LocalFrame frame(track.origin);
    track.samples.clear();
    for (const GeodeticSample& item : read) {
      track.samples.push_back(item.sample);
      track.samples.back().position = frame.to_map(item.point);
    }
    if (pass == 0) track.origin = frame.to_geodetic(anchor(track.samples));
  }
}

struct TumPose {
  Line line;
  RecordedTrack::Sample sample;
  double yaw_rad = 0.0;
};

TumPose read_tum_pose(const Line& line) {
  if (line.fields.size() != 8) {
    line.fail(std::to_string(line.fields.size()) +
              " fields where TUM has 8 (t x y z qx qy qz qw); the line may be cut short");
  }
  const auto v = [&](std::size_t i) {
    constexpr std::array<std::string_view, 8> kNames = {"t", "x", "y", "z", "qx", "qy", "qz", "qw"};
    return line.value(i, kNames[i]);
  };
  const Eigen::Quaterniond rotation(v(7), v(4), v(5), v(6));
  if (std::abs(rotation.norm() - 1.0) > 0.01) {
    line.fail("the quaternion's length is " + std::to_string(rotation.norm()) + " instead of 1");
  }
  TumPose pose{.line = line, .sample = {}, .yaw_rad = 0.0};
  pose.sample.time_s = v(0);
  pose.sample.position = {v(1), v(2), v(3)};
  pose.yaw_rad = Pose{rotation.normalized(), Vector3d::Zero()}.yaw();
  return pose;
}

/// Speed and course by central differences over the positions.
void move_by_positions(std::vector<TumPose>& poses) {
  double course = poses.front().yaw_rad;
  const auto apart = [&](std::size_t a, std::size_t b) {
    return b > a && poses[b].sample.time_s - poses[a].sample.time_s >= kDifference_s;
  };
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::size_t first = i;
    std::size_t last = i;
    while (first > 0 && !apart(first, i)) --first;
    while (last + 1 < poses.size() && !apart(i, last)) ++last;
    const auto& before = poses[first].sample;
    const auto& after = poses[last].sample;
    const Vector3d step = after.position - before.position;
    auto& sample = poses[i].sample;
    sample.speed_m_s = step.head<2>().norm() / (after.time_s - before.time_s);
    if (sample.speed_m_s > kCourseSpeed_m_s) {
      course = std::atan2(step.y(), step.x());
      if (std::abs(wrap_angle(course - poses[i].yaw_rad)) > 0.5 * std::numbers::pi) {
        poses[i].line.fail("the vehicle moves against its heading; only forward drives can be run");
      }
    }
    sample.course_rad = course;
  }
}

void check_times(const RecordedTrack::Sample& sample, double last_time_s, const Line& line) {
  if (!(sample.time_s > last_time_s)) {
    line.fail("time does not rise: " + std::to_string(last_time_s) + " then " +
              std::to_string(sample.time_s));
  }
}

}  // namespace

RecordedTrack load_recorded_track(const std::filesystem::path& path,
                                  const GeodeticPoint& tum_origin) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be opened; give a CSV or TUM track");
  RecordedTrack track;
  track.source = path.string();
  Line line{.file = path.string(), .number = 0, .fields = {}};
  std::vector<GeodeticSample> geodetic;
  std::vector<TumPose> poses;
  std::unique_ptr<Columns> columns;
  std::string text;
  double last_time = -std::numeric_limits<double>::infinity();
  while (std::getline(file, text)) {
    ++line.number;
    const std::string_view content = strip(text);
    if (content.empty() || content.front() == '#') continue;
    if (!columns && poses.empty() && content.find(',') != std::string_view::npos) {
      line.fields = split(content, ",", true);
      columns = std::make_unique<Columns>(line);
    } else if (columns) {
      line.fields = split(content, ",", true);
      geodetic.push_back(read_csv_sample(line, *columns));
      check_times(geodetic.back().sample, last_time, line);
      last_time = geodetic.back().sample.time_s;
    } else {
      line.fields = split(content, " \t", false);
      poses.push_back(read_tum_pose(line));
      check_times(poses.back().sample, last_time, line);
      last_time = poses.back().sample.time_s;
      poses.back().line.fields.clear();
    }
  }
  if (geodetic.size() >= 2) {
    place_on_map(geodetic, track);
  } else if (poses.size() >= 2) {
    move_by_positions(poses);
    for (const TumPose& pose : poses) track.samples.push_back(pose.sample);
    const Vector3d shift = anchor(track.samples);
    for (auto& sample : track.samples) sample.position -= shift;
    track.origin = tum_origin;
  } else {
    line.fail("the file ends after fewer than two samples");
  }

  const double start_s = track.samples.front().time_s;
  double length = 0.0;
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    auto& sample = track.samples[i];
    sample.time_s -= start_s;
    if (i == 0) continue;
    const auto& before = track.samples[i - 1];
    if (sample.speed_m_s < kCourseSpeed_m_s) sample.course_rad = before.course_rad;
    length += 0.5 * (sample.speed_m_s + before.speed_m_s) * (sample.time_s - before.time_s);
  }
  if (length < kShortest_m) {
    line.fail("the track is " + std::to_string(length) + " m long; at least 50 m are needed");
  }
  return track;
}

}  // namespace locsim::sim
