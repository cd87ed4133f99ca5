#include "scenarios/imu_log.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "core/error.h"
#include "scenarios/text_io.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kFewestSamples = 3;
constexpr double kGapIntervals = 1.5;
constexpr std::size_t kValues = std::size(kImuColumns);

std::string_view strip(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

void split(std::string_view text, std::vector<std::string_view>& fields) {
  fields.clear();
  while (true) {
    const std::size_t end = text.find(',');
    fields.push_back(strip(text.substr(0, end)));
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
  }
}

// Where the reader is.
struct Place {
  const std::string& file;
  std::size_t line = 0;

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(file + ":" + std::to_string(line) + ": " + problem);
  }
  [[noreturn]] void fail(std::string_view column, const std::string& problem) const {
    fail(std::string(column) + ": " + problem);
  }
};

struct Columns {
  std::size_t count = 0;
  std::string_view time_name;
  std::size_t time = 0;
  std::array<std::size_t, kValues> values{};
};

Columns find_columns(const std::vector<std::string_view>& header, const Place& place) {
  const auto find = [&](std::string_view name) {
    const auto found = std::ranges::find(header, name);
    if (found != header.end() && std::find(found + 1, header.end(), name) != header.end()) {
      place.fail(name, "stands twice in the header");
    }
    return static_cast<std::size_t>(found - header.begin());
  };
  Columns columns{.count = header.size(), .time_name = kImuTimeGps, .time = find(kImuTimeGps)};
  if (columns.time == header.size()) {
    columns.time_name = kImuTime;
    columns.time = find(kImuTime);
  } else if (find(kImuTime) != header.size()) {
    place.fail("the header names both t_gps_s and t_s; leave one");
  }
  std::string missing = columns.time == header.size() ? " t_gps_s or t_s" : "";
  for (std::size_t i = 0; i < kValues; ++i) {
    columns.values[i] = find(kImuColumns[i]);
    if (columns.values[i] == header.size()) missing += " " + std::string(kImuColumns[i]);
  }
  if (!missing.empty()) {
    std::string names = "t_gps_s (or t_s)";
    for (const std::string_view name : kImuColumns) names += ", " + std::string(name);
    place.fail("the header lacks" + missing + "; it must name " + names + ", in any order");
  }
  return columns;
}

double number(std::string_view field, std::string_view column, const Place& place) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(value)) {
    place.fail(column, "'" + std::string(field) + "' is not a number");
  }
  return value;
}

ImuSample read_sample(const std::vector<std::string_view>& fields, const Columns& columns,
                      const Place& place) {
  if (fields.size() != columns.count) {
    place.fail(std::to_string(fields.size()) + " fields where the header has " +
               std::to_string(columns.count) + "; is the line cut short?");
  }
  ImuSample sample;
  const std::string_view time = fields[columns.time];
  if (const auto stamp = parse_seconds(time)) {
    sample.time = *stamp;
  } else {
    place.fail(columns.time_name, "'" + std::string(time) + "' is not a time in seconds");
  }
  for (std::size_t i = 0; i < kValues; ++i) {
    Vector3d& to = i < 3 ? sample.specific_force_m_s2 : sample.angular_rate_rad_s;
    to[static_cast<Eigen::Index>(i % 3)] = number(fields[columns.values[i]], kImuColumns[i], place);
  }
  return sample;
}

void measure_intervals(ImuLog& log) {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    intervals_s.push_back(to_seconds(log.samples[i].time - log.samples[i - 1].time));
  }
  std::vector<double> sorted = intervals_s;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double limit_s = kGapIntervals * *middle;
  log.shortest_interval_s = std::numeric_limits<double>::infinity();
  double sum_s = 0.0;
  for (std::size_t i = 0; i < intervals_s.size(); ++i) {
    const double interval_s = intervals_s[i];
    if (interval_s > limit_s) {
      log.gaps.push_back({.after = i, .length_s = interval_s});
      continue;
    }
    sum_s += interval_s;
    log.shortest_interval_s = std::min(log.shortest_interval_s, interval_s);
    log.longest_interval_s = std::max(log.longest_interval_s, interval_s);
  }
  log.rate_hz = static_cast<double>(intervals_s.size() - log.gaps.size()) / sum_s;
}

}  // namespace

double ImuLog::duration_s() const {
  return to_seconds(samples.back().time - samples.front().time);
}

std::vector<sim::Stretch> ImuLog::without_gaps() const {
  std::vector<sim::Stretch> stretches;
  std::size_t begin = 0;
  for (const Gap& gap : gaps) {
    stretches.push_back({.begin = begin, .end = gap.after + 1});
    begin = gap.after + 1;
  }
  stretches.push_back({.begin = begin, .end = samples.size()});
  return stretches;
}

ImuLog read_imu_log(const fs::path& file) {
  const std::string content = read_text_file(file);
  ImuLog log;
  log.source = file.string();
  Place place{.file = log.source};
  Columns columns;
  std::vector<std::string_view> fields;
  std::string_view rest = content;
  while (!rest.empty()) {
    ++place.line;
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view text = strip(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (text.empty() || text.front() == '#') continue;
    split(text, fields);
    if (columns.count == 0) {
      columns = find_columns(fields, place);
      continue;
    }
    const ImuSample sample = read_sample(fields, columns, place);
    if (!log.samples.empty() && sample.time <= log.samples.back().time) {
      place.fail(columns.time_name, std::string(fields[columns.time]) + " does not lie after " +
                                        exact_seconds(log.samples.back().time) +
                                        " of the sample before; sort the log by time");
    }
    log.samples.push_back(sample);
  }
  if (columns.count == 0) place.fail("the file is empty, needs a header and samples");
  log.time_column = columns.time_name;
  if (log.samples.size() < kFewestSamples) {
    place.fail("the file ends after " + std::to_string(log.samples.size()) +
               " samples, needs at least " + std::to_string(kFewestSamples));
  }
  measure_intervals(log);
  return log;
}

std::string imu_log_csv(std::span<const ImuSample> samples, std::string_view time_column) {
  std::string text(time_column);
  for (const std::string_view name : kImuColumns) text += "," + std::string(name);
  text += '\n';
  for (const ImuSample& sample : samples) {
    text += exact_seconds(sample.time);
    for (const Vector3d& v : {sample.specific_force_m_s2, sample.angular_rate_rad_s}) {
      for (const double value : {v.x(), v.y(), v.z()}) text += "," + shortest_text(value);
    }
    text += '\n';
  }
  return text;
}

void write_imu_log(std::span<const ImuSample> samples, const fs::path& file,
                   std::string_view time_column) {
  write_text_file(file, imu_log_csv(samples, time_column));
}

}  // namespace locsim::scenarios
