#include "scenarios/run_files.h"

#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>

#include "core/error.h"
#include "scenarios/output_folder.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;

namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

[[noreturn]] void refuse(const fs::path& file, std::size_t line, const std::string& problem) {
  throw InputError(file.string() + ":" + std::to_string(line) + ": " + problem +
                   "; the file is damaged, run the scenario again");
}

// One line of a table, field by field.
class Row {
 public:
  Row(const fs::path& file, std::size_t line, std::string_view text, char separator)
      : file_(file), line_(line), rest_(text), separator_(separator) {}

  std::string_view field() {
    if (ended_) refuse(file_, line_, "has too few fields");
    const std::size_t end = rest_.find(separator_);
    const std::string_view text = rest_.substr(0, end);
    ended_ = end == std::string_view::npos;
    if (!ended_) rest_.remove_prefix(end + 1);
    return text;
  }
  double number() {
    const std::string_view text = field();
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) {
      refuse(file_, line_, "'" + std::string(text) + "' is no number");
    }
    return value;
  }
  // Nanoseconds exactly, as written: seconds with nine decimals.
  Stamp time() {
    const std::string_view text = field();
    const std::size_t point = text.find('.');
    std::int64_t ns = 0;
    if (point == std::string_view::npos || text.size() != point + 10) {
      refuse(file_, line_, "'" + std::string(text) + "' is no time with nine decimals");
    }
    const std::string digits =
        std::string(text.substr(0, point)) + std::string(text.substr(point + 1));
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), ns);
    if (error != std::errc{} || end != digits.data() + digits.size()) {
      refuse(file_, line_, "'" + std::string(text) + "' is no time");
    }
    return Stamp{Duration{ns}};
  }
  Vector3d vector() {
    const double x = number();
    const double y = number();
    return {x, y, number()};
  }
  Pose pose() {
    Pose pose;
    pose.translation = vector();
    pose.rotation.vec() = vector();
    pose.rotation.w() = number();
    return pose;
  }
  localization::State state() {
    using localization::State;
    const std::string_view text = field();
    for (const State s : {State::initializing, State::tracking, State::degraded, State::lost}) {
      if (text == to_string(s)) return s;
    }
    refuse(file_, line_, "'" + std::string(text) + "' is no state");
  }

 private:
  const fs::path& file_;
  std::size_t line_;
  std::string_view rest_;
  char separator_;
  bool ended_ = false;
};

// Calls `read` for each line after the first, which has to begin with `header`.
template <typename Read>
void read_table(const fs::path& file, std::string_view header, char separator, Read read) {
  const std::string content = read_text_file(file);
  std::string_view rest = content;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) refuse(file, line, "ends in the middle of the line");
    const std::string_view text = rest.substr(0, end);
    rest.remove_prefix(end + 1);
    if (line > 1) {
      Row row(file, line, text, separator);
      read(row);
    } else if (!text.starts_with(header)) {
      refuse(file, line, "needs to begin with '" + std::string(header) + "'");
    }
  }
}

void load_scores(const fs::path& file, RunFiles& run) {
  try {
    const auto json = nlohmann::ordered_json::parse(read_text_file(file));
    run.scenario = json.at("scenario").get<std::string>();
    run.seed = json.at("seed").get<std::uint64_t>();
    run.localizer = json.at("localizer").get<std::string>();
    run.passed = json.at("passed").get<bool>();
    run.hash = json.at("hash").get<std::string>();
    for (const auto& [name, value] : json.at("scores").items()) {
      run.scores.push_back(
          {name, value.is_null() ? std::nullopt : std::optional<double>(value.get<double>())});
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError(file.string() + ": is not what a run writes (" + error.what() +
                     "); run the scenario again");
  }
}

}  // namespace

RunFiles load_run(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw InputError(folder.string() + ": is no folder of a run; name one that locsim run wrote");
  }
  RunFiles run;
  load_scores(folder / run_file::kScores, run);
  read_table(folder / run_file::kTruth, "#", ' ', [&](Row& row) {
    const Stamp time = row.time();
    run.truth.push_back({.time = time, .T_map_vehicle = row.pose()});
  });
  read_table(folder / run_file::kEstimate, kEstimateHeader, ',', [&](Row& row) {
    RunFiles::EstimateRow estimate;
    estimate.time = row.time();
    estimate.T_map_vehicle = row.pose();
    estimate.velocity_m_s = row.vector();
    estimate.sigma_position_m = row.vector();
    estimate.sigma_rotation_rad = kRadiansPerDegree * row.vector();
    estimate.state = row.state();
    run.estimates.push_back(estimate);
  });
  read_table(folder / run_file::kGnss, kGnssHeader, ',', [&](Row& row) {
    RunFiles::GnssRow fix;
    fix.time = row.time();
    fix.valid = row.number() != 0.0;
    fix.satellites = static_cast<int>(row.number());
    if (fix.valid) {
      for (int skipped = 0; skipped < 3; ++skipped) row.number();
      fix.position_m = row.vector();
      row.vector();
      fix.sigma_m = row.vector();
    }
    run.gnss.push_back(fix);
  });
  return run;
}

}  // namespace locsim::scenarios
