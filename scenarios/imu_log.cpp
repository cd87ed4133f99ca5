#include "scenarios/imu_log.h"

#include <algorithm>
#include <array>
#include <limits>

#include "scenarios/csv_reader.h"
#include "scenarios/text_io.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kFewestSamples = 3;
constexpr double kGapIntervals = 1.5;
constexpr std::size_t kValues = std::size(kImuColumns);

struct Columns {
  std::string_view time_name;
  std::size_t time = 0;
  std::array<std::size_t, kValues> values{};
};

Columns find_columns(const CsvReader& csv) {
  const auto gps = csv.find(kImuTimeGps);
  const auto own = csv.find(kImuTime);
  if (gps && own) csv.fail("the header names both t_gps_s and t_s; leave one");
  Columns columns{.time_name = gps ? kImuTimeGps : kImuTime, .time = gps.value_or(own.value_or(0))};
  std::string missing = gps || own ? "" : " t_gps_s or t_s";
  for (std::size_t i = 0; i < kValues; ++i) {
    const auto column = csv.find(kImuColumns[i]);
    columns.values[i] = column.value_or(0);
    if (!column) missing += " " + std::string(kImuColumns[i]);
  }
  if (!missing.empty()) {
    std::string names = "t_gps_s (or t_s)";
    for (const std::string_view name : kImuColumns) names += ", " + std::string(name);
    csv.fail("the header lacks" + missing + "; it must name " + names + ", in any order");
  }
  return columns;
}

ImuSample read_sample(const CsvReader& csv, const Columns& columns) {
  ImuSample sample{.time = csv.time(columns.time)};
  for (std::size_t i = 0; i < kValues; ++i) {
    Vector3d& to = i < 3 ? sample.specific_force_m_s2 : sample.angular_rate_rad_s;
    to[static_cast<Eigen::Index>(i % 3)] = csv.number(columns.values[i]);
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
  CsvReader csv(file);
  const Columns columns = find_columns(csv);
  ImuLog log;
  log.source = csv.source();
  log.time_column = columns.time_name;
  while (csv.next()) {
    const ImuSample sample = read_sample(csv, columns);
    if (!log.samples.empty() && sample.time <= log.samples.back().time) {
      csv.fail(columns.time, "does not lie after " + exact_seconds(log.samples.back().time) +
                                 " of the sample before; sort the log by time");
    }
    log.samples.push_back(sample);
  }
  if (log.samples.size() < kFewestSamples) {
    csv.fail("the file ends after " + std::to_string(log.samples.size()) +
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
